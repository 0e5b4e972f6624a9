"""Every effect on every target that the measurements could show, with its signatures.

Source: closed form derived here: inner parameters have a log-normal prior on their grid.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from vmach.effects import Effect, catalogue, label_of
from vmach.fit.survey import Survey

__all__ = ["Candidate", "candidate_of", "gather_candidates"]

#: an effect is blind when its usual size stays below this share of the smallest uncertainty
_BLIND = 1e-3


@dataclass(frozen=True)
class Candidate:
    """An effect on a target.

    Attributes
    ----------
    effect : Effect
    target : str
    grid : list of dict
        G combinations of inner parameters.
    log_prior : (G,) float64
        How usual each combination is; the exponentials add up to one.
    signatures_mm : (n, G, K) float32 or float64
        What one usual size of each of K coefficients does to the readings.
    """

    effect: Effect
    target: str
    grid: list[dict[str, float]]
    log_prior: np.ndarray
    signatures_mm: np.ndarray

    @property
    def rows_mm(self) -> np.ndarray:
        """The signatures of one place after the other, (G K, n)."""
        return self.signatures_mm.transpose(1, 2, 0).reshape(-1, len(self.signatures_mm))

    @property
    def label(self) -> str:
        """Name and target."""
        return label_of(self.effect.name, self.target)

    @property
    def is_curve(self) -> bool:
        """Whether its coefficients are a curve, and no amounts."""
        return not self.effect.amplitudes


def gather_candidates(
    survey: Survey, effects: Iterable[Effect] | None = None
) -> tuple[list[Candidate], list[tuple[Effect, str, str]]]:
    """Candidates of a survey, and (effect, target, why) of those that it cannot show.

    Parameters
    ----------
    survey : Survey
    effects : iterable of Effect, optional
        The whole catalogue where left out.
    """
    found, excluded = [], []
    for effect in catalogue().values() if effects is None else effects:
        for target in effect.possible_targets(survey.job):
            reason = survey.not_testable(effect, target)
            if reason is None:
                candidate = candidate_of(survey, effect, target)
                if candidate is not None:
                    found.append(candidate)
                    continue
                reason = "the measurements do not depend on it"
            excluded.append((effect, target, reason))
    return found, excluded


def candidate_of(survey: Survey, effect: Effect, target: str) -> Candidate | None:
    """An effect on one target, or None where its usual size hardly shows."""
    grid = survey.inner_grid(effect, target)
    if not grid:
        return None
    first = survey.signature(effect, target, grid[0])
    # place by place in memory, and each once: all signatures together are the largest of all.
    # Rounded they are those of a law that differs in the eighth digit
    rows = np.empty((len(grid), first.shape[1], len(first)), dtype=np.float32)
    is_blind = True
    others = (survey.signature(effect, target, inner) for inner in grid[1:])
    for row, columns in zip(rows, itertools.chain([first], others), strict=True):
        row[:] = columns.T
        is_blind = is_blind and _is_blind(survey, columns)
    if is_blind:
        return None
    log_prior = np.array([_log_prior(effect, inner) for inner in grid])
    signatures = rows.transpose(2, 0, 1)
    return Candidate(effect, target, grid, log_prior - logsumexp(log_prior), signatures)


def _is_blind(survey: Survey, columns: np.ndarray) -> bool:
    """Whether columns (n, K) mm hardly show: what a zero or an alignment can take up does not."""
    shown = np.abs(columns - survey.aligned(columns)).max(initial=0.0)
    return bool(shown < _BLIND * survey.u_mm.min())


def _log_prior(effect: Effect, inner: Mapping[str, float]) -> float:
    spread = {p.name: (p.usual, p.spread) for p in effect.inner_parameters}
    return sum(
        -0.5 * (np.log(value / spread[name][0]) / spread[name][1]) ** 2
        for name, value in inner.items()
        if name in spread and np.isfinite(spread[name][1])
    )
