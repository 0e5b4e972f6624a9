"""Bumps whose place nobody knows: on the part, or in the machine's volume."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vmach.diagnosis.proposals.matched import matched_power, peaks
from vmach.diagnosis.proposals.simplexes import lowest_near
from vmach.diagnosis.proposals.states import Direction, State
from vmach.fit.survey import Survey

__all__ = ["Spots"]

#: standard deviations of a bump, mm; a factor of two apart, the best is never far
_WIDTHS_MM = (25.0, 50.0, 100.0)
#: places of a bump in its standard deviation
_FINER = 2
#: trials at most of the finest raster
_MOST_TRIALS = 4000
#: peaks of each direction that are put on the list
_PEAKS = 2
#: places at most that are tried between those of the raster
_EVALUATED = 80
#: readings at most that places are looked for on
_LOOKED_THROUGH = 1000
#: extent of a simplex that has arrived, in standard deviations of the bump
_NEAR = 0.02
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
        near = [
            (direction, _Bump(own, own.trials.centres_mm[k], float(own.trials.widths_mm[k])))
            for direction, own in self._filters.items()
            for k in peaks(own.power(reading), own.trials.cosines, _PEAKS)
        ]
        places: dict[int, tuple[np.ndarray, float]] = {}
        for wide in {bump.filter.sensed.shape[1] for _, bump in near}:
            alike = [k for k, (_, bump) in enumerate(near) if bump.filter.sensed.shape[1] == wide]
            found = _best_near([near[k][1] for k in alike], reading)
            places |= dict(zip(alike, found, strict=True))
        for k, (direction, bump) in enumerate(near):
            looked_at = len(bump.filter.trials.widths_mm) / _FINER**2
            yield _state(_FRAMES[direction.needs_surface], *places[k], looked_at), direction


@dataclass(frozen=True)
class _Trials:
    """Bumps over the places (n, 2) mm of readings, on a raster of each width.

    Attributes
    ----------
    place_mm : (n, 2) float64
    centres_mm, widths_mm : (T, 2), (T,) float64
    along : list of ((I, n) float64, (J, n) float64)
        Of each width, heights at the readings along X and Y, whose products are the bumps'.
    """

    place_mm: np.ndarray
    centres_mm: np.ndarray
    widths_mm: np.ndarray
    along: list[tuple[np.ndarray, np.ndarray]]

    def sums(self, values: np.ndarray) -> np.ndarray:
        """Products of the heights of each with values (n,), (T,)."""
        return np.concatenate([((x * values) @ y.T).ravel() for x, y in self.along])

    def sums_of_squares(self, values: np.ndarray) -> np.ndarray:
        """The same of the squares of the heights, (T,)."""
        return np.concatenate([((x * x * values) @ (y * y).T).ravel() for x, y in self.along])

    @cached_property
    def _length(self) -> np.ndarray:
        """Root of the sum of the squares of each, (T,)."""
        return np.sqrt(self.sums_of_squares(np.ones(len(self.place_mm))))

    def cosines(self, k: int) -> np.ndarray:
        """Of the heights of one of them with those of all, (T,)."""
        own = _heights(self.place_mm.T[None], self.centres_mm[[k]], self.widths_mm[[k]])[0]
        return self.sums(own) / np.maximum(self._length * self._length[k], 1e-300)

    @classmethod
    def over(cls, place_mm: np.ndarray) -> _Trials:
        """On a raster over all places, in every width; wider bumps over a very large part."""
        low, high = place_mm.min(axis=0), place_mm.max(axis=0)
        finest = float(np.prod((high - low) * _FINER / _WIDTHS_MM[0] + 2.0))
        wider = max(1.0, np.sqrt(finest / _MOST_TRIALS))
        centres, widths, along = [], [], []
        for width in wider * np.array(_WIDTHS_MM):
            counts = np.ceil((high - low) * _FINER / width).astype(int) + 1
            x, y = (np.linspace(a, b, n) for a, b, n in zip(low, high, counts, strict=True))
            across = ((place_mm[:, k] - line[:, None]) / width for k, line in enumerate((x, y)))
            along_x, along_y = (np.exp(-0.5 * away**2) for away in across)
            centres.append(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2))
            widths.append(np.full(len(x) * len(y), width))
            along.append((along_x, along_y))
        return cls(place_mm, np.vstack(centres), np.concatenate(widths), along)


def _heights(across_mm: np.ndarray, centres_mm: np.ndarray, widths_mm: np.ndarray) -> np.ndarray:
    """Of M bumps at readings whose X and Y are (M, 2, n) mm, (M, n)."""
    away = across_mm - centres_mm[:, :, None]
    away *= away
    squared = away[:, 0] + away[:, 1]
    squared /= -2.0 * widths_mm[:, None] ** 2
    return np.exp(squared, out=squared)


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
    def products(self) -> np.ndarray:
        """Of what is sensed with each other, (n, D D)."""
        products = self.sensed[:, :, None] * self.sensed[:, None, :]
        return products.reshape(len(products), -1)

    @cached_property
    def _gram(self) -> np.ndarray:
        """Of the trials, (T, D, D)."""
        gram = [self.trials.sums_of_squares(own) for own in self.products.T]
        return np.stack(gram, axis=1).reshape(-1, *(self.sensed.shape[1],) * 2)

    def power(self, reading: np.ndarray) -> np.ndarray:
        """Of all trials, (T,), for readings (n,)."""
        seen = [self.trials.sums(own * reading) for own in self.sensed.T]
        return matched_power(np.stack(seen, axis=1), self._gram)


@dataclass(frozen=True)
class _Bump:
    """A bump of much power on the raster.

    Attributes
    ----------
    filter : _Filter
    centre_mm : (2,) float64
    width_mm : float
    """

    filter: _Filter
    centre_mm: np.ndarray
    width_mm: float


def _best_near(bumps: Sequence[_Bump], reading: np.ndarray) -> list[tuple[np.ndarray, float]]:
    """Centres and standard deviations of the most power near bumps on the raster, mm.

    Parameters
    ----------
    bumps : sequence of _Bump
        In equally many directions each.
    reading : (n,) float64
    """
    centres, widths = (np.array([getattr(b, n) for b in bumps]) for n in ("centre_mm", "width_mm"))
    across = np.stack([bump.filter.trials.place_mm.T for bump in bumps])
    seen = np.stack([bump.filter.sensed.T * reading for bump in bumps])
    products = np.stack([bump.filter.products.T for bump in bumps])

    def at(step: np.ndarray, which: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        wide = widths[which] * 2.0 ** np.clip(step[:, 2], -1.0, 1.0)
        return centres[which] + widths[which, None] * step[:, :2], wide

    def cost(step: np.ndarray, which: np.ndarray) -> np.ndarray:
        height = _heights(across[which], *at(step, which))[:, :, None]
        gram = (products[which] @ height**2).reshape(len(step), *(seen.shape[1],) * 2)
        return -matched_power((seen[which] @ height)[:, :, 0], gram)

    simplex = np.vstack([np.zeros(3), 0.5 * np.eye(3)])
    step = lowest_near(cost, simplex, len(bumps), near=_NEAR, most=_EVALUATED)
    best, wide = at(step, np.arange(len(bumps)))
    return list(zip(best, wide.tolist(), strict=True))


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
