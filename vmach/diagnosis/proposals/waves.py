"""Waves whose period nobody knows: where the periodogram of what is left has its peaks.

Source: T. Deeming, Astrophys. Space Sci. 36 (1975) 137 (Fourier analysis of readings that are not
equally spaced: their gaps leak into other frequencies, so that several peaks are tried);
M. Zechmeister and M. Kürster, Astron. Astrophys. 496 (2009) 577 (the frequency of least squares,
beside a mean; here beside the alignment).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len, rfft

from vmach.diagnosis.proposals.states import (
    ALL_AXES,
    CUT,
    DIRECTIONS,
    TILTS,
    Direction,
    State,
)
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
#: of fewer places than this, as floors are at few heights, waves of any short period tell each its
#: own value: only those are sought that go round no more than once in two places (Nyquist); chosen:
#: four times the places that sine, cosine and period follow in any case
_FEW_PLACES = 12
#: a wave has to go round that often, else it is a trend
_LEAST_TURNS = 1.5
#: steps to the frequency of least squares, in cells of the periodogram; the last one turns a wave
#: by 1/64 over the whole way
_STEPS = (1.0, 0.25, 0.0625)
#: share of a wave's squares; what readings see beside the alignment below that is rounding: the
#: square of single precision, 1e-14, with room for few readings
_RCOND = 1e-9


@dataclass(frozen=True)
class _Argument:
    """What a wave may go along: words for it, code, and the range of its period.

    `kind` is that of the state, `height` code of how high the wave is, if not one, and `axis` that
    whose motion it follows. The words take the ``period`` and its inverse, ``hertz``. A smooth
    discrepancy takes none of high frequency.
    """

    kind: str
    words: str
    code: str
    shortest: float
    longest: float = np.inf
    directions: tuple[Direction, ...] = DIRECTIONS
    height: str = ""
    axis: str = ""
    is_high_frequency: bool = False

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
    yield _Argument(kind, words, position, 0.02, 1.0, (DIRECTIONS[k],), is_high_frequency=True)


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
            axis=axis,
            is_high_frequency=True,
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
        directions=(*DIRECTIONS, ALL_AXES, *TILTS),
    ),
    _Argument(
        "wave in cutting length",
        "a wave of {period:.4g} mm in cutting length",
        "path.cutting_length_mm",
        2.0,
    ),
)


def wave_states(
    survey: Survey,
    left_mm: np.ndarray,
    sensed: dict[Direction, np.ndarray],
    *,
    with_high_frequency: bool = True,
) -> Iterator[tuple[State, Direction]]:
    """Sine and cosine of the most conspicuous periods, with the direction they show in.

    Parameters
    ----------
    survey : Survey
    left_mm : (n,) float64
        What is not explained.
    sensed : mapping of Direction to (n, D) float64
        How readings sense a unit displacement.
    with_high_frequency : bool
        Whether waves of an encoder and ringing are sought as well.
    """
    scale = 1.0 / survey.u_mm
    alignment = orthonormal((survey.nuisance * scale[:, None])[_spread(len(survey))])
    for argument in _ARGUMENTS:
        if argument.is_high_frequency and not with_high_frequency:
            continue
        if argument.kind in CUT and not survey.has_part:
            continue
        along = argument.of(survey, argument.code)
        height = argument.of(survey, argument.height)[:, None] if argument.height else 1.0
        span = float(np.ptp(along))
        if span < 2.0 * argument.shortest:
            continue
        for direction in (d for d in argument.directions if d in sensed):
            seen = sensed[direction] * height
            if not seen.any():
                continue
            wave = _Wave(along, seen * scale[:, None], left_mm * scale, alignment)
            for frequency in wave.refined(_leading(wave, argument)).tolist():
                yield _state(argument, frequency, span), direction


def _spread(count: int) -> slice:
    """Readings that waves are fitted to, of so many."""
    return slice(None, None, -(-count // _FITTED_ON))


class _Wave:
    """A wave along something, in the direction that readings sense.

    Parameters
    ----------
    along : (n,) float64
        What it goes along.
    sensed : (n, D) float64
        How readings sense a unit displacement, in their uncertainties.
    left : (n,) float64
        What is not explained, in their uncertainties.
    alignment : (m, a) float64
        Orthonormal columns of the alignment, where waves are fitted.
    """

    def __init__(
        self, along: np.ndarray, sensed: np.ndarray, left: np.ndarray, alignment: np.ndarray
    ) -> None:
        self.along, self.span = along, float(np.ptp(along))
        self.sensed, self.left = sensed, left
        rows = _spread(len(along))
        own, beside = sensed[rows], np.column_stack([left[rows], alignment])
        self._along = along[rows]
        # products of a sine and a cosine with these are all that a frequency asks for
        self._squares = (own[:, :, None] * own[:, None, :]).reshape(len(own), -1)
        self._beside = (own[:, :, None] * beside[:, None, :]).reshape(len(own), -1)
        self._aligned = alignment.T @ left[rows]

    def refined(self, frequencies: np.ndarray) -> np.ndarray:
        """The frequencies of least squares next to F, uphill in ever smaller steps, (F,).

        To a sixteenth of a cell of the periodogram, so that what is found again is known.
        """
        cell, best = 1.0 / (_FINER * self.span), np.zeros(len(frequencies))
        most = self.gains(frequencies)
        for step in _STEPS:
            moving = np.arange(len(frequencies))
            while len(moving):
                trials = np.clip(best[moving] + [[-step], [step]], -_FINER, _FINER)
                gains = self.gains((frequencies[moving] + trials * cell).ravel())
                gains = gains.reshape(trials.shape)
                sides = gains.argmax(axis=0), np.arange(len(moving))
                higher = gains[sides] > most[moving]
                moving = moving[higher]
                best[moving], most[moving] = trials[sides][higher], gains[sides][higher]
        return frequencies + best * cell

    def gains(self, frequencies: np.ndarray) -> np.ndarray:
        """Sum of squares that each of F waves explains beside the alignment, (F,)."""
        products, moments = self._normal_equations(frequencies)
        return np.sum(moments * np.linalg.solve(products, moments[:, :, None])[:, :, 0], axis=1)

    def _normal_equations(self, frequencies: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of sine and cosine beside the alignment, (F, 2 D, 2 D) and (F, 2 D)."""
        count, directions = len(frequencies), self.sensed.shape[1]
        # of a part of a turn single precision is enough, and ten times as fast
        turns = np.multiply.outer(frequencies, self._along)
        angle = (2.0 * np.pi * (turns - np.rint(turns))).astype(np.float32)
        sine, cosine = np.sin(angle).astype(np.float64), np.cos(angle).astype(np.float64)
        pairs = np.concatenate([sine * sine, sine * cosine, cosine * cosine]) @ self._squares
        ss, sc, cc = pairs.reshape(3, count, directions, directions)
        rows = [np.concatenate(row, axis=2) for row in ((ss, sc), (sc, cc))]
        beside = np.concatenate([sine, cosine]) @ self._beside
        beside = beside.reshape(2, count, directions, 1 + len(self._aligned))
        seen, aligned = np.split(np.concatenate(beside, axis=1), [1], axis=2)
        products = np.concatenate(rows, axis=1)
        least = _RCOND * np.trace(products, axis1=1, axis2=2)[:, None, None]
        products += np.maximum(least, 1e-300) * np.eye(2 * directions)
        products -= aligned @ aligned.transpose(0, 2, 1)
        return products, seen[:, :, 0] - aligned @ self._aligned


def _leading(wave: _Wave, argument: _Argument) -> np.ndarray:
    """Frequencies of the peaks of the periodogram that explain most, (F,)."""
    peaks = np.array(_peaks(wave, argument))
    if not len(peaks):
        return peaks
    return peaks[np.argsort(-wave.gains(peaks), kind="stable")[:_PEAKS]]


def _peaks(wave: _Wave, argument: _Argument) -> list[float]:
    """Frequencies of the highest peaks of the periodogram, none beside another."""
    cell = max(argument.shortest / _CELLS, wave.span * _FINER / _MOST)
    place = np.rint((wave.along - wave.along.min()) / cell).astype(int)
    count = next_fast_len(int(_FINER * (place.max() + 1)), real=True)
    weights = (wave.left[:, None] * wave.sensed).T
    rasters = (np.bincount(place, one).astype(np.float32) for one in weights)
    heights = [np.abs(rfft(raster, count)) for raster in rasters]
    power = np.sum(np.square(heights, dtype=np.float64), axis=0)
    frequency = np.arange(len(power)) / (count * cell)
    lowest = max(_LEAST_TURNS / wave.span, 1.0 / argument.longest)
    places = len(np.unique(place))
    highest = 1.0 / (cell * _CELLS)
    if places < _FEW_PLACES:
        highest = min(highest, 0.5 * (places - 1) / wave.span)
    power[(frequency < lowest) | (frequency > highest)] = 0.0
    found = []
    for _ in range(_FITTED):
        best = int(np.argmax(power))
        if power[best] == 0.0:
            break
        found.append(float(frequency[best]))
        power[max(best - _FINER, 0) : best + _FINER + 1] = 0.0
    return found


def _state(argument: _Argument, frequency: float, span: float) -> State:
    turn = f"2.0 * np.pi / {1.0 / frequency!r} * {argument.code}"
    high = f"({argument.height})[:, None] * " * bool(argument.height)
    return State(
        argument.kind,
        argument.words.format(period=1.0 / frequency, hertz=frequency),
        f"{high}np.stack([np.sin({turn}), np.cos({turn})], axis=1)",
        looked_at=max(span / argument.shortest, 1.0),
        each=("sine", "cosine"),
        axis=argument.axis,
    )
