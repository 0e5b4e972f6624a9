"""How well a reading agrees with those next to it."""

from __future__ import annotations

import numpy as np

__all__ = ["apart_from_few", "apart_from_neighbours"]

#: neighbours on each side that a reading is compared with, and the fewest of one group
_NEIGHBOURS = 3
_FEWEST = 8


def apart_from_neighbours(
    value: np.ndarray, group: np.ndarray, *, few: np.ndarray | float = 0.0
) -> np.ndarray:
    """How far each value lies from the median of its neighbours on the side that is nearer.

    Parameters
    ----------
    value : (P,) float64
    group : (P,) str
        Neighbours are those next to each other within a group.
    few : (P,) float64 or float
        What is given back in groups of fewer than eight.

    Returns
    -------
    (P,) float64
    """
    apart = np.array(np.broadcast_to(few, len(value)), dtype=np.float64)
    for name in np.unique(group):
        rows = np.flatnonzero(group == name)
        if len(rows) >= _FEWEST:
            before = _from_those_before(value[rows])
            after = _from_those_before(value[rows][::-1])[::-1]
            apart[rows] = np.minimum(before, after)
    return apart


def apart_from_few(value: np.ndarray, group: np.ndarray) -> np.ndarray:
    """How far each value lies from the median of the others of its group; infinite of one or two.

    Parameters
    ----------
    value : (P,) float64
    group : (P,) str

    Returns
    -------
    (P,) float64
        Zero in groups of eight or more, where neighbours tell.
    """
    _, number, count = np.unique(group, return_inverse=True, return_counts=True)
    own = count[number]
    apart = np.where(own < _FEWEST, np.inf, 0.0)
    order = np.argsort(number, kind="stable")
    for size in range(3, _FEWEST):
        rows = order[own[order] == size].reshape(-1, size)
        for k in range(size):
            others = np.median(value[np.delete(rows, k, axis=1)], axis=1)
            apart[rows[:, k]] = np.abs(value[rows[:, k]] - others)
    return apart


def _from_those_before(value: np.ndarray) -> np.ndarray:
    """Distance of each value from the median of the few before it; infinite for the first two."""
    apart = np.full(len(value), np.inf)
    apart[2] = abs(value[2] - np.mean(value[:2]))
    few = np.lib.stride_tricks.sliding_window_view(value[:-1], _NEIGHBOURS)
    apart[_NEIGHBOURS:] = np.abs(value[_NEIGHBOURS:] - np.median(few, axis=1))
    return apart
