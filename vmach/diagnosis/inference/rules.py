"""The numbers that decide a verdict, each with its unit, its origin and the test that guards it."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "DOMINATES",
    "RIVAL",
    "RULES",
    "SHOWN",
    "STRUCTURE",
    "TRUST",
    "WORTH_A_FORM",
    "Rule",
    "rules_text",
]

#: log odds from which an effect counts as shown, given everything else
SHOWN = 5.0
#: effects whose log evidence is this close cannot be told apart
RIVAL = 4.0
#: what remains counts as structure from this multiple of the median stated uncertainty on
STRUCTURE = 1.0
#: where something remains, an effect has to be this many times as large to be named beside it
DOMINATES = 1.0
#: from this multiple of the median stated uncertainty on forms are tried beside the effects
WORTH_A_FORM = 0.4
#: scatter up to this multiple of the stated uncertainty is noise, whatever the file says
TRUST = 2.0


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
        "an effect is shown where its odds, given all else and divided by the dispersion, "
        "are above exp(5) = 150 to 1",
        "Jeffreys, Theory of Probability (1961), appendix B: decisive is beyond 100 to 1",
        "tests/benchmarks/bench_hidden_effects.py, kind none",
    ),
    Rule(
        "rival",
        RIVAL,
        "log evidence",
        "effects within a factor of 50 form a class",
        "Kass and Raftery, J. Am. Stat. Assoc. 90 (1995): strong is 20 to 150",
        "tests/benchmarks/bench_hidden_effects.py, single kinds",
    ),
    Rule(
        "structure",
        STRUCTURE,
        "stated u",
        "what remains is structure where its size is above the uncertainty of one reading",
        "chosen: what is below u hides in the scatter of a reading",
        "tests/benchmarks/bench_hidden_effects.py, foreign kinds",
    ),
    Rule(
        "dominates",
        DOMINATES,
        "of what remains",
        "beside structure an effect is named where its root mean square is at least as large",
        "the larger half of the variance of both has a law",
        "tests/benchmarks/bench_hidden_effects.py, foreign kinds",
    ),
    Rule(
        "worth_a_form",
        WORTH_A_FORM,
        "stated u",
        "from this remainder on, effects have to be shown beside forms over states too",
        "below the noise of a feature that a part of 0.8 um shows, 0.48 um",
        "tests/benchmarks/bench_hidden_effects.py, foreign kinds",
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
