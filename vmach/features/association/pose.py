"""A rigid motion that carries a nominal surface to where its points lie.

Source: Rodrigues' rotation formula.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

__all__ = ["Pose", "motion_rows"]


@dataclass(frozen=True)
class Pose:
    """x -> turn x + shift_mm; `turn` (3, 3) is a rotation, `shift_mm` (3,)."""

    turn: np.ndarray = field(default_factory=lambda: np.eye(3))
    shift_mm: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def apply(self, points: np.ndarray) -> np.ndarray:
        """Points (N, 3) carried along."""
        return points @ self.turn.T + self.shift_mm

    def undo(self, points: np.ndarray) -> np.ndarray:
        """Points (N, 3) as they lie in the nominal frame that the pose carries along."""
        return (points - self.shift_mm) @ self.turn

    def after(self, motion: np.ndarray, about_mm: np.ndarray) -> Pose:
        """The pose preceded by a motion (6,): shift in mm, rotation vector in rad `about_mm`."""
        turn = _rotation(motion[3:])
        shift = about_mm + motion[:3] - turn @ about_mm
        return Pose(self.turn @ turn, self.turn @ shift + self.shift_mm)


def _rotation(vector: np.ndarray) -> np.ndarray:
    """Rotation matrix of a rotation vector (3,) in rad."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + 2.0 * np.sin(angle / 2.0) ** 2 * cross @ cross


def motion_rows(points: np.ndarray, normals: np.ndarray, about_mm: np.ndarray) -> np.ndarray:
    """Motion along the normals by a unit shift or turn about a point, (N, 6)."""
    return np.hstack([normals, np.cross(points - about_mm, normals)])
