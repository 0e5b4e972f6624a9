"""What standards define: which of two effects that do the same to the readings is meant.

A laser along X reads the positioning error motion EXX of its line. An angular error motion may do
the same there; where it stands for what was read, it would move other lines by a lever that
nothing was measured of.

A straightness error motion is that from the mean line of the trajectory, whose slope is the
squareness; the mean slope of a positioning error is a scale. Of a table that nobody measured a
curve is what lies beyond these, as is the smooth field of the discrepancy. What a laser reads it
reads as a whole.

Source: ISO 230-1, positioning and straightness error motions of a linear axis, squareness.
M. Plumlee, J. Am. Stat. Assoc. 112 (2017) 1274: what is flexible is orthogonal to what is plain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.fit.candidates import Candidate
from vmach.fit.whitening import orthonormal

__all__ = ["as_defined"]

#: cosine from which on a curve can do all that a law does; it does so exactly, or clearly not
_HELD = 0.98


def as_defined(weighing: Weighing, found: Explanation) -> Explanation:
    """An explanation by what standards define, where that is not clearly less probable."""
    found = _as_tested(weighing, found)
    for candidate in weighing.candidates:
        if _goes_before_curves(weighing, candidate):
            found = _beside(weighing, found, candidate)
    return found


def _as_tested(weighing: Weighing, found: Explanation) -> Explanation:
    """What a test reads by definition, in place of the like."""
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


def _goes_before_curves(weighing: Weighing, candidate: Candidate) -> bool:
    """Whether it is a plain law that every machine has some of, and nobody measured."""
    effect, machine = candidate.effect, weighing.survey.job.machine
    return effect.goes_before_curves and effect.is_unmeasured(machine, candidate.target)


def _beside(weighing: Weighing, found: Explanation, law: Candidate) -> Explanation:
    """An explanation by a plain law, and by what lies beyond it of the curves that hold it."""
    curves = _curves_that_hold(weighing, found, law.signatures_mm[:, 0])
    if not curves:
        return found
    places = np.vstack([path.nose_mm for path in weighing.survey.seen_paths])
    terms = list(found.terms)
    for k in curves:
        effect, target = terms[k].effect, terms[k].target
        terms[k] = replace(terms[k], inner=effect.beyond_slope(terms[k].inner, target, places))
    if law.label not in found.labels:
        terms.append(weighing.term(weighing.index_of(law.label), found))
    trial = weighing.explain(terms, found.posterior.sizes, refine=False)
    return trial if trial.score > found.score - CLEARLY else found


def _curves_that_hold(weighing: Weighing, found: Explanation, law_mm: np.ndarray) -> Sequence[int]:
    """Curves of tables that nobody measured, nor a test, which can do what a law (n, 1) does."""
    if found.fit is None:
        return []
    law, machine = orthonormal(weighing.base.white(law_mm)), weighing.survey.job.machine
    return [
        k
        for k, term in enumerate(found.terms)
        if term.effect.corrects_table
        and term.effect.is_unmeasured(machine, term.target)
        and not weighing.survey.is_defined(term.effect, term.target)
        and float(np.linalg.norm(orthonormal(found.fit.signatures[k].white).T @ law)) > _HELD
    ]
