"""Waves whose period nobody knows: where the periodogram of what is left has its peaks.

Source: T. Deeming, Astrophys. Space Sci. 36 (1975) 137 (Fourier analysis of readings that are not
equally spaced: their gaps leak into other frequencies, so that several peaks are tried).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
from vmach.diagnosis.proposals.wave_fits import FINER, WaveFits
from vmach.fit.survey import Survey
from vmach.fit.whitening import orthonormal
from vmach.machine import LINEAR_AXES

__all__ = ["wave_states"]

#: cells of the raster in the shortest period
_CELLS = 4
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
    sensed: Mapping[Direction, np.ndarray],
    *,
    smooth_mm: np.ndarray | None = None,
) -> Iterator[tuple[State, Direction]]:
    """Sine and cosine of the most conspicuous periods, with the direction they show in.

    Parameters
    ----------
    survey : Survey
    left_mm : (n,) float64
        What is not explained.
    sensed : mapping of Direction to (n, D) float64
        How readings sense a unit displacement.
    smooth_mm : (n,) float64, optional
        What else of the readings is looked at, for waves but those of an encoder and ringing.
    """
    asked = [(left_mm, True)]
    if smooth_mm is not None and not np.array_equal(smooth_mm, left_mm):
        asked.append((smooth_mm, False))
    waves = [wave for one in asked for wave in _waves(survey, *one, sensed)]
    alignment = orthonormal((survey.nuisance / survey.u_mm[:, None])[_spread(len(survey))])
    found: dict[int, np.ndarray] = {}
    for wide in {wave.sensed.shape[1] for wave in waves}:
        alike = [k for k, wave in enumerate(waves) if wave.sensed.shape[1] == wide]
        leading = _leading([waves[k] for k in alike], alignment)
        found |= dict(zip(alike, leading, strict=True))
    for k, wave in enumerate(waves):
        for frequency in found[k].tolist():
            yield _state(wave.argument, frequency, wave.span), wave.direction


def _spread(count: int) -> slice:
    """Readings that waves are fitted to, of so many."""
    return slice(None, None, -(-count // _FITTED_ON))


@dataclass(frozen=True)
class _Wave:
    """A wave along something, in a direction that readings sense, with peaks of its periodogram.

    Attributes
    ----------
    argument : _Argument
    direction : Direction
    span : float
        How far it goes.
    peaks : list of float
        Frequencies.
    along : (m,) float64
        What it goes along, of the readings that it is fitted to.
    sensed : (m, D) float64
        How these sense a unit displacement, in their uncertainties.
    left : (m,) float64
        What is not explained, in their uncertainties.
    """

    argument: _Argument
    direction: Direction
    span: float
    peaks: list[float]
    along: np.ndarray
    sensed: np.ndarray
    left: np.ndarray


def _waves(
    survey: Survey,
    left_mm: np.ndarray,
    with_high_frequency: bool,
    sensed: Mapping[Direction, np.ndarray],
) -> Iterator[_Wave]:
    """Waves that what is left (n,) mm may show, along all arguments and in all directions."""
    rows, unit = _spread(len(survey)), survey.u_mm[:, None]
    left = left_mm[:, None] / unit
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
        raster = _Raster(along, argument)
        for direction in (d for d in argument.directions if d in sensed):
            own = sensed[direction] * height / unit
            peaks = raster.peaks(left * own) if own.any() else []
            if peaks:
                # of many readings, these hold no memory of the others
                fitted = (np.ascontiguousarray(v[rows]) for v in (along, own, left[:, 0]))
                yield _Wave(argument, direction, span, peaks, *fitted)


def _leading(waves: Sequence[_Wave], alignment: np.ndarray) -> list[np.ndarray]:
    """Frequencies of least squares next to the peaks that explain most, those of each wave."""
    fits = WaveFits(
        np.stack([wave.along for wave in waves]),
        np.stack([wave.sensed for wave in waves]),
        np.stack([wave.left for wave in waves]),
        alignment,
    )
    counts = np.array([len(wave.peaks) for wave in waves])
    most = int(counts.max())
    # where there are fewer, the first fills up
    peaks = np.array([wave.peaks + wave.peaks[:1] * (most - len(wave.peaks)) for wave in waves])
    gains = fits.gains(peaks)
    gains[np.arange(most) >= counts[:, None]] = -np.inf
    order = np.argsort(-gains, axis=1, kind="stable")[:, :_PEAKS]
    peaks, gains = (np.take_along_axis(values, order, axis=1) for values in (peaks, gains))
    cells = np.array([1.0 / (FINER * wave.span) for wave in waves])
    refined = fits.refined(peaks, gains, cells)
    return [own[:count] for own, count in zip(refined, counts.tolist(), strict=True)]


class _Raster:
    """Cells along an argument, over which periodograms are taken.

    Parameters
    ----------
    along : (n,) float64
    argument : _Argument
    """

    def __init__(self, along: np.ndarray, argument: _Argument) -> None:
        span = float(np.ptp(along))
        cell = max(argument.shortest / _CELLS, span * FINER / _MOST)
        self._place = np.rint((along - along.min()) / cell).astype(int)
        self._count = next_fast_len(int(FINER * (self._place.max() + 1)), real=True)
        places = int(np.count_nonzero(np.bincount(self._place)))
        highest = 1.0 / (cell * _CELLS)
        if places < _FEW_PLACES:
            highest = min(highest, 0.5 * (places - 1) / span)
        lowest = max(_LEAST_TURNS / span, 1.0 / argument.longest)
        self._frequency = np.arange(self._count // 2 + 1) / (self._count * cell)
        self._is_out = (self._frequency < lowest) | (self._frequency > highest)

    def peaks(self, weights: np.ndarray) -> list[float]:
        """Frequencies of the highest peaks of the periodogram of (n, D), none beside another."""
        rasters = (np.bincount(self._place, one).astype(np.float32) for one in weights.T)
        heights = [np.abs(rfft(raster, self._count)) for raster in rasters]
        power = np.sum(np.square(heights, dtype=np.float64), axis=0)
        power[self._is_out] = 0.0
        found = []
        for _ in range(_FITTED):
            best = int(np.argmax(power))
            if power[best] == 0.0:
                break
            found.append(float(self._frequency[best]))
            power[max(best - FINER, 0) : best + FINER + 1] = 0.0
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
