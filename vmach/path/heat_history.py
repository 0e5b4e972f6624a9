"""What the axes have warmed by their motion before a given moment.

Heat is constant on every straight piece of the path's polyline; the responses to it are exact.

Source: closed form derived here: dw/dt = (p - w) / tau with constant p has w = p + (w0 - p)
exp(-t / tau).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numba import njit

__all__ = ["REFERENCE_AXIS_MM_PER_S", "HeatHistory", "response"]

#: mean speed of an axis that thermal amplitudes are stated at: 100 mm/min
REFERENCE_AXIS_MM_PER_S = 100.0 / 60.0

#: cosines that the temperature along a screw is made of
_SCREW_WAVES = 12
#: of carbon steel near room temperature
_STEEL_DIFFUSIVITY_MM2_PER_S = 13.0


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
        drive = self._per_s(np.abs(np.diff(self.corner_mm[:, axis])))
        return self._response(drive, time_constant_s, time_s)

    def screw_warmth_mm(
        self, axis: int, time_constant_s: float, *, travel_mm: tuple[float, float],
        time_s: np.ndarray, position_mm: np.ndarray,
    ) -> np.ndarray:  # fmt: skip
        """Warmth of a screw that is heated where its nut runs, summed from home to the nut.

        Heat enters the places that the nut passes, by the way it makes there, spreads along the
        steel and is lost to the air with the time constant; no heat leaves by the ends. The
        temperature is a sum of cosines along the screw, each of which follows its share of the
        heat with a lag of its own: 1 / time constant + diffusivity (m pi / length)^2. Used all
        the time and everywhere alike, at the reference speed, the screw has a warmth of 1.

        Parameters
        ----------
        axis : int
        time_constant_s : float
        travel_mm : (float, float)
            Where the screw begins and ends; the same in every call.
        time_s, position_mm : (P,)
            Where it is asked for; positions of the axis.

        Returns
        -------
        (P,) float64
            Integral of the warmth over the screw from 0 to `position_mm`, mm.
        """
        low, high = travel_mm
        wave = np.pi * np.arange(1, _SCREW_WAVES + 1) / (high - low)
        rate = 1.0 / time_constant_s + _STEEL_DIFFUSIVITY_MM2_PER_S * wave**2
        lag = 1.0 / rate
        drive = self._heat_of_waves(axis, wave, low) * (lag / time_constant_s)
        warmth = self._response(drive, lag, time_s)
        sines = np.sin(np.multiply.outer(position_mm - low, wave)) + np.sin(wave * low)
        even = self.axis_warmth(axis, time_constant_s, time_s) * position_mm
        return even + (warmth * sines) @ (1.0 / wave)

    def _heat_of_waves(self, axis: int, wave: np.ndarray, low: float) -> np.ndarray:
        """Heat of every piece in cosines along the screw, in reference speeds, (K, waves)."""
        if axis not in self._heats:
            place = self.corner_mm[:, axis]
            sines = np.sin(np.multiply.outer(place - low, wave)) / wave
            forwards = np.sign(np.diff(place))[:, None]
            self._heats[axis] = self._per_s(2.0 * forwards * np.diff(sines, axis=0))
        return self._heats[axis]

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
