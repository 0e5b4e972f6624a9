"""How well a reading agrees with those next to it.

Source: closed form derived here: second differences of independent readings have the variance 6
u^2; the median of absolute normal values is 0.6745 of their standard deviation. ISO
16610-21 for the Gaussian filter of scans, which makes neighbours alike.
"""

from __future__ import annotations

import numpy as np

__all__ = [
    "MEDIAN_OF_NORMAL",
    "apart_from_few",
    "apart_from_neighbours",
    "scatter_of_neighbours",
    "unfiltered_scatter",
]

#: median of absolute normal values, in their standard deviation
MEDIAN_OF_NORMAL = 0.6745
#: neighbours on each side that a reading is compared with, and the fewest of one group
_NEIGHBOURS = 3
_FEWEST = 8
#: readings twice as far apart that scatter by no more than so many times are independent; chosen:
#: two such scatters of white noise differ by less from a hundred readings on
_ALIKE = 1.2
#: readings so many rows apart are independent, if a filter made them alike; chosen: of points
#: 0.1 mm apart a filter of 2.5 mm reaches 25 rows
_FARTHEST = 32
#: second differences of fewer readings say too little
_FEWEST_BENDS = 100


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


def scatter_of_neighbours(value: np.ndarray, group: np.ndarray, *, rows: int = 1) -> float:
    """Standard uncertainty of a value, from second differences within each group; robust.

    Parameters
    ----------
    value : (P,) float64
    group : (P,) str
    rows : int
        How far apart the readings are that are compared.

    Returns
    -------
    float
        That of all values where no group has three of them.
    """
    bend = _bends(value, group, rows)
    if len(bend) == 0:
        return float(np.std(value))
    return float(np.median(np.abs(bend)) / MEDIAN_OF_NORMAL / np.sqrt(6.0))


def unfiltered_scatter(value: np.ndarray, group: np.ndarray) -> float:
    """The same of readings that may have been filtered: neighbours then scatter too little.

    Readings further and further apart are compared, until more distance changes nothing. Where it
    goes on growing there is a form of the surface and no filter, and neighbours count.

    Parameters
    ----------
    value : (P,) float64
    group : (P,) str
    """
    near = here = scatter_of_neighbours(value, group)
    rows = 2
    while rows <= _FARTHEST and len(_bends(value, group, rows)) >= _FEWEST_BENDS:
        there = scatter_of_neighbours(value, group, rows=rows)
        if there <= _ALIKE * here:
            return here
        here, rows = there, 2 * rows
    return near


def _bends(value: np.ndarray, group: np.ndarray, rows: int) -> np.ndarray:
    """Second differences of readings so many rows apart, of all groups."""
    found = []
    for name in np.unique(group):
        own = value[group == name]
        if len(own) > 2 * rows:
            found.append(own[2 * rows :] - 2.0 * own[rows:-rows] + own[: -2 * rows])
    return np.concatenate(found) if found else np.empty(0)
