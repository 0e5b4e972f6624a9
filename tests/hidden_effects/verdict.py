"""Was the diagnosis right? Judged from its JSON and the truth of the experiment."""

from __future__ import annotations

from dataclasses import dataclass

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
    pairs, parameters = [], []
    left = list(found)
    for effect, accept in zip(truth["effects"], truth["accept"], strict=True):
        how, match = _match(effect, accept, left)
        if match is not None:
            left.remove(match)
            parameters += _parameters(effect, match)
        pairs.append(how)
    return Judgement(_outcome(pairs, extra=bool(left)), parameters, said)


def _match(effect: dict, accept: list[str], found: list[dict]) -> tuple[str, dict | None]:
    """How one hidden effect was found: right, class or missed, and by which entry."""
    for entry in found:
        is_name = entry["effect"] in accept
        if entry["effect"] == effect["name"] and effect["target"]:
            is_name = entry["target"] == effect["target"]
        if is_name and len(entry["class"]) <= 1:
            return "right", entry
    for entry in found:
        if {effect["name"], *accept} & {entry["effect"], *entry["class"]}:
            same = entry["effect"] == effect["name"] and effect["target"]
            if len(entry["class"]) > 1 and not (same and entry["target"] != effect["target"]):
                return "class", entry
    return "missed", None


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
