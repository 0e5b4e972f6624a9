"""Bumps whose place nobody knows: on the part, or in the machine's volume."""

from __future__ import annotations

from collections.abc import Iterator
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
    """

    def __init__(self, survey: Survey) -> None:
        self._survey = survey
        self._rows = slice(None, None, max(1, len(survey) // _LOOKED_THROUGH))
        self._trials = {is_surface: self._of(frame) for is_surface, frame in _FRAMES.items()}

    def _of(self, frame: str) -> _Trials:
        places = [eval(frame, {"path": path})[:, :2] for path in self._survey.paths]
        return _Trials.over(np.concatenate(places)[self._rows])

    def states(
        self, left_mm: np.ndarray, sensed: dict[Direction, np.ndarray]
    ) -> Iterator[tuple[State, Direction]]:
        """The most conspicuous bumps, with the direction they show in.

        Parameters
        ----------
        left_mm : (n,) float64
            What is not explained.
        sensed : mapping of Direction to (n, D) float64
            How readings sense a unit displacement.
        """
        unit = self._survey.u_mm[self._rows]
        reading = left_mm[self._rows] / unit
        for direction, columns in sensed.items():
            if direction.lever:
                continue
            trials = self._trials[direction.needs_surface]
            power = _Power(trials.place_mm, columns[self._rows] / unit[:, None], reading)
            found = power.of(trials.height)
            for k in peaks(found, trials.height, _PEAKS, length=trials.length):
                centre, width = power.best_near(trials.centres_mm[k], trials.widths_mm[k])
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
class _Power:
    """What bumps take off the sum of squares of readings (n,) in unit noise.

    Attributes
    ----------
    place_mm : (n, 2) float64
    sensed : (n, D) float64
        How they sense a unit displacement.
    reading : (n,) float64
    """

    place_mm: np.ndarray
    sensed: np.ndarray
    reading: np.ndarray

    @cached_property
    def _across(self) -> np.ndarray:
        """The places, each coordinate together, (2, n) mm."""
        return np.ascontiguousarray(self.place_mm.T)

    @cached_property
    def _seen(self) -> np.ndarray:
        """Products of every sensed displacement with the readings, (n, D)."""
        return self.sensed * self.reading[:, None]

    @cached_property
    def _products(self) -> np.ndarray:
        """With each other, (n, D D)."""
        products = self.sensed[:, :, None] * self.sensed[:, None, :]
        return products.reshape(len(products), -1)

    def of(self, value: np.ndarray) -> np.ndarray:
        """Of trials whose heights at the readings are (T, n)."""
        wide = self.sensed.shape[1]
        some = (value[k : k + _AT_ONCE] for k in range(0, len(value), _AT_ONCE))
        gram = np.concatenate([own**2 @ self._products for own in some])
        return matched_power(value @ self._seen, gram.reshape(-1, wide, wide))

    def best_near(self, centre: np.ndarray, width: float) -> tuple[np.ndarray, float]:
        """Centre and standard deviation of the most power near some on the raster, mm."""

        def cost(step: np.ndarray) -> float:
            own = width * 2.0 ** float(np.clip(step[2], -1.0, 1.0))
            x, y = self._across - (centre + width * step[:2])[:, None]
            away = x * x + y * y
            return -float(self.of(np.exp(-0.5 * away / own**2)[None])[0])

        simplex = np.vstack([np.zeros(3), 0.5 * np.eye(3)])
        options = {"maxfev": _EVALUATED, "initial_simplex": simplex, "xatol": 0.02}
        step = minimize(cost, np.zeros(3), method="Nelder-Mead", options=options).x
        return centre + width * step[:2], width * 2.0 ** float(np.clip(step[2], -1.0, 1.0))


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
