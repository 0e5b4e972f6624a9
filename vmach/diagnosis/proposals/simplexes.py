"""Downhill simplexes of several problems, step by step together: their costs are asked at once.

Source: J. Nelder and R. Mead, Comput. J. 7 (1965) 308, with their coefficients.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

__all__ = ["lowest_near"]

#: costs of points (M, N), each of one of the problems, (M,) int
_Cost = Callable[[np.ndarray, np.ndarray], np.ndarray]
#: difference of the costs at the corners of a simplex that has arrived
_NEAR = 1e-4


def lowest_near(
    cost: _Cost, simplex: np.ndarray, count: int, *, near: float, most: int
) -> np.ndarray:
    """The points of lowest cost, (B, N), that B simplexes lead to.

    Parameters
    ----------
    cost : callable
    simplex : (N + 1, N) float64
        Where each starts.
    count : int
        B.
    near : float
        Extent of a simplex that has arrived.
    most : int
        Points that are tried for each problem.
    """
    corners = np.repeat(simplex[None], count, axis=0)
    every = np.repeat(np.arange(count), len(simplex))
    values = cost(corners.reshape(len(every), -1), every).reshape(count, -1)
    here = _Simplexes(cost, corners, values, np.full(count, most - len(simplex)))
    while True:
        here.sort()
        moving = np.flatnonzero(~here.have_arrived(near) & (here.left > 0))
        if not len(moving):
            return here.corners[:, 0]
        here.step(moving)


class _Simplexes:
    """Simplexes and the costs at their corners.

    Parameters
    ----------
    cost : callable
    corners : (B, N + 1, N) float64
    values : (B, N + 1) float64
    left : (B,) int
        How many more points may be tried.
    """

    def __init__(
        self, cost: _Cost, corners: np.ndarray, values: np.ndarray, left: np.ndarray
    ) -> None:
        self._cost, self.corners, self._values, self.left = cost, corners, values, left

    def sort(self) -> None:
        """The lowest corners first."""
        order = np.argsort(self._values, axis=1, kind="stable")
        self._values = np.take_along_axis(self._values, order, axis=1)
        self.corners = np.take_along_axis(self.corners, order[:, :, None], axis=1)

    def have_arrived(self, near: float) -> np.ndarray:
        """Whether each is small and its costs are alike, (B,)."""
        extent = np.abs(self.corners[:, 1:] - self.corners[:, :1]).max(axis=(1, 2))
        return (extent <= near) & (np.ptp(self._values, axis=1) <= _NEAR)

    def step(self, moving: np.ndarray) -> None:
        """Reflect, expand, contract or shrink those that move, (M,) int."""
        values, worst = self._values[moving], self.corners[moving, -1]
        middle = self.corners[moving, :-1].sum(axis=1) / worst.shape[1]
        first = 2.0 * middle - worst
        at_first = self._tried(first, moving)
        is_lowest, is_low = at_first < values[:, 0], at_first < values[:, -2]
        is_outside = at_first < values[:, -1]
        far = np.select([is_lowest, is_outside], [3.0, 1.5], 0.5)[:, None]
        second = far * middle + (1.0 - far) * worst
        # a simplex that may try no more points stays
        more = np.flatnonzero((is_lowest | ~is_low) & (self.left[moving] > 0))
        at_second = np.full(len(moving), np.inf)
        at_second[more] = self._tried(second[more], moving[more])
        is_better = np.where(is_outside, at_second <= at_first, at_second < values[:, -1])
        takes_second = np.where(is_lowest, at_second < at_first, is_better)
        takes_first = is_low & ~takes_second & (~is_lowest | np.isfinite(at_second))
        for takes, points, found in (
            (takes_first, first, at_first),
            (takes_second, second, at_second),
        ):
            self.corners[moving[takes], -1] = points[takes]
            self._values[moving[takes], -1] = found[takes]
        self._shrink(moving[np.isfinite(at_second) & ~takes_first & ~takes_second])

    def _shrink(self, some: np.ndarray) -> None:
        """All corners of some of them towards the lowest, as far as points may be tried."""
        each, corner = np.nonzero(self.left[some, None] > np.arange(self.corners.shape[2]))
        which, corner = some[each], corner + 1
        lowest = self.corners[which, 0]
        points = lowest + 0.5 * (self.corners[which, corner] - lowest)
        self.corners[which, corner] = points
        self._values[which, corner] = self._tried(points, which)

    def _tried(self, points: np.ndarray, which: np.ndarray) -> np.ndarray:
        """Costs at points (M, N) of some of the problems, (M,)."""
        np.subtract.at(self.left, which, 1)
        return self._cost(points, which)
