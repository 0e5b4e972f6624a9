"""Right-handed frames that curves and surfaces are placed in.

Source: ISO 10303-42, axis2_placement_3d.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

__all__ = ["Frame"]


@dataclass(frozen=True)
class Frame:
    """Origin (3,) mm and axes (3, 3), whose rows are the unit vectors x, y, z."""

    origin: np.ndarray
    axes: np.ndarray

    @classmethod
    def from_axis(cls, origin: np.ndarray, z: np.ndarray, x: np.ndarray | None) -> Frame:
        """Frame with the axis z, (3,), whose x is as near as can be to the one given (or any)."""
        z = z / _length(z)
        if x is None or _length(_cross(z, x)) < 1e-9 * _length(x):
            x = np.eye(3)[np.argmin(np.abs(z))]
        x = x - (x @ z) * z
        x = x / _length(x)
        return cls(origin, np.array([x, _cross(z, x), z]))

    def local(self, points: np.ndarray) -> np.ndarray:
        """Points (..., 3) in this frame's coordinates."""
        return (points - self.origin) @ self.axes.T

    def world(self, local: np.ndarray) -> np.ndarray:
        """Points (..., 3) given in this frame, in the workpiece frame."""
        return self.origin + local @ self.axes

    def direction(self, local: np.ndarray) -> np.ndarray:
        """Vectors (..., 3) given in this frame, in the workpiece frame."""
        return local @ self.axes

    def after(self, outer: Frame) -> Frame:
        """This frame, itself given in the coordinates of `outer`."""
        return Frame(outer.world(self.origin), self.axes @ outer.axes)


def _length(vector: np.ndarray) -> float:
    return math.sqrt(vector @ vector)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of two vectors, (3,): many times faster than NumPy's for rows."""
    (ax, ay, az), (bx, by, bz) = a, b
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
