"""Was the diagnosis right? Judged from its JSON and the truth of the experiment.

The rules, as strict as physics allows:

* An effect counts as found by its own name and, where it has one, its own target.
* A longer name is accepted only where it says the same: a component table "no longer true" is a
  correct statement about a scale (EXX), a squareness (slope of a straightness), a sagging beam
  (EZX) and a reflector that stood elsewhere (an error of its axis' position only), if it is that
  very table. The reverse is not: sag or scale named for a bent table is wrong.
* Twins have one and the same signature in every CMM measurement of a part: the radius of the
  probe and that of all tools; three equal scales and the workpiece's temperature. A twin named
  alone claims more than can be known: outcome `alone`. A tool's radius and its runout are no
  twins: the one tooth that cuts leaves cusps that grow with the square of the feed.
* The length of one of two tools is the other's with the sign turned and a shift of the datum:
  either tool may be named.
* Causes that act through one and the same table are answered by that table: their sum is its error,
  and no measurement tells them apart.
* A class is right if it holds the true name, or another that is true of these points, if its leader
  or a rival points at the same target, and if it has at most `MOST_IN_CLASS` members: `vague`
  otherwise.
* The report tells sets of effects that are as probable as what it found: two in the place of one,
  or one in the place of two. Where such a set is the truth, the truth is in the class.
* Something accused besides what is true: `extra`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations

__all__ = ["OUTCOMES", "Judgement", "is_answer", "judge"]

#: right: named; class: truth among those that the data cannot tell apart; part: one of two
#: found, nothing else said; wrong: another named
OUTCOMES = ("right", "class", "vague", "alone", "unknown", "nothing", "part", "extra", "wrong")
MOST_IN_CLASS = 5
_WORTH = {"right": 1.01, "class": 1.0, "alone": 0.9, "vague": 0.8, "missed": 0.0}
#: the target of these cannot be known from a part's points alone
_ANY_TARGET = ("tool_length",)


@dataclass(frozen=True)
class Judgement:
    """Outcome, and for every comparable parameter (name, found, low, high, true).

    Of the effects `named` in the report, so many are `true`.
    """

    outcome: str
    parameters: list[tuple[str, float, float, float, float]]
    said: str
    named: int = 0
    true: int = 0


def judge(report: dict, truth: dict) -> Judgement:
    """Compare a report of ``vmach diagnose --json`` with ``truth.json``."""
    own = _judged(report, truth)
    if own.outcome in ("right", "class", "vague", "alone"):
        return own
    for other in _with_other_sets(report):
        if _judged(other, truth).outcome in ("right", "class"):
            true = len(truth["effects"])
            return Judgement("class", [], own.said, true, true)
    return own


def _with_other_sets(report: dict) -> Iterator[dict]:
    """The report with each set that it tells in the place of what it found."""
    for one in {str(s): s for e in report["effects"] for s in e.get("other_sets", ())}.values():
        label = [f"{e['effect']} {e['target'] or ''}".strip() for e in report["effects"]]
        kept = [
            e
            for e, name in zip(report["effects"], label, strict=True)
            if name not in one["without"]
        ]
        new = [
            dict(zip(("effect", "target"), (*name.split(), None), strict=False))
            for name in one["with"]
        ]
        new = [e | {"class": [e["effect"]], "parameters": {}, "u": {}} for e in new]
        yield report | {"effects": kept + new}


def _judged(report: dict, truth: dict) -> Judgement:
    said, verdict, hidden = _said(report), report["verdict"], truth["effects"]
    if not hidden:
        named = sum(entry["effect"] != "unknown" for entry in report["effects"])
        return Judgement("right" if verdict == "nothing" else "wrong", [], said, named)
    if verdict in ("unknown", "nothing"):
        is_right = all(verdict in effect["accept"] for effect in hidden)
        return Judgement("right" if is_right else verdict, [], said)
    best: tuple[float, list[str], list[dict]] = (-1.0, [], [])
    nobody = [{}] * len(hidden)
    for chosen in permutations([*report["effects"], *_sums(report, hidden), *nobody], len(hidden)):
        how = [_answer(entry, effect) for entry, effect in zip(chosen, hidden, strict=True)]
        if (score := sum(_WORTH[h] for h in how)) > best[0]:
            best = score, how, list(chosen)
    _, how, chosen = best
    parameters = [
        row
        for entry, effect in zip(chosen, hidden, strict=True)
        for row in _parameters(effect, entry)
    ]
    answers = {id(entry) for entry, h in zip(chosen, how, strict=True) if h != "missed"}
    true, extra = len(answers), len(report["effects"]) > len(answers)
    return Judgement(_together(how, extra=extra), parameters, said, len(report["effects"]), true)


def _sums(report: dict, hidden: list[dict]) -> list[dict]:
    """Tables that are what several hidden effects do together, once more for each further one."""
    sums = []
    for entry in report["effects"]:
        label = f"{entry['effect']} {entry['target'] or ''}".strip()
        if entry["effect"] == "component":
            named = [f"{e['name']} {e['target']}" for e in hidden]
            ones = sum(label in (n, *e["accept"]) for n, e in zip(named, hidden, strict=True))
            sums += [entry] * (ones - 1)
    return sums


def is_answer(entry: dict, truth: dict) -> bool:
    """Whether an effect, with those that are not told from it, is one of the hidden ones."""
    return any(_answer(entry, effect) != "missed" for effect in truth["effects"])


def _answer(entry: dict, effect: dict) -> str:
    """How an entry of the report, empty for none, answers one hidden effect."""
    if not entry:
        return "missed"
    # led by the right name at the wrong target it would be wrong, unless that target is a rival
    in_class = effect["name"] in entry["class"] and entry["effect"] != effect["name"]
    true_names = {f"{effect['name']} {effect['target']}", *effect["accept"]}
    in_class |= not true_names.isdisjoint(entry.get("rivals", ()))
    if not _means(entry, effect) and not in_class:
        return "missed"
    members = {entry["effect"], *entry["class"]}
    if len(members) > MOST_IN_CLASS:
        return "vague"
    if effect["twins"] and len(members & set(effect["twins"])) < 2:
        return "alone"
    return "class" if len(members) > 1 else "right"


def _means(entry: dict, effect: dict) -> bool:
    target = entry["target"] or ""
    if entry["effect"] != effect["name"]:
        return f"{entry['effect']} {target}".strip() in effect["accept"]
    free = not effect["target"] or effect["name"] in _ANY_TARGET
    return free or target == effect["target"]


def _together(outcomes: list[str], *, extra: bool) -> str:
    if "missed" in outcomes:
        return "wrong" if extra or set(outcomes) == {"missed"} else "part"
    if extra:
        return "extra"
    return next(o for o in ("vague", "alone", "class", "right") if o in outcomes)


def _parameters(effect: dict, entry: dict) -> list[tuple[str, float, float, float, float]]:
    """Comparable parameters with their 95 % intervals, those of either sign as sizes."""
    if entry.get("effect") != effect["name"] or not _means(entry, effect):
        return []
    rows = []
    for name, true in effect["comparable"].items():
        value, u = entry["parameters"].get(name), entry["u"].get(name)
        known = isinstance(value, int | float) and isinstance(u, int | float)
        if not known or name in entry.get("weakly_identified", ()):
            continue
        low, high = entry.get("interval_95", {}).get(name, (value - 1.96 * u, value + 1.96 * u))
        if len(effect["comparable"]) < 3 and value * true < 0:
            low, high, value = -high, -low, -value
        rows.append((name, value, low, high, true))
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
