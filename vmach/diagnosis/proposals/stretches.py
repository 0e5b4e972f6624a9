"""Stretches of time in which something else acts, from when to when nobody knows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vmach.diagnosis.proposals.matched import matched_power, peaks
from vmach.diagnosis.proposals.states import CONSTANT, Direction, State
from vmach.fit.survey import Survey

__all__ = ["stretch_states"]

#: ends at most that are tried, evenly among the readings in their order of time
_ENDS = 100
#: stretches of most power among which peaks are looked for
_COMPARED = 200
#: peaks of each direction that are put on the list
_PEAKS = 2


def stretch_states(
    survey: Survey,
    left_mm: np.ndarray,
    sensed: dict[Direction, np.ndarray],
    tools: Sequence[tuple[State, np.ndarray]],
) -> Iterator[tuple[State, State, Direction]]:
    """The most conspicuous stretches of time, of all readings or those of a tool.

    Parameters
    ----------
    survey : Survey
    left_mm : (n,) float64
        What is not explained.
    sensed : mapping of Direction to (n, D) float64
        How readings sense a unit displacement.
    tools : sequence of (State, (n,) float64)
        Which readings a tool cut.
    """
    time = np.concatenate([path.time_s for path in survey.paths])
    every = [(CONSTANT, np.ones(len(time))), *tools]
    for first, share in every:
        for direction, columns in sensed.items():
            if direction.lever or direction.needs_surface:
                continue
            own = columns * (share / survey.u_mm)[:, None]
            for start_s, end_s, looked_at in _found(time, own, left_mm / survey.u_mm):
                yield first, _state(start_s, end_s, looked_at), direction


def _found(
    time: np.ndarray, columns: np.ndarray, reading: np.ndarray
) -> Iterator[tuple[float, float, float]]:
    """Start and end of the stretches of most power, and how many were tried."""
    rows = np.flatnonzero(np.abs(columns).max(axis=1) > 0.0)
    rows = rows[np.argsort(time[rows], kind="stable")]
    if len(rows) < 3 or np.ptp(time[rows]) == 0.0:
        return
    times = time[rows]
    power = _Power(columns[rows], reading[rows])
    # none parts readings of one time
    parts = np.flatnonzero(np.diff(times, prepend=-np.inf, append=np.inf) > 0.0)
    ends = parts[np.unique(np.linspace(0, len(parts) - 1, _ENDS + 1).astype(int))]
    first, last = (ends[k] for k in np.triu_indices(len(ends), 1))
    taken = power.of(first, last)
    best = np.argpartition(-taken, min(_COMPARED, len(taken) - 1))[:_COMPARED]
    best = best[np.argsort(-taken[best])]
    compared = _Cosines(first[best], last[best])
    cuts = np.concatenate([[0.0], 0.5 * (times[1:] + times[:-1]), [np.inf]])
    for k in best[peaks(taken[best], compared.of, _PEAKS)]:
        start, end = power.best_near(first[k], last[k], ends, parts)
        if (start, end) != (0, len(rows)):
            yield float(cuts[start]), float(cuts[end]), float(len(first))


@dataclass(frozen=True)
class _Cosines:
    """How much T stretches share, from one reading each to before another, (T,)."""

    first: np.ndarray
    last: np.ndarray

    def of(self, k: int) -> np.ndarray:
        """Readings that each shares with one, of the geometric mean of their numbers, (T,)."""
        first, last = np.maximum(self.first, self.first[k]), np.minimum(self.last, self.last[k])
        count = self.last - self.first
        return np.maximum(last - first, 0) / np.sqrt(count * count[k])


class _Power:
    """What stretches of readings in their order of time take off the sum of squares.

    Parameters
    ----------
    columns : (n, D) float64
        How readings sense a unit displacement, in unit noise.
    reading : (n,) float64
    """

    def __init__(self, columns: np.ndarray, reading: np.ndarray) -> None:
        self._seen = _sums(columns * reading[:, None])
        self._gram = _sums(columns[:, :, None] * columns[:, None, :])

    def of(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Of T stretches, from one reading (T,) to before another (T,)."""
        seen = self._seen[last] - self._seen[first]
        return matched_power(seen, self._gram[last] - self._gram[first])

    def best_near(
        self, first: int, last: int, ends: np.ndarray, parts: np.ndarray
    ) -> tuple[int, int]:
        """Start and end of the most power within one step of those that were tried."""
        tried = []
        for end in (first, last):
            k = int(np.searchsorted(ends, end))
            low, high = ends[max(k - 1, 0)], ends[min(k + 1, len(ends) - 1)]
            tried.append(parts[(parts >= low) & (parts <= high)])
        starts, stops = (grid.ravel() for grid in np.meshgrid(*tried, indexing="ij"))
        is_ordered = starts < stops
        starts, stops = starts[is_ordered], stops[is_ordered]
        best = int(np.argmax(self.of(starts, stops)))
        return int(starts[best]), int(stops[best])


def _sums(values: np.ndarray) -> np.ndarray:
    """Sums of the first 0, 1, ... n rows."""
    return np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(values, axis=0)])


def _state(start_s: float, end_s: float, looked_at: float) -> State:
    until = "the end" if np.isinf(end_s) else f"{end_s:.0f} s"
    end = "np.inf" if np.isinf(end_s) else repr(float(end_s))
    return State(
        "stretch of time",
        f"the time from {start_s:.0f} s to {until}",
        f"(path.time_s >= {float(start_s)!r}) & (path.time_s < {end})",
        looked_at=max(looked_at, 1.0),
    )
