"""Trapezoidal speed profile over many moves: how fast through each corner, how long each move.

Accelerations along the path are limited; a corner is passed at the speed at which a circle that
stays within the corner tolerance keeps the limit: v^2 = a d s / (1 - s), s the sine of half the
angle between the two directions turned inside out (junction deviation).

Source: Grbl 1.1, planner (junction deviation); closed form derived here: the circle that touches
both lines at distance d from the corner.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["corner_speeds", "travel_times"]

#: Directions closer than this are tangent, 1 - cosine.
_TANGENT = 1e-9


def corner_speeds(
    leaving: np.ndarray, entering: np.ndarray, *, acceleration_mm_per_s2: float,
    tolerance_mm: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Greatest speed through the corner between each pair of moves, mm/s.

    Parameters
    ----------
    leaving, entering : (N, 3) float64
        Unit direction at the end of a move and at the start of the next.
    acceleration_mm_per_s2 : float
        Limit along and across the path.
    tolerance_mm : (N,) float64
        How far the path may be left; 0 stops at every corner that is not tangent.
    """
    cosine = np.clip(np.einsum("ij,ij->i", leaving, entering), -1.0, 1.0)
    sine = np.sqrt(0.5 * (1.0 + cosine))  # of half the angle between the two moves' lines
    with np.errstate(divide="ignore", invalid="ignore"):
        squared = acceleration_mm_per_s2 * tolerance_mm * sine / (1.0 - sine)
    return np.where(1.0 - cosine < _TANGENT, np.inf, np.sqrt(np.where(sine < 1.0, squared, 0.0)))


@njit(cache=True)
def travel_times(lengths, speeds, corners, acceleration):  # pragma: no cover - compiled
    """Time of every move under look-ahead over the whole sequence.

    Parameters
    ----------
    lengths : (N,) float64
        Path length, mm; moves of length zero take no time and let no speed through.
    speeds : (N,) float64
        Commanded speed, mm/s.
    corners : (N,) float64
        Greatest speed at the end of each move, mm/s.
    acceleration : float
        mm/s^2.

    Returns
    -------
    (N,) float64
        Seconds.
    """
    count = lengths.shape[0]
    end = np.zeros(count + 1)  # speed at the end of move i in end[i + 1]
    for i in range(count - 1):
        end[i + 1] = min(corners[i], speeds[i], speeds[i + 1])
    end[count] = 0.0
    for i in range(count - 1, -1, -1):
        end[i] = min(end[i], np.sqrt(end[i + 1] ** 2 + 2.0 * acceleration * lengths[i]))
    times = np.zeros(count)
    for i in range(count):
        end[i + 1] = min(end[i + 1], np.sqrt(end[i] ** 2 + 2.0 * acceleration * lengths[i]))
        if lengths[i] <= 0.0:
            continue
        first, last, top = end[i], end[i + 1], speeds[i]
        ramps = (2.0 * top * top - first * first - last * last) / (2.0 * acceleration)
        if ramps > lengths[i]:
            top = np.sqrt(acceleration * lengths[i] + 0.5 * (first * first + last * last))
            ramps = lengths[i]
        times[i] = (2.0 * top - first - last) / acceleration + (lengths[i] - ramps) / top
    return times
