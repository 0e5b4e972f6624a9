"""A tool as a stack of rings: what the hulls of the virtual part are made of.

Source: closed form derived here: chords of an arc of radius r keep within r (1 - cos(a / 2)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stock.tools import Corner, Tool

__all__ = ["RingStack", "azimuth_count", "ring_stack"]


@dataclass(frozen=True)
class RingStack:
    """K rings of a convex body of revolution about +Z, from the tip upwards.

    Normals are given by their inclination: 0 points straight down, pi/2 is level, pi straight
    up. At a ring the outward normals fill an interval: that between the facets below and above.

    Attributes
    ----------
    rings : (K, 4) float64
        Radius and height above the tip, mm; the lower and upper end of the normals' interval.
    azimuths : (K,) int64
        Number of points on each full ring, so that its chords keep the tolerance.
    """

    rings: np.ndarray
    azimuths: np.ndarray

    def up_to(self, height_mm: float) -> RingStack:
        """The rings that matter where nothing lies above `height_mm`, open at the top.

        The topmost ring left lies at that height or above, or is the last; its normals lose
        the upper side.
        """
        count = max(int(np.searchsorted(self.rings[:, 1], height_mm)) + 1, 2)
        rings = self.rings[:count].copy()
        rings[-1, 3] = rings[-1, 2]
        return RingStack(rings, self.azimuths[:count])


def ring_stack(tool: Tool, tolerance_mm: float) -> RingStack:
    """Rings on the tool's surface whose chords, along and around, stay within the tolerance."""
    tangents = [0.0, *map(_tangent, tool.corners[:-1], tool.corners[1:]), np.pi]
    rings = np.vstack(
        [
            _corner_rings(corner, lo, hi, tolerance_mm)
            for corner, lo, hi in zip(tool.corners, tangents[:-1], tangents[1:], strict=True)
        ]
    )
    return RingStack(rings, azimuth_count(rings[:, 0], tolerance_mm))


def azimuth_count(radius_mm: np.ndarray, tolerance_mm: float) -> np.ndarray:
    """Corners of polygons, (N,), within `tolerance_mm` of circles, (N,) mm; multiples of four.

    The corners lie on the circle, which leaves a sagitta of r (1 - cos(pi / n)).
    """
    corners = np.pi / (_chord_angle(radius_mm, tolerance_mm) / 2)
    return np.where(radius_mm > 0, np.maximum(4 * np.ceil(corners / 4), 8), 1).astype(np.int64)


def _chord_angle(radius_mm: np.ndarray | float, tolerance_mm: float) -> np.ndarray:
    """Angle of the chord whose sagitta on a circle is `tolerance_mm`, at most pi / 4."""
    ratio = 1 - tolerance_mm / np.maximum(radius_mm, tolerance_mm)
    return np.clip(2 * np.arccos(ratio), 1e-4, np.pi / 4)


def _tangent(a: Corner, b: Corner) -> float:
    """Inclination of the outward normal of the edge that touches both corners' circles."""
    step = np.array([b.r_mm - a.r_mm, b.z_mm - a.z_mm])
    length = np.hypot(*step)
    along = (a.radius_mm - b.radius_mm) / length
    across = np.sqrt(max(1 - along**2, 0.0))
    normal = (along * step + across * np.array([step[1], -step[0]])) / length
    return float(np.arctan2(normal[0], -normal[1]))


def _corner_rings(corner: Corner, lo: float, hi: float, tolerance_mm: float) -> np.ndarray:
    """Radius, height and interval of normals, (K, 4), of the rings on one corner."""
    if corner.radius_mm == 0.0:
        return np.array([[corner.r_mm, corner.z_mm, lo, hi]])
    steps = int(np.ceil((hi - lo) / _chord_angle(corner.radius_mm, tolerance_mm) - 1e-9))
    normals = np.linspace(lo, hi, max(steps, 1) + 1)
    between = (normals[1:] + normals[:-1]) / 2  # normals of the facets between the rings
    radius = corner.r_mm + corner.radius_mm * np.sin(normals)
    height = corner.z_mm - corner.radius_mm * np.cos(normals)
    return np.column_stack([radius, height, np.r_[lo, between], np.r_[between, hi]])
