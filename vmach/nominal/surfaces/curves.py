"""The curves that edges of faces lie on, after ISO 10303-42.

All evaluate with t of shape (N,) to points (N, 3) mm. `parameter` is the inverse for points on
the curve (elsewhere: of the nearest point). `period` is 0 for curves that do not close.

Source: ISO 10303-42.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from vmach.nominal.frame import Frame
from vmach.nominal.surfaces.bspline_kernel import evaluate_curve, nearest_on_curve

__all__ = ["BSplineCurve", "Curve", "Ellipse", "Hyperbola", "Line", "Parabola", "polyline"]


#: parameters nearer than this, relative to the curve's range, differ by rounding
_SAME = 1e-12


class Curve(Protocol):
    """What every curve can do."""

    period: float

    def evaluate(self, t: np.ndarray) -> np.ndarray:
        """Points, (N, 3) mm."""
        ...

    def derivative(self, t: np.ndarray) -> np.ndarray:
        """dC/dt, (N, 3)."""
        ...

    def parameter(self, points: np.ndarray) -> np.ndarray:
        """Parameters of points on the curve, (N,)."""
        ...

    def breaks(self, start: float, end: float) -> np.ndarray:
        """Parameters from start to end between which it is smooth and turns little; (B,)."""
        ...


@dataclass(frozen=True)
class Line:
    """origin + t direction, the direction being a unit vector."""

    origin: np.ndarray
    direction: np.ndarray
    period = 0.0

    def evaluate(self, t: np.ndarray) -> np.ndarray:
        """Points at parameters (N,); (N, 3) mm."""
        return self.origin + t[:, None] * self.direction

    def derivative(self, t: np.ndarray) -> np.ndarray:
        """dC/dt at parameters (N,); (N, 3)."""
        return np.broadcast_to(self.direction, (len(t), 3))

    def parameter(self, points: np.ndarray) -> np.ndarray:
        """Parameters of points (N, 3) mm on the curve; (N,)."""
        return (points - self.origin) @ self.direction

    def breaks(self, start: float, end: float) -> np.ndarray:
        """Parameters from start to end between which it is smooth and turns little; (B,)."""
        return np.array([start, end])


@dataclass(frozen=True)
class Ellipse:
    """a cos t x + b sin t y; a circle where a = b."""

    frame: Frame
    a: float
    b: float
    period = 2.0 * np.pi

    def evaluate(self, t: np.ndarray) -> np.ndarray:
        """Points at parameters (N,); (N, 3) mm."""
        x, y = self.a * np.cos(t), self.b * np.sin(t)
        return self.frame.world(np.column_stack([x, y, np.zeros_like(t)]))

    def derivative(self, t: np.ndarray) -> np.ndarray:
        """dC/dt at parameters (N,); (N, 3)."""
        x, y = -self.a * np.sin(t), self.b * np.cos(t)
        return self.frame.direction(np.column_stack([x, y, np.zeros_like(t)]))

    def parameter(self, points: np.ndarray) -> np.ndarray:
        """Parameters of points (N, 3) mm on the curve; (N,)."""
        local = self.frame.local(points)
        return np.arctan2(local[:, 1] / self.b, local[:, 0] / self.a)

    def breaks(self, start: float, end: float) -> np.ndarray:
        """Parameters from start to end between which it is smooth and turns little; (B,)."""
        return np.linspace(start, end, int(np.ceil(abs(end - start) / np.radians(15.0))) + 1)


@dataclass(frozen=True)
class Hyperbola:
    """a cosh t x + b sinh t y: a cone cut along its axis."""

    frame: Frame
    a: float
    b: float
    period = 0.0

    def evaluate(self, t: np.ndarray) -> np.ndarray:
        """Points at parameters (N,); (N, 3) mm."""
        x, y = self.a * np.cosh(t), self.b * np.sinh(t)
        return self.frame.world(np.column_stack([x, y, np.zeros_like(t)]))

    def derivative(self, t: np.ndarray) -> np.ndarray:
        """dC/dt at parameters (N,); (N, 3)."""
        x, y = self.a * np.sinh(t), self.b * np.cosh(t)
        return self.frame.direction(np.column_stack([x, y, np.zeros_like(t)]))

    def parameter(self, points: np.ndarray) -> np.ndarray:
        """Parameters of points (N, 3) mm on the curve; (N,)."""
        return np.arcsinh(self.frame.local(points)[:, 1] / self.b)

    def breaks(self, start: float, end: float) -> np.ndarray:
        """Parameters from start to end between which it is smooth and turns little; (B,)."""
        return np.linspace(start, end, 9)


@dataclass(frozen=True)
class Parabola:
    """f t^2 x + 2 f t y: a cone cut parallel to its flank."""

    frame: Frame
    focal: float
    period = 0.0

    def evaluate(self, t: np.ndarray) -> np.ndarray:
        """Points at parameters (N,); (N, 3) mm."""
        x, y = self.focal * t**2, 2.0 * self.focal * t
        return self.frame.world(np.column_stack([x, y, np.zeros_like(t)]))

    def derivative(self, t: np.ndarray) -> np.ndarray:
        """dC/dt at parameters (N,); (N, 3)."""
        x, y = 2.0 * self.focal * t, np.full_like(t, 2.0 * self.focal)
        return self.frame.direction(np.column_stack([x, y, np.zeros_like(t)]))

    def parameter(self, points: np.ndarray) -> np.ndarray:
        """Parameters of points (N, 3) mm on the curve; (N,)."""
        return self.frame.local(points)[:, 1] / (2.0 * self.focal)

    def breaks(self, start: float, end: float) -> np.ndarray:
        """Parameters from start to end between which it is smooth and turns little; (B,)."""
        return np.linspace(start, end, 9)


class BSplineCurve:
    """Polynomial or rational B-spline.

    Parameters
    ----------
    control_mm : (n, 3) array
        Control points.
    weights : (n,) array
        All ones for a polynomial spline.
    knots : (n + degree + 1,) array
        Knots, repeated by their multiplicity.
    degree : int

    Raises
    ------
    ValueError
        An inner knot is there more than `degree` times: the curve jumps.
    """

    def __init__(
        self, control_mm: np.ndarray, weights: np.ndarray, knots: np.ndarray, degree: int
    ) -> None:
        jumps = knots[1 : -degree - 1][knots[degree + 1 : -1] <= knots[1 : -degree - 1]]
        if len(jumps):
            raise ValueError(f"it jumps at {jumps[0]:g}")
        homogeneous = np.column_stack([control_mm * weights[:, None], weights])
        self._spline = np.ascontiguousarray(knots, dtype=np.float64), int(degree), homogeneous
        self.domain = float(knots[degree]), float(knots[-degree - 1])
        inner = np.unique(knots)
        self._knots = inner[(inner >= self.domain[0]) & (inner <= self.domain[1])]
        self._pieces = 2 * degree
        ends = self._at(np.array(self.domain))[:, 0]
        size = np.ptp(control_mm, axis=0).max()
        closed = np.linalg.norm(ends[1] - ends[0]) < 1e-7 * size
        self.period = self.domain[1] - self.domain[0] if closed else 0.0
        # densely enough for the nearest of these to lead to the nearest of all
        places = self.breaks(*self.domain)
        count = np.arange(len(places))
        seeds = np.interp(np.linspace(0, len(places) - 1, 4 * len(places)), count, places)
        self._seeds = seeds, np.ascontiguousarray(self._at(seeds)[:, 0])

    def _at(self, t: np.ndarray) -> np.ndarray:
        return evaluate_curve(*self._spline, t)

    def _wrapped(self, t: np.ndarray) -> np.ndarray:
        low, high = self.domain
        return low + np.mod(t - low, self.period) if self.period else np.clip(t, low, high)

    def evaluate(self, t: np.ndarray) -> np.ndarray:
        """Points at parameters (N,); (N, 3) mm."""
        return self._at(self._wrapped(t))[:, 0]

    def derivative(self, t: np.ndarray) -> np.ndarray:
        """dC/dt at parameters (N,); (N, 3)."""
        return self._at(self._wrapped(t))[:, 1]

    def parameter(self, points: np.ndarray) -> np.ndarray:
        """Parameters of points (N, 3) mm on the curve; (N,)."""
        points = np.ascontiguousarray(points)
        return nearest_on_curve(*self._spline, *self._seeds, points, self.period)

    def breaks(self, start: float, end: float) -> np.ndarray:
        """Parameters from start to end between which it is smooth and turns little; (B,)."""
        low, high = min(start, end), max(start, end)
        knots = self._knots
        if self.period:
            knots = np.concatenate([knots + turn * self.period for turn in (-1, 0, 1)])
        rounding = _SAME * (self.domain[1] - self.domain[0])
        inner = knots[(knots > low + rounding) & (knots < high - rounding)]
        ends = np.concatenate([[low] if low < high else [], inner, [high]])
        share = np.arange(self._pieces) / self._pieces
        within = ends[:-1, None] + (ends[1:] - ends[:-1])[:, None] * share
        t = np.append(within, high)
        return t if end >= start else t[::-1]


def polyline(
    curve: Curve, start: float, end: float, tolerance_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """Parameters (N,) and points (N, 3) mm whose chords leave the curve by the tolerance."""
    t = curve.breaks(start, end)
    points = curve.evaluate(t)
    for _ in range(0 if isinstance(curve, Line) else 20):
        middle = (t[:-1] + t[1:]) / 2.0
        between = curve.evaluate(middle)
        off = np.linalg.norm(between - (points[:-1] + points[1:]) / 2.0, axis=1)
        split = np.flatnonzero(off > tolerance_mm)
        if not len(split):
            break
        t = np.insert(t, split + 1, middle[split])
        points = np.insert(points, split + 1, between[split], axis=0)
    return t, points
