"""What associations other than least squares make small or large, one linear step at a time.

Source: ISO 17450-3 and ISO 14405-1; linear programs over the distances as they change to first
order.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from vmach.features.association.linear_program import solve
from vmach.features.surface import Surface

__all__ = ["PROBLEMS"]


class Seen(Protocol):
    """The surface that points are looked at from."""

    surface: Surface


class Zone:
    """The least width between two surfaces parallel to the one looked for."""

    @staticmethod
    def value(state: Seen, distance: np.ndarray) -> float:
        """What is made least, of signed distances (N,) mm from the surface."""
        return float(np.abs(distance).max())

    @staticmethod
    def step(state: Seen, distance: np.ndarray, rows: np.ndarray, trust: float):
        """The best step within `trust` for slopes `rows` (N, q): step (q,), weights (N,), value."""
        count = rows.shape[1]
        ones = np.ones((len(rows), 1))
        both = np.vstack([np.hstack([rows, ones]), np.hstack([-rows, ones])])
        cost = np.r_[np.zeros(count), 1.0]
        found = solve(cost, both, np.r_[distance, -distance], np.r_[np.full(count, trust), np.inf])
        above, below = np.split(found.weight, 2)
        return found.x[:count], above - below, float(found.x[count])

    @staticmethod
    def level(state: Seen, weight: np.ndarray) -> np.ndarray:
        """Which side decides, of points with weights (N,): -1, 0 or 1 each."""
        return np.sign(weight)

    @staticmethod
    def reported(value: float) -> float:
        """The figure of the drawing."""
        return 2.0 * value

    @staticmethod
    def reported_weight(weight: np.ndarray) -> np.ndarray:
        """Its weights (N,) on the points."""
        return 2.0 * weight


class Tangent(Zone):
    """All points on the material's side, the farthest as near as can be."""

    @staticmethod
    def value(state: Seen, distance: np.ndarray) -> float:
        return float(-distance.min()) + 1e6 * max(float(distance.max()), 0.0)

    @staticmethod
    def step(state: Seen, distance: np.ndarray, rows: np.ndarray, trust: float):
        count = rows.shape[1]
        ones, zeros = np.ones((len(rows), 1)), np.zeros((len(rows), 1))
        both = np.vstack([np.hstack([rows, zeros]), np.hstack([-rows, ones])])
        cost = np.r_[np.zeros(count), 1.0]
        found = solve(cost, both, np.r_[distance, -distance], np.r_[np.full(count, trust), np.inf])
        above, below = np.split(found.weight, 2)
        return found.x[:count], above - below, float(found.x[count])

    @staticmethod
    def level(state: Seen, weight: np.ndarray) -> np.ndarray:
        return np.minimum(np.sign(weight), 0.0)

    @staticmethod
    def reported(value: float) -> float:
        return value

    @staticmethod
    def reported_weight(weight: np.ndarray) -> np.ndarray:
        return weight


class Round:
    """The largest or the smallest radius about an axis that is looked for."""

    def __init__(self, side: float) -> None:
        self.side = side  # +1: circumscribed, the least largest radius

    def radius(self, state: Seen, distance: np.ndarray) -> np.ndarray:
        """Radii of points at distances (N,) mm from the surface."""
        return state.surface.sign * distance + state.surface.radius_mm

    def value(self, state: Seen, distance: np.ndarray) -> float:
        return float((self.side * self.radius(state, distance)).max())

    def step(self, state: Seen, distance: np.ndarray, rows: np.ndarray, trust: float):
        count = rows.shape[1]
        radius, outward = self.side * self.radius(state, distance), self.side * state.surface.sign
        table = np.hstack([outward * rows, np.ones((len(rows), 1))])
        cost = np.r_[np.zeros(count), 1.0]
        middle = float(radius.mean())
        found = solve(cost, table, radius - middle, np.r_[np.full(count, trust), np.inf])
        return found.x[:count], found.weight * outward, float(found.x[count]) + middle

    def level(self, state: Seen, weight: np.ndarray) -> np.ndarray:
        return np.ones_like(weight)

    def reported(self, value: float) -> float:
        return self.side * value

    def reported_weight(self, weight: np.ndarray) -> np.ndarray:
        return self.side * weight


PROBLEMS = {
    "minimum zone": Zone,
    "tangent": Tangent,
    "inscribed": Round(-1.0),
    "circumscribed": Round(1.0),
}
