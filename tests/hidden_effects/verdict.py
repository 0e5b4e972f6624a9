"""Was the diagnosis right? Judged from its JSON and the truth of the experiment."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations

__all__ = ["OUTCOMES", "Judgement", "judge"]

#: right: named; class: truth among those that the data cannot tell apart; extra: right, and
#: something else accused besides; part: one of two found; wrong: another named
OUTCOMES = ("right", "class", "unknown", "nothing", "part", "extra", "wrong")


@dataclass(frozen=True)
class Judgement:
    """Outcome, and for every comparable parameter (found, u, true)."""

    outcome: str
    parameters: list[tuple[str, float, float, float]]
    said: str


def judge(report: dict, truth: dict) -> Judgement:
    """Compare a report of ``vmach diagnose --json`` with ``truth.json``."""
    found, said = report["effects"], _said(report)
    verdict = report["verdict"]
    if not truth["effects"]:
        return Judgement("right" if verdict == "nothing" else "wrong", [], said)
    if verdict in ("unknown", "nothing"):
        is_right = all(verdict in accept for accept in truth["accept"])
        return Judgement("right" if is_right else verdict, [], said)
    best: tuple[float, list[str], list[dict | None]] = (-1.0, [], [])
    for chosen in permutations([*found, *[None] * len(truth["effects"])], len(truth["effects"])):
        told = zip(truth["effects"], truth["accept"], chosen, strict=True)
        pairs = [_match(effect, accept, entry) for effect, accept, entry in told]
        score = sum({"right": 1.01, "class": 1.0, "missed": 0.0}[how] for how in pairs)
        if score > best[0]:
            best = score, pairs, list(chosen)
    _, pairs, chosen = best
    parameters = []
    for effect, how, entry in zip(truth["effects"], pairs, chosen, strict=True):
        if how != "missed":
            parameters += _parameters(effect, entry)
    used = len(pairs) - pairs.count("missed")
    return Judgement(_outcome(pairs, extra=len(found) > used), parameters, said)


def _match(effect: dict, accept: list[str], entry: dict | None) -> str:
    """How an entry of the report answers one hidden effect: right, class or missed."""
    if entry is None:
        return "missed"
    same_name = entry["effect"] == effect["name"] and effect["target"]
    is_wrong_target = same_name and entry["target"] != effect["target"]
    if len(entry["class"]) <= 1:
        is_name = entry["target"] == effect["target"] if same_name else entry["effect"] in accept
        return "right" if is_name else "missed"
    is_in_class = {effect["name"], *accept} & {entry["effect"], *entry["class"]}
    return "class" if is_in_class and not is_wrong_target else "missed"


def _outcome(pairs: list[str], *, extra: bool) -> str:
    if "missed" in pairs:
        return "wrong" if extra or set(pairs) == {"missed"} else "part"
    if extra:
        return "extra"
    return "class" if "class" in pairs else "right"


def _parameters(effect: dict, entry: dict) -> list[tuple[str, float, float, float]]:
    if entry["effect"] != effect["name"]:
        return []
    rows = []
    for name, true in effect["comparable"].items():
        value, u = entry["parameters"].get(name), entry["u"].get(name)
        if isinstance(value, int | float) and isinstance(u, int | float):
            rows.append((name, abs(value), u, abs(true)))
    return rows


def _said(report: dict) -> str:
    names = [
        f"{e['effect']} {e['target'] or ''}".strip()
        + (f" [{','.join(e['class'])}]" if len(e["class"]) > 1 else "")
        for e in report["effects"]
    ]
    rms = report["rms_um"]
    return (
        f"{report['verdict']}: {'; '.join(names) or '-'} "
        f"({rms['before']:.2f} -> {rms['after']:.2f}, noise {rms['expected_noise']:.2f})"
    )
