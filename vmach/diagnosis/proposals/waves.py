"""Waves whose period nobody knows: where the periodogram of what is left has its peaks.

Source: T. Deeming, Astrophys. Space Sci. 36 (1975) 137 (Fourier analysis of readings that are not
equally spaced: their gaps leak into other frequencies, so that several peaks are tried).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len, rfft

from vmach.diagnosis.proposals.states import ALL_AXES, DIRECTIONS, Direction, State
from vmach.fit.survey import Survey
from vmach.machine import LINEAR_AXES

__all__ = ["wave_states"]

#: cells of the raster in the shortest period, and frequencies in one of independent ones
_CELLS, _FINER = 8, 4
#: frequencies at most; beyond, the shortest waves are left out
_MOST = 1 << 18
#: peaks of each argument and direction that are put on the list; gaps between features may make
#: another one higher than that of the wave
_PEAKS = 4
#: a wave has to go round that often, else it is a trend
_LEAST_TURNS = 1.5


@dataclass(frozen=True)
class _Argument:
    """What a wave may go along: its words with unit, code, and the shortest period."""

    words: str
    code: str
    unit: str
    shortest: float
    directions: tuple[Direction, ...] = DIRECTIONS


_ARGUMENTS = (
    *(_Argument(axis, f"path.nose_mm[:, {k}]", "mm", 1.0) for k, axis in enumerate(LINEAR_AXES)),
    # what goes on beside the machining moves all axes
    _Argument("time", "path.time_s", "s", 60.0, (*DIRECTIONS, ALL_AXES)),
    _Argument("cutting length", "path.cutting_length_mm", "mm", 2.0),
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
        along = np.concatenate(
            [np.asarray(eval(argument.code, {"np": np, "path": p})) for p in survey.paths]
        )
        span = float(np.ptp(along))
        if span < 2.0 * argument.shortest:
            continue
        for direction in argument.directions:
            weight = sensed[direction] / survey.u_mm[:, None]
            if np.abs(weight).max(initial=0.0) == 0.0:
                continue
            reading = (left_mm / survey.u_mm)[:, None] * weight
            for frequency in _peaks(along, reading, span, argument.shortest):
                yield _state(argument, frequency, span), direction


def _peaks(along: np.ndarray, reading: np.ndarray, span: float, shortest: float) -> list[float]:
    """Frequencies of the highest peaks of readings (n, D), none beside another."""
    cell = max(shortest / _CELLS, span * _FINER / _MOST)
    place = np.rint((along - along.min()) / cell).astype(int)
    count = next_fast_len(int(_FINER * (place.max() + 1)), real=True)
    rasters = [np.bincount(place, one) for one in reading.T]
    power = np.sum([np.abs(rfft(raster, count)) ** 2 for raster in rasters], axis=0)
    frequency = np.arange(len(power)) / (count * cell)
    power[(frequency < _LEAST_TURNS / span) | (frequency > 1.0 / (cell * _CELLS))] = 0.0
    found = []
    for _ in range(_PEAKS):
        best = int(np.argmax(power))
        if power[best] == 0.0:
            break
        found.append(_refined(along, reading, frequency[best], 1.0 / (_FINER * span)))
        power[max(best - _FINER, 0) : best + _FINER + 1] = 0.0
    return found


def _refined(along: np.ndarray, reading: np.ndarray, frequency: float, step: float) -> float:
    """The frequency of the peak itself, from the readings where they are: of a parabola.

    To a tenth of a step, so that what is found again is known.
    """
    wave, turn = (np.exp(2j * np.pi * one * along) for one in (frequency, step))
    waves = np.stack([wave * turn.conj(), wave, wave * turn])
    low, here, high = np.linalg.norm(waves @ reading, axis=1)
    bend = 2.0 * here - low - high
    aside = 0.5 * (high - low) / bend if bend > 0.0 else np.sign(high - low)
    return float(frequency + step * np.round(np.clip(aside, -1.0, 1.0), 1))


def _state(argument: _Argument, frequency: float, span: float) -> State:
    turn = f"{2.0 * np.pi * frequency!r} * {argument.code}"
    return State(
        f"wave in {argument.words}",
        f"a wave of {1.0 / frequency:.4g} {argument.unit} in {argument.words}",
        f"np.stack([np.sin({turn}), np.cos({turn})], axis=1)",
        looked_at=max(span / argument.shortest, 1.0),
    )
