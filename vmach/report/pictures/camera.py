"""A parallel view of a part, shared by everything that draws it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["TOWARDS_VIEWER", "Camera", "isometric_camera", "shading"]

#: direction from the part to the viewer in every standard picture
TOWARDS_VIEWER = (0.55, -0.75, 0.62)  # from the front, the right and above
_MARGIN = 1.04  # of the picture over the part
_ASPECTS = 1.1, 2.4  # width over height, narrowest and widest picture


@dataclass(frozen=True)
class Camera:
    """Parallel projection; the rows of `axes` are right, up and towards the viewer.

    Attributes
    ----------
    axes : (3, 3) float64
        Orthonormal, in workpiece coordinates.
    centre_mm : (3,) float64
        The point in the middle of the picture.
    width_mm, height_mm : float
        What the picture covers.
    """

    axes: np.ndarray
    centre_mm: np.ndarray
    width_mm: float
    height_mm: float

    def pixels(self, points_mm: np.ndarray, size: tuple[int, int]) -> np.ndarray:
        """(N, 3) column, row (downwards) and depth in mm (larger is nearer) of (N, 3) points."""
        seen = (points_mm - self.centre_mm) @ self.axes.T
        width, height = size
        column = (seen[:, 0] / self.width_mm + 0.5) * width
        row = (0.5 - seen[:, 1] / self.height_mm) * height
        return np.stack([column, row, seen[:, 2]], axis=1)


def isometric_camera(points_mm: np.ndarray) -> Camera:
    """Return a camera that just sees all (N, 3) points, in a picture of sensible shape."""
    towards = np.array(TOWARDS_VIEWER) / np.linalg.norm(TOWARDS_VIEWER)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(towards, right), towards])
    seen = points_mm @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    width, height = np.maximum(_MARGIN * (high - low)[:2], 1e-6)
    narrowest, widest = _ASPECTS
    return Camera(
        axes,
        centre_mm=0.5 * (low + high) @ axes,
        width_mm=max(width, narrowest * height),
        height_mm=max(height, width / widest),
    )


def shading(normals: np.ndarray, camera: Camera) -> np.ndarray:
    """(N,) brightness of surfaces with (N, 3) normals, 0.7 to 1: enough to see the shape.

    The light comes over the viewer's left shoulder. Colours carry the numbers, so the shade
    is kept weak.
    """
    light = np.array([-0.35, 0.5, 0.8]) @ camera.axes
    return 0.7 + 0.3 * np.clip(normals @ (light / np.linalg.norm(light)), 0.0, 1.0)
