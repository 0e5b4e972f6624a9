"""Free-form faces: polynomial and rational B-spline surfaces.

Source: ISO 10303-42; L. Piegl and W. Tiller, The NURBS Book (1997).
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from vmach.nominal.surfaces.bspline_kernel import (
    LARGEST_DEGREE,
    evaluate_surface,
    nearest_parameters,
)

__all__ = ["BSplineSurface"]

#: places of every knot span from which the nearest point is looked for: so many, or twice the
#: degree, as a span of degree 13 may hold a whole turn of a thread
_SEEDS_PER_SPAN = 6
#: slope along u or v, as a share of its largest on the surface, below which a place is a pole
_STILL = 1e-9


class BSplineSurface:
    """Tensor-product B-spline, after ISO 10303-42.

    Parameters
    ----------
    control_mm : (n, m, 3) array
        Control points, u first.
    weights : (n, m) array
        All ones for a polynomial surface.
    knots : pair of arrays
        Knots in u and v, repeated by their multiplicity.
    degrees : pair of int

    Raises
    ------
    ValueError
        A degree above `LARGEST_DEGREE`.
    """

    kind = label = "free-form"
    varies = ("uv", "uv")

    def __init__(
        self,
        control_mm: np.ndarray,
        weights: np.ndarray,
        knots: tuple[np.ndarray, np.ndarray],
        degrees: tuple[int, int],
    ) -> None:
        if max(degrees) > LARGEST_DEGREE:
            raise ValueError(f"degree {max(degrees)}")
        homogeneous = np.concatenate([control_mm * weights[..., None], weights[..., None]], axis=2)
        self._spline = *knots, (int(degrees[0]), int(degrees[1])), homogeneous
        self._low = np.array([t[k] for t, k in zip(knots, degrees, strict=True)])
        self._high = np.array([t[-k - 1] for t, k in zip(knots, degrees, strict=True)])
        grid = [self._seeds(t, axis, degrees[axis]) for axis, t in enumerate(knots)]
        self._seed_uv = np.stack(np.meshgrid(*grid, indexing="ij"), axis=-1).reshape(-1, 2)
        self._period = np.zeros(2)
        self._period = self._find_periods(grid, np.ptp(control_mm.reshape(-1, 3), axis=0).max())
        self._seed_uv = self._seed_uv[self._is_smooth(self._seed_uv)]
        self._tree = cKDTree(self.evaluate(self._seed_uv))

    @property
    def u_period(self) -> float:
        return float(self._period[0])

    @property
    def v_period(self) -> float:
        return float(self._period[1])

    @property
    def v_limits(self) -> tuple[float, float]:
        return float(self._low[1]), float(self._high[1])

    def _seeds(self, knots: np.ndarray, axis: int, degree: int) -> np.ndarray:
        spans = np.unique(np.clip(knots, self._low[axis], self._high[axis]))
        count = max(_SEEDS_PER_SPAN, 2 * degree) * (len(spans) - 1)
        where = np.linspace(0, len(spans) - 1, count + 1)
        return np.interp(where, np.arange(len(spans)), spans)

    def _is_smooth(self, uv: np.ndarray) -> np.ndarray:
        """Where a point moves along both u and v, (N,) bool; at a pole no search finds its way."""
        speed = np.linalg.norm(self.derivatives(uv), axis=2)
        smooth = (speed > _STILL * speed.max(axis=1, keepdims=True)).all(axis=0)
        return smooth if smooth.any() else np.ones(len(uv), dtype=bool)

    def _find_periods(self, grid: list[np.ndarray], size: float) -> np.ndarray:
        """A surface whose opposite ends coincide is closed in that direction."""
        period = np.zeros(2)
        for axis in range(2):
            ends = []
            for value in (self._low[axis], self._high[axis]):
                uv = np.empty((len(grid[1 - axis]), 2))
                uv[:, axis], uv[:, 1 - axis] = value, grid[1 - axis]
                ends.append(self.evaluate(uv))
            if np.abs(ends[0] - ends[1]).max() < 1e-7 * size:
                period[axis] = self._high[axis] - self._low[axis]
        return period

    def _inside(self, uv: np.ndarray) -> np.ndarray:
        wrapped = self._low + np.mod(uv - self._low, np.where(self._period, self._period, 1.0))
        return np.where(self._period, wrapped, np.clip(uv, self._low, self._high))

    def evaluate(self, uv: np.ndarray) -> np.ndarray:
        """Points at parameters (N, 2); (N, 3) mm."""
        return evaluate_surface(*self._spline, self._inside(uv))[:, 0]

    def derivatives(self, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """dS/du and dS/dv at parameters (N, 2); (N, 3) each."""
        found = evaluate_surface(*self._spline, self._inside(uv))
        return found[:, 1], found[:, 2]

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """Of the points nearest to (N, 3) mm, by Gauss-Newton steps from seeds; (N, 2)."""
        points = np.ascontiguousarray(points)
        start = self._seed_uv[self._tree.query(points)[1]]
        return nearest_parameters(*self._spline, start, points, self._period)
