"""Right-handed frames that curves and surfaces are placed in.

Source: ISO 10303-42, axis2_placement_3d.
"""

from __future__ import annotations

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
        z = z / np.linalg.norm(z)
        if x is None or np.linalg.norm(np.cross(z, x)) < 1e-9 * np.linalg.norm(x):
            x = np.eye(3)[np.argmin(np.abs(z))]
        x = x - (x @ z) * z
        x = x / np.linalg.norm(x)
        return cls(origin, np.array([x, np.cross(z, x), z]))

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
