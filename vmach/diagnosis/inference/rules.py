"""The numbers that decide a verdict, each with its unit, its origin and the test that guards it."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "CLEARLY",
    "IMITATION",
    "KEPT",
    "RULES",
    "SHOWN",
    "STRUCTURE",
    "TRUST",
    "UNMEASURED",
    "WORTH_A_FORM",
    "Rule",
    "rules_text",
]

#: log evidence by which one explanation is clearly more probable than another
CLEARLY = 4.6
#: log odds from which on an effect is shown
SHOWN = 3.45
#: log prior odds of an effect that every machine has and nobody measured in this one
UNMEASURED = 4.0
#: size of an effect times its share, in what remains, where it is as probably an imitation as not
IMITATION = 2.0
#: share of its size that an effect keeps beside a form, and whose inverse it does not reach
KEPT = 0.5
#: what remains counts as structure from this multiple of the median stated uncertainty on
STRUCTURE = 1.0
#: below this multiple of the median stated uncertainty a rest is not looked into
WORTH_A_FORM = 0.6
#: scatter up to this multiple of the stated uncertainty is noise, whatever the file says
TRUST = 2.0

_CALIBRATION = "tests/benchmarks/calibrate_verdicts.py"
_COUNTS = "tests/benchmarks/count_verdicts.py"


@dataclass(frozen=True)
class Rule:
    """One number."""

    name: str
    value: float
    unit: str
    meaning: str
    origin: str
    guard: str


RULES = (
    Rule(
        "shown",
        SHOWN,
        "log odds",
        "an effect is shown where it, or another in its place, is 31 times as probable as none",
        "Jeffreys, Theory of Probability (1961), appendix B: very strong is beyond 10^1.5 to 1. Of "
        f"effects that pass all else on 506 machines, {_COUNTS} --seed 45000000, 6 of 7 of odds "
        "from 31 to 100 to 1 were there, 12 of 12 from 100 to 1000 to 1; 4 of 7 from 7 to 31 to 1. "
        f"{_CALIBRATION} counts the same on other machines",
        _COUNTS,
    ),
    Rule(
        "clearly",
        CLEARLY,
        "log evidence",
        "a form is added, or takes the place of effects, where that makes all readings 100 times "
        "more probable; effects that are closer form a class",
        "Jeffreys (1961): decisive is beyond 100 to 1; noise alone reaches a factor b at most once "
        "in b times",
        _COUNTS,
    ),
    Rule(
        "unmeasured",
        UNMEASURED,
        "log odds",
        "for an effect before any reading, and for its being no imitation, where every machine "
        "has it and nobody measured it, or a test of its own was made: a table that is missing, a "
        "squareness not stated, lost motion of an axis beside a laser",
        "chosen: of fifty such effects one is too small to be seen",
        "tests/unit/test_instruments_holes.py, a plate of holes; "
        "tests/oracle/test_diagnosis_axis.py",
    ),
    Rule(
        "imitation",
        IMITATION,
        "share times sizes of the rest",
        "an effect is as probably an imitation as not where its size, times its share, is so many "
        "times what remains, each reading weighed by the effect's square; the share is of the "
        "variance of what remains beside forms and of effects that are not shown; what every "
        "machine has is no piece of another cause, its share is 1",
        f"{_CALIBRATION}: even odds at 1.6; chosen larger, as a false name costs more than one "
        "that is withheld. Of 375 effects 327 pass, 29 of them false, and 12 true ones do not. "
        "Where only a size of five rests counts, 29 of 319 are false, and 20 true ones do not pass",
        _COUNTS,
    ),
    Rule(
        "kept",
        KEPT,
        "share",
        "an effect keeps so much of its size beside a form over states, and grows to less than the "
        "inverse; one that shrinks more is an imitation of the form, one that grows more is a part "
        "of its cause",
        "chosen: where both act alike each has half",
        "tests/unit/test_proposed_directions.py",
    ),
    Rule(
        "structure",
        STRUCTURE,
        "stated u",
        "what remains is structure where its size is above the uncertainty of one reading, or "
        "where a form was found",
        "chosen: what is below u hides in the scatter of a reading",
        _COUNTS,
    ),
    Rule(
        "worth_a_form",
        WORTH_A_FORM,
        "stated u",
        "a rest below this is not looked into; what is beyond it is weighed against effects",
        "what points of a feature share of readings of u: 0.48 um of 0.8, as the generator has it",
        _COUNTS,
    ),
    Rule(
        "trust",
        TRUST,
        "stated u",
        "readings that scatter more than this many stated uncertainties hide structure",
        "the prior of the factor on u: stated uncertainties are right within a factor of two",
        "tests/unit/test_diagnosis_verdicts.py, a ripple that no effect explains",
    ),
)


def rules_text() -> str:
    """All rules for people."""
    lines = []
    for rule in RULES:
        lines += [
            f"{rule.name} = {rule.value:g} {rule.unit}: {rule.meaning}",
            f"    origin: {rule.origin}",
            f"    guarded by: {rule.guard}",
        ]
    return "\n".join(lines)
