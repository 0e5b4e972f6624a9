"""Positions of a table's entries: evenly spaced, as few as keep the curves within tolerance.

Source: closed form derived here: linear interpolation between entries, held beyond the ends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from vmach.machine import Machine
from vmach.machine.component_errors import component_of

__all__ = ["Knots", "choose_intervals", "hat_matrix"]

#: digits of positions in every format: 0.1 um
POSITION_DIGITS = 4
#: places at which curves are compared with straight lines, and the fewest intervals
_DENSE = 2001
_FEWEST = 2


@dataclass(frozen=True)
class Knots:
    """Evenly spaced positions of entries along one axis, in whole 0.1 um.

    Attributes
    ----------
    low_mm, step_mm : float
        The last entry lies less than one interval's rounding beyond the end of the volume.
    intervals : int
    """

    low_mm: float
    step_mm: float
    intervals: int

    @classmethod
    def over(cls, low_mm: float, high_mm: float, intervals: int) -> Knots:
        """Entries from `low_mm` to `high_mm`, rounded outwards."""
        unit = 10**POSITION_DIGITS
        low = math.floor(low_mm * unit + 1e-6)
        step = math.ceil((high_mm * unit - low) / intervals - 1e-6)
        return cls(low / unit, step / unit, intervals)

    def thinned(self, most_entries: int) -> Knots:
        """The same stretch with at most so many entries."""
        if self.intervals < most_entries:
            return self
        whole_mm = self.step_mm * self.intervals
        return Knots(self.low_mm, whole_mm / (most_entries - 1), most_entries - 1)

    @property
    def position_mm(self) -> np.ndarray:
        """Positions of the entries, (K,) float64, K being `intervals` + 1."""
        steps = self.step_mm * np.arange(self.intervals + 1)
        return np.round(self.low_mm + steps, POSITION_DIGITS)


def hat_matrix(position_mm: np.ndarray, at_mm: np.ndarray) -> csr_matrix:
    """Matrix (P, K) from K entries to linear interpolation at P places, held beyond the ends."""
    left = np.clip(np.searchsorted(position_mm, at_mm, side="right") - 1, 0, len(position_mm) - 2)
    share = (at_mm - position_mm[left]) / (position_mm[left + 1] - position_mm[left])
    share = np.clip(share, 0.0, 1.0)
    rows = np.tile(np.arange(len(at_mm)), 2)
    return csr_matrix(
        (np.concatenate([1.0 - share, share]), (rows, np.concatenate([left, left + 1]))),
        shape=(len(at_mm), len(position_mm)),
    )


def choose_intervals(
    machine: Machine, axis: int, ends_mm: tuple[float, float], *, limit: int, tolerance_mm: float
) -> int:
    """Fewest intervals along an axis at which every curve of its errors is met within tolerance
    by straight lines; `limit` where none is enough.

    Angles count with an arm of half the travel, and with the axis' own position where that is
    part of their arm.

    Tried are powers of two, and those that put an entry on every position measured.
    """
    at = np.linspace(*ends_mm, _DENSE)
    curves, breaks = [], []
    arm_mm = 0.5 * float(np.ptp(machine.travel_mm, axis=0).max())
    own_arm = machine.chain.arm_masks[axis, axis] or machine.measuring_point_travel[:, axis].any()
    for name, component in machine.components.items():
        if component_of(name)[1] != axis:
            continue
        scale = arm_mm if component.is_angle else 1.0
        for way in (1.0, -1.0) if machine.separate_directions else (0.0,):
            curve = component.evaluate(at, np.full(_DENSE, way))
            curves.append(scale * curve)
            if component.is_angle and own_arm:
                curves.append(curve * at)
        breaks.append(component.position_mm)
    if not curves:
        return _FEWEST
    values = np.array(curves)
    inside = np.unique(np.concatenate(breaks))
    for intervals in sorted(_candidates(inside, ends_mm, limit)):
        knots = Knots.over(*ends_mm, intervals).position_mm
        nodes = np.array([np.interp(knots, at, curve) for curve in values])
        met = np.array([np.interp(at, knots, node) for node in nodes])
        if np.abs(met - values).max() <= tolerance_mm:
            return intervals
    return limit


def _candidates(breaks_mm: np.ndarray, ends_mm: tuple[float, float], limit: int) -> set[int]:
    low, high = ends_mm
    share = (breaks_mm[(breaks_mm > low) & (breaks_mm < high)] - low) / (high - low)
    found = {2**k for k in range(1, 20) if 2**k <= limit}
    for intervals in range(_FEWEST, limit + 1):
        off = np.abs(share * intervals - np.round(share * intervals)) * (high - low) / intervals
        if off.max(initial=0.0) < 10.0**-POSITION_DIGITS:
            return found | {k for k in (intervals, 2 * intervals, 4 * intervals) if k <= limit}
    return found
