"""Monte Carlo for what a drawing asks for: sizes, form, orientation and location of features.

A zone is as wide as the points that decide make it, and other corrections let other points decide.
So a value is no weighted sum of deviations. It is the largest of many such sums: for every set of
points that may decide one, as duality of linear programs says; an inscribed size is the smallest.
Whole evaluations of a few draws find these sums; all draws then take the largest or the smallest.
Further whole evaluations, which found none of the sums, tell by how much this is off.

Source: JCGM 101:2008, clauses 5 to 7; supporting planes of a convex function: Kelley (1960), The
cutting-plane method for solving convex programs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from vmach.prediction import Prediction
from vmach.uncertainty.corrections import Corrections, Part
from vmach.uncertainty.monte_carlo import Drawn, Plan, propagate, stage_random
from vmach.uncertainty.points import point_parts

__all__ = ["Evaluation", "FeaturesDrawn", "draw_features", "prediction_parts"]

#: draws that are evaluated as a whole to find the sums, each with its opposite, and draws that
#: check them, in every round
_PILOTS, _CHECKS = 12, 12
#: rounds at most; one more is worth while where the checks miss by this share of u
_ROUNDS, _CLOSE = 4, 0.05
#: less is rounding, mm
_ROUNDING_MM = 1e-12
#: stages with a number that no stage of the main draws has
_PILOT_STAGE = 2**31
#: points whose causes are looked at together; a few hundred numbers each
_BATCH = 2000

#: from the deviations (C,) of the points that were cut, mm, to J values, mm, and the change of
#: each with every deviation, (J, C)
Evaluation = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class FeaturesDrawn:
    """J values of features under all corrections.

    Attributes
    ----------
    drawn : Drawn
        mm.
    inside : (J,) float64
        Share of the draws within the limits.
    missed_mm : (J,) float64
        By how much the sums were off in the draws that checked them, at most.
    evaluations : int
        Whole evaluations that were made.
    plan : Plan
    """

    drawn: Drawn
    inside: np.ndarray
    missed_mm: np.ndarray
    evaluations: int
    plan: Plan

    @property
    def doubtful(self) -> np.ndarray:
        """Values whose sums were off by more than a share of u that matters, (J,) bool."""
        return self.missed_mm > _CLOSE * self.drawn.u + _ROUNDING_MM


def draw_features(
    parts: list[list[Part]],
    deviation_mm: np.ndarray,
    evaluate: Evaluation,
    limits_mm: np.ndarray,
    plan: Plan,
    *,
    progress: Callable[[int, int], None] | None = None,
) -> FeaturesDrawn:
    """Propagate the corrections of points to the values of features.

    Parameters
    ----------
    parts : list of lists of Part
        Corrections of the C points, batch by batch, each with the same columns; see
        `prediction_parts`.
    deviation_mm : (C,) float64
        Without corrections.
    evaluate : Evaluation
    limits_mm : (J, 2) float64
        Lower and upper limit of every value; they may be infinite.
    plan : Plan
    progress : callable, optional
        Told how many of how many whole evaluations are made, at most.
    """
    sums = _found_sums(parts, deviation_mm, evaluate, plan, progress)
    few = sums.corrections(parts).for_drawing()
    inside, count = np.zeros(len(limits_mm)), 0

    def values(random: np.random.Generator, draws: int) -> np.ndarray:
        nonlocal inside, count
        found = sums.values_mm(few.values_mm(few.draw(random, draws)))
        low, high = limits_mm.T[:, :, None]
        inside = inside + ((found >= low) & (found <= high)).sum(axis=1)
        count += draws
        return found

    drawn = propagate(values, plan)
    return FeaturesDrawn(drawn, inside / count, sums.missed_mm, sums.evaluations, plan)


def prediction_parts(prediction: Prediction) -> list[list[Part]]:
    """Corrections of all points that were cut, batch by batch."""
    rows = np.arange(int(prediction.is_cut.sum()))
    return [point_parts(prediction, one) for one in np.array_split(rows, len(rows) // _BATCH + 1)]


@dataclass(frozen=True)
class _Sums:
    """K sums for each of J values.

    Attributes
    ----------
    at_zero_mm : (J, K) float64
        Of every sum without corrections.
    weight : (J, K, C) float64
    is_largest : (J,) bool
        Whether a value is the largest of its sums, else the smallest.
    missed_mm : (J,) float64
    evaluations : int
    """

    at_zero_mm: np.ndarray
    weight: np.ndarray
    is_largest: np.ndarray
    missed_mm: np.ndarray
    evaluations: int

    def corrections(self, parts: list[list[Part]]) -> Corrections:
        """What the corrections do to all sums, one after the other."""
        flat = self.weight.reshape(-1, self.weight.shape[2])
        ends = np.cumsum([0, *(len(batch[0].signature_mm) for batch in parts if batch)])
        columns = []
        for same in zip(*parts, strict=True):
            own = [flat[:, a:b] for a, b in pairwise(ends)]
            straight = sum(w @ p.signature_mm for w, p in zip(own, same, strict=True))
            curved = None
            if all(part.curved_mm is not None for part in same):
                curved = sum(np.tensordot(w, p.curved_mm, 1)
                             for w, p in zip(own, same, strict=True))  # fmt: skip
            columns.append(Part(same[0].label, straight, same[0].pool, curved))
        return Corrections.of(columns, len(flat))

    def values_mm(self, moved_mm: np.ndarray) -> np.ndarray:
        """Values (J, M) from what the corrections do to the sums, (J K, M)."""
        all_of = self.at_zero_mm[:, :, None] + moved_mm.reshape(*self.at_zero_mm.shape, -1)
        return np.where(self.is_largest[:, None], all_of.max(axis=1), all_of.min(axis=1))


def _found_sums(
    parts: list[list[Part]],
    deviation_mm: np.ndarray,
    evaluate: Evaluation,
    plan: Plan,
    progress: Callable[[int, int], None] | None,
) -> _Sums:
    """Sums of whole evaluations, more of them while checks show that some are missing."""
    places, values, weights = [], [], []
    needed = 1 + 2 * _PILOTS + _CHECKS
    most = needed + (_ROUNDS - 1) * _CHECKS
    random = _drawn(parts, len(deviation_mm), plan.seed, most - 1 - _PILOTS)
    corrections = np.hstack([0.0 * random[:, :1], -random[:, :_PILOTS], random])
    while True:
        for k in range(len(places), needed):
            value, weight = evaluate(deviation_mm + corrections[:, k])
            places.append(corrections[:, k])
            values.append(value)
            weights.append(weight)
            if progress:
                progress(k + 1, most)
        sums = _sums_of(places, values, weights, needed - _CHECKS)
        u = np.std(values, axis=0)
        if needed + _CHECKS > most or (sums.missed_mm <= _CLOSE * u + _ROUNDING_MM).all():
            return sums
        needed += _CHECKS


def _drawn(parts: list[list[Part]], count: int, seed: int, draws: int) -> np.ndarray:
    """Corrections of all points in a few draws, (C, draws) mm."""
    if not any(parts):
        return np.zeros((count, draws))
    whole = [Corrections.of(one, len(one[0].signature_mm), has_all=True) for one in parts]
    drawn = whole[0].draw(stage_random(seed, _PILOT_STAGE), draws)
    return np.vstack([one.values_mm(drawn) for one in whole])


def _sums_of(places: list, values: list, weights: list, known: int) -> _Sums:
    """Sums of all evaluations; those of the first `known` are checked by the rest."""
    place, value = np.array(places), np.array(values).T
    weight = np.array(weights).swapaxes(0, 1)
    at_zero = value - np.einsum("jkc,kc->jk", weight, place)
    # every sum at the place of every evaluation, (J, K, E)
    there = at_zero[:, :, None] + np.einsum("jkc,ec->jke", weight, place, optimize=True)
    above = np.maximum(there - value[:, None], 0.0).sum(axis=(1, 2))
    below = np.maximum(value[:, None] - there, 0.0).sum(axis=(1, 2))
    is_largest = above <= below
    few = there[:, :known]
    told = np.where(is_largest[:, None], few.max(axis=1), few.min(axis=1))
    missed = np.abs(told - value)[:, known:].max(axis=1)
    return _Sums(at_zero, weight, is_largest, missed, len(values))
