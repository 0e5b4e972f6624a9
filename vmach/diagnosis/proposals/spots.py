"""Bumps whose place nobody knows: on the part, or in the machine's volume."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import minimize

from vmach.diagnosis.proposals.matched import matched_power, peaks
from vmach.diagnosis.proposals.states import Direction, State
from vmach.fit.survey import Survey

__all__ = ["Spots"]

#: standard deviations of a bump, mm; a factor of two apart, the best is never far
_WIDTHS_MM = (25.0, 50.0, 100.0)
#: places of a bump in its standard deviation
_FINER = 2
#: trials at most of the finest raster, which with its readings takes up 64 MB
_MOST_TRIALS = 4000
#: peaks of each direction that are put on the list
_PEAKS = 2
#: places at most that are tried between those of the raster
_EVALUATED = 80
#: readings at most that places are looked for on
_LOOKED_THROUGH = 1000
#: trials that are worked out together
_AT_ONCE = 200
#: where a reading is, by whether the direction is that of a surface
_FRAMES = {True: "path.on_part_mm", False: "path.nose_mm"}


class Spots:
    """Trial bumps over X and Y of the readings of a survey.

    Parameters
    ----------
    survey : Survey
    sensed : mapping of Direction to (n, D) float64
        How readings sense a unit displacement.
    """

    def __init__(self, survey: Survey, sensed: Mapping[Direction, np.ndarray]) -> None:
        self._rows = slice(None, None, max(1, -(-len(survey) // _LOOKED_THROUGH)))
        self._unit = survey.u_mm[self._rows]
        frames = _FRAMES.values()
        places = {f: [eval(f, {"path": path})[:, :2] for path in survey.paths] for f in frames}
        trials = {f: _Trials.over(np.concatenate(own)[self._rows]) for f, own in places.items()}
        self._filters = {
            direction: _Filter(trials[_FRAMES[direction.needs_surface]], self._scaled(columns))
            for direction, columns in sensed.items()
            if not direction.lever
        }

    def _scaled(self, columns: np.ndarray) -> np.ndarray:
        """Columns (n, D) in unit noise, of the readings that are looked through."""
        return columns[self._rows] / self._unit[:, None]

    def states(self, left_mm: np.ndarray) -> Iterator[tuple[State, Direction]]:
        """The most conspicuous bumps, with the direction they show in.

        Parameters
        ----------
        left_mm : (n,) float64
            What is not explained.
        """
        reading = left_mm[self._rows] / self._unit
        for direction, own in self._filters.items():
            trials = own.trials
            found = own.power(reading)
            for k in peaks(found, trials.height, _PEAKS, length=trials.length):
                near = trials.centres_mm[k], trials.widths_mm[k]
                centre, width = own.best_near(reading, *near)
                looked_at = len(trials.widths_mm) / _FINER**2
                yield _state(_FRAMES[direction.needs_surface], centre, width, looked_at), direction


@dataclass(frozen=True)
class _Trials:
    """Bumps over the places (n, 2) mm of readings.

    Attributes
    ----------
    place_mm : (n, 2) float64
    centres_mm, widths_mm : (T, 2), (T,) float64
    height : (T, n) float64
        At the readings.
    """

    place_mm: np.ndarray
    centres_mm: np.ndarray
    widths_mm: np.ndarray
    height: np.ndarray

    @cached_property
    def length(self) -> np.ndarray:
        """Root of the sum of the squares of each, (T,)."""
        return np.linalg.norm(self.height, axis=1)

    def height_of(self, centre_mm: np.ndarray, width_mm: float) -> np.ndarray:
        """Of another bump at the readings, (n,)."""
        x, y = self._across - centre_mm[:, None]
        return np.exp((x * x + y * y) / (-2.0 * width_mm**2))

    @cached_property
    def _across(self) -> np.ndarray:
        """The places, each coordinate together, (2, n) mm."""
        return np.ascontiguousarray(self.place_mm.T)

    @classmethod
    def over(cls, place_mm: np.ndarray) -> _Trials:
        """On a raster over all places, in every width; wider bumps over a very large part."""
        low, high = place_mm.min(axis=0), place_mm.max(axis=0)
        finest = float(np.prod((high - low) * _FINER / _WIDTHS_MM[0] + 2.0))
        wider = max(1.0, np.sqrt(finest / _MOST_TRIALS))
        centres, widths, heights = [], [], []
        for width in wider * np.array(_WIDTHS_MM):
            counts = np.ceil((high - low) * _FINER / width).astype(int) + 1
            x, y = (np.linspace(a, b, n) for a, b, n in zip(low, high, counts, strict=True))
            along = [
                np.exp(-0.5 * ((place_mm[:, k] - line[:, None]) / width) ** 2)
                for k, line in enumerate((x, y))
            ]
            centres.append(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2))
            widths.append(np.full(len(x) * len(y), width))
            heights.append((along[0][:, None] * along[1]).reshape(-1, len(place_mm)))
        return cls(place_mm, np.vstack(centres), np.concatenate(widths), np.vstack(heights))


@dataclass(frozen=True)
class _Filter:
    """What bumps take off the sum of squares of readings in unit noise.

    Attributes
    ----------
    trials : _Trials
    sensed : (n, D) float64
        How the readings sense a unit displacement.
    """

    trials: _Trials
    sensed: np.ndarray

    @cached_property
    def _products(self) -> np.ndarray:
        """Of what is sensed with each other, (n, D D)."""
        products = self.sensed[:, :, None] * self.sensed[:, None, :]
        return products.reshape(len(products), -1)

    @cached_property
    def _gram(self) -> np.ndarray:
        """Of the trials, (T, D, D)."""
        height = self.trials.height
        some = [height[k : k + _AT_ONCE] for k in range(0, len(height), _AT_ONCE)]
        return np.concatenate([self._gram_of(own) for own in some])

    def _gram_of(self, height: np.ndarray) -> np.ndarray:
        """Of bumps whose heights at the readings are (T, n), (T, D, D)."""
        wide = self.sensed.shape[1]
        return (height**2 @ self._products).reshape(-1, wide, wide)

    def power(self, reading: np.ndarray) -> np.ndarray:
        """Of all trials, (T,), for readings (n,)."""
        return matched_power(self.trials.height @ self._seen(reading), self._gram)

    def _seen(self, reading: np.ndarray) -> np.ndarray:
        """Products of every sensed displacement with readings (n,), (n, D)."""
        return self.sensed * reading[:, None]

    def best_near(
        self, reading: np.ndarray, centre: np.ndarray, width: float
    ) -> tuple[np.ndarray, float]:
        """Centre and standard deviation of the most power near some on the raster, mm."""
        seen = self._seen(reading)

        def at(step: np.ndarray) -> tuple[np.ndarray, float]:
            return centre + width * step[:2], width * 2.0 ** float(np.clip(step[2], -1.0, 1.0))

        def cost(step: np.ndarray) -> float:
            height = self.trials.height_of(*at(step))[None]
            return -float(matched_power(height @ seen, self._gram_of(height))[0])

        simplex = np.vstack([np.zeros(3), 0.5 * np.eye(3)])
        options = {"maxfev": _EVALUATED, "initial_simplex": simplex, "xatol": 0.02}
        return at(minimize(cost, np.zeros(3), method="Nelder-Mead", options=options).x)


def _state(frame: str, centre: np.ndarray, width: float, looked_at: float) -> State:
    x, y = centre.tolist()
    away = f"np.hypot({frame}[:, 0] - {x:.1f}, {frame}[:, 1] - {y:.1f})"
    whose = "of the part" if frame == _FRAMES[True] else "of the machine"
    return State(
        "spot",
        f"a spot {2 * width:.0f} mm wide at {x:.0f} mm in X, {y:.0f} mm in Y {whose}",
        f"np.exp(-0.5 * ({away} / {width:g}) ** 2)",
        looked_at=max(looked_at, 1.0),
    )
