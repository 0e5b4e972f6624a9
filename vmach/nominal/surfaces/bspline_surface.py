"""Free-form faces: polynomial and rational B-spline surfaces."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import NdBSpline
from scipy.spatial import cKDTree

__all__ = ["BSplineSurface"]

#: places of every knot span from which the nearest point is looked for
_SEEDS_PER_SPAN = 6


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
    """

    kind = label = "free-form"

    def __init__(
        self,
        control_mm: np.ndarray,
        weights: np.ndarray,
        knots: tuple[np.ndarray, np.ndarray],
        degrees: tuple[int, int],
    ) -> None:
        homogeneous = np.concatenate([control_mm * weights[..., None], weights[..., None]], axis=2)
        self._spline = NdBSpline(knots, homogeneous, degrees)
        self._low = np.array([t[k] for t, k in zip(knots, degrees, strict=True)])
        self._high = np.array([t[-k - 1] for t, k in zip(knots, degrees, strict=True)])
        grid = [self._seeds(t, axis) for axis, t in enumerate(knots)]
        self._seed_uv = np.stack(np.meshgrid(*grid, indexing="ij"), axis=-1).reshape(-1, 2)
        self._period = np.zeros(2)
        self._period = self._find_periods(grid, np.ptp(control_mm.reshape(-1, 3), axis=0).max())
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

    def _seeds(self, knots: np.ndarray, axis: int) -> np.ndarray:
        spans = np.unique(np.clip(knots, self._low[axis], self._high[axis]))
        where = np.linspace(0, len(spans) - 1, _SEEDS_PER_SPAN * (len(spans) - 1) + 1)
        return np.interp(where, np.arange(len(spans)), spans)

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
        value = self._spline(self._inside(uv))
        return value[:, :3] / value[:, 3:]

    def derivatives(self, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        uv = self._inside(uv)
        value = self._spline(uv)
        point = value[:, :3] / value[:, 3:]
        slopes = (self._spline(uv, nu=nu) for nu in ((1, 0), (0, 1)))
        return tuple((slope[:, :3] - slope[:, 3:] * point) / value[:, 3:] for slope in slopes)

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """Of the nearest point, by Gauss-Newton steps from the nearest of a grid of seeds."""
        uv = self._seed_uv[self._tree.query(points)[1]]
        for _ in range(30):
            along_u, along_v = self.derivatives(uv)
            gap = points - self.evaluate(uv)
            jacobian = np.stack([along_u, along_v], axis=2)
            square = np.swapaxes(jacobian, 1, 2) @ jacobian
            # a touch of damping keeps the step finite at poles
            damping = 1e-14 * np.trace(square, axis1=1, axis2=2)[:, None, None] + 1e-300
            step = np.linalg.solve(
                square + damping * np.eye(2), np.swapaxes(jacobian, 1, 2) @ gap[:, :, None]
            )[:, :, 0]
            uv = self._inside(uv + step)
            if np.abs(step).max(initial=0.0) < 1e-14 * (self._high - self._low).max():
                break
        return uv
