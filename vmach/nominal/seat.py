"""Where a part lay when it was measured: a rigid motion that odd readings do not pull along.

Source: E. J. Schlossmacher, J. Amer. Statist. Assoc. 68 (1973) 857: least absolute deviations by
reweighted least squares; closed form derived here: n . (d + w x r) of small motions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from vmach.nominal.points import SurfacePoints

__all__ = ["Seat", "motion_beside_odd_ones", "seat_of"]

#: so many readings speak against every motion: it takes more of them, as two may both be odd, and
#: a turn about a bore's own axis, which all of its readings hardly see, stays none
_AGAINST = 3.0
#: readings that show a large motion, at least
_FEWEST = 4
#: deviations below this count by their square, mm: all are noise there
_NOISE_MM = 1e-3
#: steps of the weights at most, and what is small enough to stop at, mm
_STEPS, _SETTLED_MM = 100, 1e-7
#: times that the points are taken back: a turn is small for each of them
_TIMES = 6


@dataclass(frozen=True)
class Seat:
    """A rigid motion of the part, in workpiece coordinates: p goes to R (p - p0) + p0 + d.

    Attributes
    ----------
    rotation : (3, 3) float64
        R, right-handed.
    shift_mm : (3,) float64
        d, of the place p0.
    about_mm : (3,) float64
        p0.
    """

    rotation: np.ndarray
    shift_mm: np.ndarray
    about_mm: np.ndarray

    def moved(self, points_mm: np.ndarray) -> np.ndarray:
        """Where the motion brings points, (P, 3) mm."""
        return (points_mm - self.about_mm) @ self.rotation.T + self.about_mm + self.shift_mm

    def taken_back(self, measured_mm: np.ndarray) -> np.ndarray:
        """Measured points without the motion, (P, 3) mm."""
        return (measured_mm - self.about_mm - self.shift_mm) @ self.rotation + self.about_mm

    def deviation_mm(self, points_mm: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """What the motion does to deviations to first order, n . (d + w x (p - p0)), (P,) mm."""
        turn = Rotation.from_matrix(self.rotation).as_rotvec()
        motion = self.shift_mm + np.cross(turn, points_mm - self.about_mm)
        return np.einsum("ij,ij->i", motion, normals)

    def size_mm(self, points: SurfacePoints) -> float:
        """How far it moves the points (median), or those four that show most of it, if less."""
        away = np.linalg.norm(self.moved(points.point_mm) - points.point_mm, axis=1)
        shown = np.sort(np.abs(self.deviation_mm(points.point_mm, points.normal)))
        return float(min(np.median(away), shown[-_FEWEST:].min()))

    @property
    def shift_of_zero_mm(self) -> np.ndarray:
        """Where the motion brings the workpiece zero, (3,) mm."""
        return self.moved(np.zeros(3))


def seat_of(points: SurfacePoints) -> Seat:
    """The motion that brings nominal points to most of the measured ones, along their normals.

    Measured points may be those of the same places, or lie on the normals: the surface alone
    counts. What few readings tell, or all of them hardly, is left as it is.
    """
    assert points.measured_mm is not None
    about = points.point_mm.mean(axis=0)
    seat = Seat(np.eye(3), np.zeros(3), about)
    for _ in range(_TIMES):
        apart = seat.taken_back(points.measured_mm) - points.point_mm
        deviation = np.einsum("ij,ij->i", apart, points.normal)
        step = motion_beside_odd_ones(points.point_mm - about, points.normal, deviation)
        turn = Rotation.from_rotvec(step[3:]).as_matrix()
        shift = seat.shift_mm + seat.rotation @ step[:3]
        seat = Seat(seat.rotation @ turn, shift, about)
        if np.abs(step).max() < _SETTLED_MM:
            break
    return seat


def motion_beside_odd_ones(
    arm_mm: np.ndarray, normals: np.ndarray, deviation_mm: np.ndarray
) -> np.ndarray:
    """The small motion that leaves the least sum of absolute deviations.

    A motion by some length counts beside them as three readings that are so far away.

    Parameters
    ----------
    arm_mm, normals : (P, 3) float64
        Places from the point that the part is turned about, and unit normals.
    deviation_mm : (P,) float64

    Returns
    -------
    (6,) float64
        Shift, mm, and rotation vector, rad; zero along what fewer than three readings tell.
    """
    length_mm = float(np.sqrt(np.mean(np.sum(arm_mm**2, axis=1)))) or 1.0
    rows = np.hstack([normals, np.cross(arm_mm, normals) / length_mm])
    motion = _least_absolute(
        np.vstack([rows, _AGAINST * np.eye(6)]), np.r_[deviation_mm, np.zeros(6)]
    )
    motion[3:] /= length_mm
    return motion


def _least_absolute(rows: np.ndarray, target: np.ndarray) -> np.ndarray:
    """The x (k,) of least sum of |rows x - target|, rows (P, k), target (P,) mm."""
    found = np.zeros(rows.shape[1])
    weight = np.ones(len(target))
    for _ in range(_STEPS):
        weighted = rows * weight[:, None]
        new = np.linalg.lstsq(weighted.T @ rows, weighted.T @ target, rcond=None)[0]
        is_settled = np.abs(new - found).max(initial=0.0) < _SETTLED_MM
        found = new
        if is_settled:
            break
        weight = 1.0 / np.maximum(np.abs(rows @ found - target), _NOISE_MM)
    return found
