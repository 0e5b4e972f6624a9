"""What the axes have warmed by their motion before a given moment.

Heat is constant on every straight piece of the path's polyline; the responses to it are exact.

Source: closed form derived here: dw/dt = (p - w) / tau with constant p has w = p + (w0 - p)
exp(-t / tau).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numba import njit

from vmach.path.screw_waves import ScrewWaves

__all__ = ["REFERENCE_AXIS_MM_PER_S", "HeatHistory", "response"]

#: mean speed of an axis that thermal amplitudes are stated at: 100 mm/min
REFERENCE_AXIS_MM_PER_S = 100.0 / 60.0


@dataclass(frozen=True)
class HeatHistory:
    """The heat of one program's axes.

    Attributes
    ----------
    corner_mm : (K + 1, 3) float64
        Corners of the path's polyline, axis positions.
    start_s, duration_s : (K,) float64
        Of its straight pieces.
    """

    corner_mm: np.ndarray
    start_s: np.ndarray
    duration_s: np.ndarray
    _heats: dict[int, np.ndarray] = field(default_factory=dict, repr=False)

    def axis_warmth(self, axis: int, time_constant_s: float, time_s: np.ndarray) -> np.ndarray:
        """First-order response to the speed of an axis, (P,); 1 when warm at 100 mm/min."""
        return self._response(self._speed[axis], time_constant_s, time_s)

    def warmth_of_waves(
        self, axis: int, time_constant_s: float, *, waves: ScrewWaves, time_s: np.ndarray
    ) -> np.ndarray:
        """How warm the screw of an axis is in each cosine along it, beside its even warmth, (P, W).

        Used all the time and everywhere alike, at the reference speed, the screw has an even
        warmth of 1. The waves of an axis have to be the same in every call.
        """
        if axis not in self._heats:
            self._heats[axis] = self._per_s(waves.heat_mm(self.corner_mm[:, axis]))
        lag = waves.lag_s(time_constant_s)
        return self._response(self._heats[axis] * (lag / time_constant_s), lag, time_s)

    @cached_property
    def _speed(self) -> list[np.ndarray]:
        """Speed of each axis on every piece, in reference speeds, 3 times (K,)."""
        return [self._per_s(np.abs(way)) for way in np.diff(self.corner_mm, axis=0).T]

    def _per_s(self, travel_mm: np.ndarray) -> np.ndarray:
        """Ways made on the pieces as speeds, in reference speeds; 0 where no time passes."""
        duration = self.duration_s.reshape(-1, *[1] * (travel_mm.ndim - 1))
        speed = np.divide(travel_mm, duration, out=np.zeros_like(travel_mm), where=duration > 0)
        return speed / REFERENCE_AXIS_MM_PER_S

    def _response(
        self, drive: np.ndarray, time_constant_s: float | np.ndarray, time_s: np.ndarray
    ) -> np.ndarray:
        return response(
            drive, time_constant_s, start_s=self.start_s, duration_s=self.duration_s, time_s=time_s
        )


def response(
    drive: np.ndarray,
    time_constant_s: float | np.ndarray,
    *,
    start_s: np.ndarray,
    duration_s: np.ndarray,
    time_s: np.ndarray,
) -> np.ndarray:
    """First-order response, from cold, to a drive that is constant in every interval.

    Parameters
    ----------
    drive : (K,) or (K, W) float64
        What the response tends to in each interval; of W responses at once.
    time_constant_s : float or (W,)
    start_s, duration_s : (K,)
        The intervals, one after the other.
    time_s : (P,)
        When it is asked for; behind the last interval its drive goes on.

    Returns
    -------
    (P,) or (P, W) float64
    """
    drives = drive.reshape(len(drive), -1)
    lag = np.full(drives.shape[1], time_constant_s, dtype=float)
    start = _states_at_starts(drives, duration_s, lag)
    at = np.maximum(np.searchsorted(start_s, time_s, side="right") - 1, 0)
    faded = np.exp(-(time_s - start_s[at])[:, None] / lag)
    found = drives[at] + (start[at] - drives[at]) * faded
    return found.reshape(len(time_s), *drive.shape[1:])


@njit(cache=True)
def _states_at_starts(drive, duration, time_constant):
    """States of first-order lags at the start of every interval, from zero, (K, W)."""
    start = np.zeros(drive.shape)
    for k in range(len(drive) - 1):
        for w in range(drive.shape[1]):
            faded = np.exp(-duration[k] / time_constant[w])
            start[k + 1, w] = drive[k, w] + (start[k, w] - drive[k, w]) * faded
    return start
