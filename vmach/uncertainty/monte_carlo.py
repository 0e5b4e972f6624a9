"""Propagation of distributions: stages of draws until the figures stand still.

Source: JCGM 101:2008, 7.9.4 (adaptive procedure), 8.1 (comparison with first order).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stock.threads import run_in_parts
from vmach.errors import InputError
from vmach.uncertainty.coverage import (
    coverage_factor,
    numerical_tolerance,
    shortest_interval,
    symmetric_interval,
)

__all__ = ["STAGE_DRAWS", "Drawn", "Plan", "propagate", "stage_random"]

#: draws of one stage: 7.9.4 b) asks for 100 / (1 - coverage) and 10,000 at least
STAGE_DRAWS = 10_000
#: values kept at a time, which bounds the memory: 256 MB
_VALUES_AT_ONCE = 32_000_000
#: a comparison with first order needs draws that are this much better than the tolerance (8.2)
_BETTER = 5.0
#: rows that are worth a thread of their own
_ROWS = 4


@dataclass(frozen=True)
class Plan:
    """How a Monte Carlo calculation goes.

    Attributes
    ----------
    digits : int
        Significant digits of u that are to stand.
    coverage : float
        Probability of the intervals.
    most_draws : int
        Where it ends, standing or not.
    least_draws : int
    seed : int
    """

    digits: int = 1
    coverage: float = 0.95
    most_draws: int = 1_000_000
    least_draws: int = 2 * STAGE_DRAWS
    seed: int = 1

    def __post_init__(self) -> None:
        for name, value, accepted, good in (
            ("digits", self.digits, "1, 2 or 3", self.digits in (1, 2, 3)),
            ("coverage", self.coverage, "0.5 .. 0.99", 0.5 <= self.coverage <= 0.99),
            ("most_draws", self.most_draws, f"{2 * STAGE_DRAWS} or more",
             self.most_draws >= max(2 * STAGE_DRAWS, self.least_draws)),
            ("seed", self.seed, "0 or more", self.seed >= 0),
        ):  # fmt: skip
            if not good:
                raise InputError(f"{name} = {value}", accepted=accepted)

    def points_at_once(self) -> int:
        """How many quantities keep all their values within the memory."""
        return max(16, _VALUES_AT_ONCE // self.most_draws)


@dataclass(frozen=True)
class Drawn:
    """What the draws say of P quantities, in their own unit.

    Attributes
    ----------
    mean, u : (P,) float64
    low, high : (P,) float64
        Ends of the shortest coverage interval.
    draws : (P,) int64
    stands : (P,) bool
        Twice the standard deviation of each of these four, over the stages, is within the
        numerical tolerance.
    agrees : (P,) int8
        Whether first order's interval is that of the draws: 1 it is, 0 it is not, -1 too few
        draws to tell.
    """

    mean: np.ndarray
    u: np.ndarray
    low: np.ndarray
    high: np.ndarray
    draws: np.ndarray
    stands: np.ndarray
    agrees: np.ndarray

    @classmethod
    def joined(cls, parts: list[Drawn]) -> Drawn:
        """The same of several sets of quantities, one after the other."""
        return cls(*(np.concatenate([getattr(p, n) for p in parts])
                     for n in cls.__dataclass_fields__))  # fmt: skip


def stage_random(seed: int, stage: int) -> np.random.Generator:
    """Random numbers of one stage, whatever was drawn before."""
    return np.random.default_rng(np.random.SeedSequence([seed, stage]))


def propagate(
    values_of: Callable[[np.random.Generator, int], np.ndarray],
    plan: Plan,
    *,
    first_order: tuple[np.ndarray, np.ndarray] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Drawn:
    """Draw stages until the figures of all quantities stand.

    Parameters
    ----------
    values_of : callable
        Given random numbers and a count M, the values (P, M) of the quantities.
    plan : Plan
    first_order : pair of (P,) float64, optional
        Estimate and standard uncertainty of first order, to be compared.
    progress : callable, optional
        Told how many of how many stages are drawn at most.
    """
    stages: list[np.ndarray] = []
    figures: list[np.ndarray] = []
    most = -(-plan.most_draws // STAGE_DRAWS)
    least = -(-plan.least_draws // STAGE_DRAWS)
    while len(stages) < most:
        values = values_of(stage_random(plan.seed, len(stages)), STAGE_DRAWS)
        _sort_rows(values)
        stages.append(values)
        figures.append(_figures(values, plan.coverage))
        if progress:
            progress(len(stages), most)
        if len(stages) >= max(least, 2) and _standing(stages, figures, plan)[0].all():
            break
    stands, _ = _standing(stages, figures, plan)
    everything = np.concatenate(stages, axis=1)
    _sort_rows(everything)
    mean, u, low, high = _figures(everything, plan.coverage)
    draws = np.full(len(mean), everything.shape[1])
    agrees = np.full(len(mean), -1, dtype=np.int8)
    if first_order is not None:
        agrees = _comparison(stages, everything, first_order, plan)
    return Drawn(mean, u, low, high, draws, stands, agrees)


def _sort_rows(values: np.ndarray) -> None:
    def part(begin: int, end: int) -> None:
        values[begin:end].sort(axis=1)

    run_in_parts(part, len(values), least=_ROWS)


def _figures(ordered: np.ndarray, coverage: float) -> np.ndarray:
    """Mean, standard deviation and ends of the shortest interval, (4, P)."""
    mean, u = ordered.mean(axis=1), ordered.std(axis=1, ddof=1)
    return np.stack([mean, u, *shortest_interval(ordered, coverage)])


def _standing(
    stages: list[np.ndarray], figures: list[np.ndarray], plan: Plan
) -> tuple[np.ndarray, np.ndarray]:
    """Which quantities stand, and the numerical tolerance of each, (P,) (7.9.4 g to k)."""
    found = np.stack(figures)
    tolerance = numerical_tolerance(_pooled_u(stages, found), plan.digits)
    spread = found.std(axis=0, ddof=1) / np.sqrt(len(found))
    return (2.0 * spread <= tolerance).all(axis=0), tolerance


def _pooled_u(stages: list[np.ndarray], found: np.ndarray) -> np.ndarray:
    """Standard deviation of the values of all stages (h, 4, P) together, (P,)."""
    size = stages[0].shape[1]
    within = (size - 1) * (found[:, 1] ** 2).sum(axis=0)
    between = size * ((found[:, 0] - found[:, 0].mean(axis=0)) ** 2).sum(axis=0)
    return np.sqrt((within + between) / (size * len(found) - 1))


def _comparison(
    stages: list[np.ndarray],
    everything: np.ndarray,
    first_order: tuple[np.ndarray, np.ndarray],
    plan: Plan,
) -> np.ndarray:
    """Whether |y - U - y_low| and |y + U - y_high| are within the tolerance (8.1), (P,) int8.

    Intervals with equal probability on both sides, which fewer draws tell (8.1.2, note 1).
    """
    estimate, u = first_order
    expanded = coverage_factor(plan.coverage) * u
    low, high = symmetric_interval(everything, plan.coverage)
    apart = np.maximum(np.abs(estimate - expanded - low), np.abs(estimate + expanded - high))
    tolerance = numerical_tolerance(u, plan.digits)
    ends = np.stack([symmetric_interval(values, plan.coverage) for values in stages])
    error = 2.0 * ends.std(axis=0, ddof=1).max(axis=0) / np.sqrt(len(stages))
    close = (apart <= tolerance).astype(np.int8)
    # too few draws to tell, unless the difference is far from the tolerance either way
    known = (error <= tolerance / _BETTER) | (np.abs(apart - tolerance) > 2.0 * error)
    return np.where(known, close, np.int8(-1))
