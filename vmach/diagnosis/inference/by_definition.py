"""What a test reads by definition goes before others that do the same to its readings.

A laser along X reads the positioning error motion EXX of its line. An angular error motion may do
the same there; where it stands for what was read, it would move other lines by a lever that
nothing was measured of.

Source: ISO 230-1, positioning error motion of a linear axis.
"""

from __future__ import annotations

from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.inference.weighing import Explanation, Weighing

__all__ = ["as_defined"]


def as_defined(weighing: Weighing, found: Explanation) -> Explanation:
    """An explanation by what tests define, in place of the like that is not clearly better."""
    defined = [
        k
        for k, candidate in enumerate(weighing.candidates)
        if weighing.survey.is_defined(candidate.effect, candidate.target)
    ]
    least = found.score - CLEARLY
    for label in found.labels:
        place = [term.label for term in found.terms].index(label)
        term = found.terms[place]
        if weighing.survey.is_defined(term.effect, term.target):
            continue
        others = weighing.without(found, [place], resize=False)
        like = [k for k in defined if weighing.candidates[k].effect is term.effect]
        new = (k for k in like if weighing.candidates[k].label not in others.labels)
        trials = [weighing.extend(others, k) for k in new]
        found = max((e for e in trials if e.score > least), key=lambda e: e.score, default=found)
    return found
