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
    for k in range(2, len(value)):
        apart[k] = abs(value[k] - np.median(value[max(k - _NEIGHBOURS, 0) : k]))
    return apart
