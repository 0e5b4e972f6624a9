"""Coverage intervals of drawn values, and the numerical tolerance of a standard uncertainty.

Source: JCGM 101:2008, 7.7 (intervals from ordered values), 5.3.4 (shortest interval), 7.9.2
(numerical tolerance), 8.1 (comparison with first order).
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtri

__all__ = [
    "coverage_factor",
    "numerical_tolerance",
    "shortest_interval",
    "symmetric_interval",
]


def shortest_interval(ordered: np.ndarray, coverage: float) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the shortest interval that holds a share of the values.

    Parameters
    ----------
    ordered : (P, M) float64
        M values of each of P quantities, ascending.
    coverage : float
        The share, such as 0.95.

    Returns
    -------
    low, high : (P,) float64
    """
    held = _held(ordered, coverage)
    width = ordered[:, held:] - ordered[:, : ordered.shape[1] - held]
    first, row = width.argmin(axis=1), np.arange(len(ordered))
    return ordered[row, first], ordered[row, first + held]


def symmetric_interval(ordered: np.ndarray, coverage: float) -> tuple[np.ndarray, np.ndarray]:
    """Ends (P,) of the intervals of values (P, M) with as many values below as above."""
    held = _held(ordered, coverage)
    first = (ordered.shape[1] - held) // 2
    return ordered[:, first], ordered[:, first + held]


def _held(ordered: np.ndarray, coverage: float) -> int:
    """Steps from the low to the high end: q of 7.7.2."""
    return min(int(coverage * ordered.shape[1] + 0.5), ordered.shape[1] - 1)


def numerical_tolerance(u: np.ndarray, digits: int) -> np.ndarray:
    """Half a unit of the last of the digits that matter in u, (P,), in the unit of u."""
    size = np.where(u > 0.0, u, 1.0)
    place = np.floor(np.log10(size)) - (digits - 1)
    # 9.96 with two digits reads 10, which has one place less
    rounded = np.round(size / 10.0**place)
    place = np.where(rounded >= 10.0**digits, place + 1, place)
    return np.where(u > 0.0, 0.5 * 10.0**place, 0.0)


def coverage_factor(coverage: float) -> float:
    """Half the width of a normal distribution's interval, in standard deviations."""
    return float(ndtri(0.5 + 0.5 * coverage))
