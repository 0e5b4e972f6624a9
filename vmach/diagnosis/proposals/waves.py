"""Waves whose period nobody knows: where the periodogram of what is left has its peaks.

Source: T. Deeming, Astrophys. Space Sci. 36 (1975) 137 (Fourier analysis of readings that are not
equally spaced: their gaps leak into other frequencies, so that several peaks are tried);
M. Zechmeister and M. Kürster, Astron. Astrophys. 496 (2009) 577 (the frequency of least squares,
beside a mean; here beside the alignment).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.fft import next_fast_len, rfft

from vmach.diagnosis.proposals.states import ALL_AXES, DIRECTIONS, Direction, State
from vmach.fit.survey import Survey
from vmach.fit.whitening import orthonormal
from vmach.machine import LINEAR_AXES

__all__ = ["wave_states"]

#: cells of the raster in the shortest period, and frequencies in one of independent ones
_CELLS, _FINER = 4, 4
#: frequencies at most; beyond, the shortest waves are left out
_MOST = 1 << 20
#: time constants of what rings after a reversal, s; a factor of four apart, the best is never far
_FADES_S = (0.1, 0.4)
#: peaks of the periodogram that are fitted by least squares: gaps between features may make many
#: others higher than that of the wave
_FITTED = 16
#: readings at most that they are fitted to, evenly spread
_FITTED_ON = 3000
#: of these peaks, so many are put on the list for each argument and direction
_PEAKS = 2
#: a wave has to go round that often, else it is a trend
_LEAST_TURNS = 1.5
#: steps to the frequency of least squares, in cells of the periodogram; the last one turns a wave
#: by 1/64 over the whole way
_STEPS = (1.0, 0.5, 0.25, 0.125, 0.0625)
#: what readings see of a wave that little beside the alignment, of squares, is rounding
_RCOND = 1e-9


@dataclass(frozen=True)
class _Argument:
    """What a wave may go along: words for it, code, and the range of its period.

    `kind` is that of the state, `height` code of how high the wave is. The words take the
    ``period`` and its inverse, ``hertz``.
    """

    kind: str
    words: str
    code: str
    shortest: float
    longest: float = np.inf
    directions: tuple[Direction, ...] = DIRECTIONS
    height: str = "np.ones(len(path))"

    def of(self, survey: Survey, code: str) -> np.ndarray:
        """What code says of each reading, (n,)."""
        return np.concatenate([np.asarray(eval(code, {"np": np, "path": p})) for p in survey.paths])


def _along_axis(k: int, axis: str) -> Iterator[_Argument]:
    """The position of an axis: what pushes anywhere, and what its own encoder does.

    Linear encoders have signal periods of 20 um and more, and err within each (interpolation
    error: catalogues of linear encoders).
    """
    position = f"path.nose_mm[:, {k}]"
    kind, words = f"wave in {axis}", f"a wave of {{period:.4g}} mm in {axis}"
    yield _Argument(kind, words, position, 1.0)
    yield _Argument(kind, words, position, 0.02, 1.0, (DIRECTIONS[k],))


def _after_reversal(k: int, axis: str) -> Iterator[_Argument]:
    """Time since an axis turned: how its drive rings, as it is damped well or badly."""
    since = f"path.time_since_reversal_s[:, {k}]"
    for fade in _FADES_S:
        yield _Argument(
            "ringing",
            f"ringing of {{hertz:.4g}} Hz after {axis} turned, fading within {fade:g} s",
            f"np.minimum({since}, {10.0 * fade:g})",
            0.02,
            directions=(DIRECTIONS[k],),
            height=f"path.play_side[:, {k}] * np.exp(-{since} / {fade:g})",
        )


_ARGUMENTS = (
    *(argument for k, axis in enumerate(LINEAR_AXES) for argument in _after_reversal(k, axis)),
    *(argument for k, axis in enumerate(LINEAR_AXES) for argument in _along_axis(k, axis)),
    # what goes on beside the machining moves all axes
    _Argument(
        "wave in time",
        "a wave of {period:.4g} s in time",
        "path.time_s",
        60.0,
        directions=(*DIRECTIONS, ALL_AXES),
    ),
    _Argument(
        "wave in cutting length",
        "a wave of {period:.4g} mm in cutting length",
        "path.cutting_length_mm",
        2.0,
    ),
)


def wave_states(
    survey: Survey, left_mm: np.ndarray, sensed: dict[Direction, np.ndarray]
) -> Iterator[tuple[State, Direction]]:
    """Sine and cosine of the most conspicuous periods, with the direction they show in.

    Parameters
    ----------
    survey : Survey
    left_mm : (n,) float64
        What is not explained.
    sensed : mapping of Direction to (n, D) float64
        How readings sense a unit displacement.
    """
    for argument in _ARGUMENTS:
        along, height = (argument.of(survey, code) for code in (argument.code, argument.height))
        span = float(np.ptp(along))
        if span < 2.0 * argument.shortest:
            continue
        for direction in argument.directions:
            seen = sensed[direction] * height[:, None]
            if not seen.any():
                continue
            wave = _Wave(survey, along, seen, left_mm)
            leading = sorted(_peaks(wave, argument), key=wave.gain, reverse=True)[:_PEAKS]
            for frequency in leading:
                yield _state(argument, wave.refined(frequency), span), direction


class _Wave:
    """A wave along something, in the direction that readings sense.

    Parameters
    ----------
    survey : Survey
    along : (n,) float64
        What it goes along.
    sensed : (n, D) float64
        How readings sense a unit displacement.
    left_mm : (n,) float64
        What is not explained.
    """

    def __init__(
        self, survey: Survey, along: np.ndarray, sensed: np.ndarray, left_mm: np.ndarray
    ) -> None:
        self.along, self.span = along, float(np.ptp(along))
        self.sensed = sensed / survey.u_mm[:, None]
        self.left = left_mm / survey.u_mm
        self._rows = slice(None, None, -(-len(along) // _FITTED_ON))
        self._alignment = orthonormal((survey.nuisance / survey.u_mm[:, None])[self._rows])

    def refined(self, frequency: float) -> float:
        """The frequency of least squares next to one, uphill in steps that are halved.

        To a sixteenth of a cell of the periodogram, so that what is found again is known.
        """
        gain = cache(lambda k: self.gain(frequency + k * cell))
        cell, best = 1.0 / (_FINER * self.span), 0.0
        for step in _STEPS:
            while (higher := max((best - step, best + step), key=gain)) and (
                gain(higher) > gain(best) and abs(higher) <= _FINER
            ):
                best = higher
        return frequency + best * cell

    def gain(self, frequency: float) -> float:
        """Sum of squares that the wave explains beside the alignment, of whitened readings."""
        along, sensed, left = (v[self._rows] for v in (self.along, self.sensed, self.left))
        turn = 2.0 * np.pi * frequency * along[:, None]
        columns = np.hstack([sensed * np.sin(turn), sensed * np.cos(turn)])
        aligned = self._alignment.T @ columns
        moments = columns.T @ left - aligned.T @ (self._alignment.T @ left)
        products = columns.T @ columns - aligned.T @ aligned
        return float(moments @ np.linalg.lstsq(products, moments, rcond=_RCOND)[0])


def _peaks(wave: _Wave, argument: _Argument) -> list[float]:
    """Frequencies of the highest peaks of the periodogram, none beside another."""
    cell = max(argument.shortest / _CELLS, wave.span * _FINER / _MOST)
    place = np.rint((wave.along - wave.along.min()) / cell).astype(int)
    count = next_fast_len(int(_FINER * (place.max() + 1)), real=True)
    rasters = [np.bincount(place, one) for one in (wave.left[:, None] * wave.sensed).T]
    power = np.sum([np.abs(rfft(raster, count)) ** 2 for raster in rasters], axis=0)
    frequency = np.arange(len(power)) / (count * cell)
    lowest = max(_LEAST_TURNS / wave.span, 1.0 / argument.longest)
    power[(frequency < lowest) | (frequency > 1.0 / (cell * _CELLS))] = 0.0
    found = []
    for _ in range(_FITTED):
        best = int(np.argmax(power))
        if power[best] == 0.0:
            break
        found.append(float(frequency[best]))
        power[max(best - _FINER, 0) : best + _FINER + 1] = 0.0
    return found


def _state(argument: _Argument, frequency: float, span: float) -> State:
    turn = f"{2.0 * np.pi * frequency!r} * {argument.code}"
    return State(
        argument.kind,
        argument.words.format(period=1.0 / frequency, hertz=frequency),
        f"({argument.height})[:, None] * np.stack([np.sin({turn}), np.cos({turn})], axis=1)",
        looked_at=max(span / argument.shortest, 1.0),
    )
