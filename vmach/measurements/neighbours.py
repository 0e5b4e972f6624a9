"""How well a reading agrees with those next to it."""

from __future__ import annotations

import numpy as np

__all__ = ["apart_from_neighbours"]

#: neighbours on each side that a reading is compared with, and the fewest of one group
_NEIGHBOURS = 3
_FEWEST = 8


def apart_from_neighbours(value: np.ndarray, group: np.ndarray) -> np.ndarray:
    """How far each value lies from the median of its neighbours on the side that is nearer.

    Parameters
    ----------
    value : (P,) float64
    group : (P,) str
        Neighbours are those next to each other within a group.

    Returns
    -------
    (P,) float64
        Zero in groups of fewer than eight.
    """
    apart = np.zeros(len(value))
    for name in np.unique(group):
        rows = np.flatnonzero(group == name)
        if len(rows) >= _FEWEST:
            before = _from_those_before(value[rows])
            after = _from_those_before(value[rows][::-1])[::-1]
            apart[rows] = np.minimum(before, after)
    return apart


def _from_those_before(value: np.ndarray) -> np.ndarray:
    """Distance of each value from the median of the few before it; infinite for the first two."""
    apart = np.full(len(value), np.inf)
    apart[2] = abs(value[2] - np.mean(value[:2]))
    few = np.lib.stride_tricks.sliding_window_view(value[:-1], _NEIGHBOURS)
    apart[_NEIGHBOURS:] = np.abs(value[_NEIGHBOURS:] - np.median(few, axis=1))
    return apart
