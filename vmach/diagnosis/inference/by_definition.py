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

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.effects import Effect
from vmach.fit.candidates import Candidate
from vmach.fit.whitening import orthonormal, share_within

__all__ = ["as_defined", "beyond_slopes"]

#: cosine from which on a curve can do all that a law does; it does so exactly, or clearly not
_HELD = 0.98


def as_defined(weighing: Weighing, found: Explanation) -> tuple[Weighing, Explanation]:
    """An explanation by what standards define, where that is not clearly less probable.

    With it the weighing, whose curves have nothing of the plain laws that are there.
    """
    return beyond_slopes(weighing, _as_tested(weighing, found), weighing.candidates)


def beyond_slopes(
    weighing: Weighing, found: Explanation, laws: Sequence[Candidate]
) -> tuple[Weighing, Explanation]:
    """The same of some laws alone: plain ones stand beside curves that hold them, or instead.

    Parameters
    ----------
    weighing : Weighing
    found : Explanation
    laws : sequence of Candidate
    """
    taken, machine = [], weighing.survey.job.machine
    for law in laws:
        is_open = law.effect.is_unmeasured(machine, law.target)
        beside = _beside(weighing, found, law, is_open) if law.effect.goes_before_curves else None
        if beside is not None and beside.score > found.score - CLEARLY:
            found = beside
            taken += [law] * is_open  # of one that was measured a curve may be the change
    if taken:
        curves = ((c, any(_holds(weighing, c, law) for law in taken)) for c in weighing.candidates)
        weighing = weighing.with_candidates([_beyond(weighing, c) if h else c for c, h in curves])
        # sets that were tried before held other curves
        weighing.tried = {found.labels: found.score}
    return weighing, found


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


def _beside(
    weighing: Weighing, found: Explanation, law: Candidate, is_open: bool
) -> Explanation | None:
    """A plain law in place of curves that hold it, or with what lies beyond it of them if open."""
    curves = [
        term
        for term in found.terms
        if _holds(weighing, weighing.candidates[weighing.index_of(term.label)], law)
    ]
    beyond = [
        replace(term, inner=_inner_beyond(weighing, term.effect, term.target, term.inner))
        for term in curves
    ]
    others, is_new = [t for t in found.terms if t not in curves], law.label not in found.labels
    if is_new:
        others.append(weighing.term(weighing.index_of(law.label), found))
    sizes = found.posterior.sizes
    ways = [others, [*others, *beyond]][: 1 + is_open] if is_open or is_new else []
    explained = (weighing.explain(way, sizes, refine=False) for way in ways if beyond != curves)
    return max(explained, key=lambda e: e.score, default=None)


def _holds(weighing: Weighing, curve: Candidate, law: Candidate) -> bool:
    """Whether it is of a table that nobody measured, nor a test, and can do all that a law does."""
    survey, effect, target = weighing.survey, curve.effect, curve.target
    if not effect.corrects_table or survey.is_defined(effect, target):
        return False
    if not effect.is_unmeasured(survey.job.machine, target):
        return False
    white = (weighing.base.white(c.signatures_mm[:, 0].astype(float)) for c in (law, curve))
    return share_within(*map(orthonormal, white)) > _HELD


def _beyond(weighing: Weighing, curve: Candidate) -> Candidate:
    """A curve without slope, as a candidate."""
    effect, target = curve.effect, curve.target
    grid = [_inner_beyond(weighing, effect, target, inner) for inner in curve.grid]
    signatures = [weighing.survey.signature(effect, target, inner) for inner in grid]
    return replace(curve, grid=grid, signatures_mm=np.stack(signatures, axis=1))


def _inner_beyond(
    weighing: Weighing, effect: Effect, target: str, inner: Mapping[str, float]
) -> dict[str, float]:
    """Inner values of a curve that has no slope over the places of all readings."""
    places = np.vstack([path.nose_mm for path in weighing.survey.seen_paths])
    return effect.beyond_slope(inner, target, places)
