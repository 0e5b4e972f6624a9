"""What is shown of a job with neither nominal CAD nor measured points: its blank, or a floor."""

from __future__ import annotations

import numpy as np

from vmach.nominal.points import SurfacePoints
from vmach.path.preparation import Preparation

__all__ = ["MISSING", "bare_solid", "is_bare", "no_points"]

#: what such a job lacks, for the page
MISSING = (
    "This job names neither nominal CAD nor measured points, so no deviation is shown: the blank, "
    'and the tool on its path. nominal = "part.step" or measured = "points.csv" in the job file '
    "brings the part."
)
#: two triangles on each side of a box, corners numbered by the bits of z, y and x; outward
_SIDES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
#: how thick the floor is that stands for a blank, mm
_FLOOR_MM = 1.0


def is_bare(preparation: Preparation) -> bool:
    """Whether nothing says where the part could be looked at."""
    return preparation.job.nominal is None and preparation.job.measured is None


def no_points() -> SurfacePoints:
    """Not one point."""
    names, places = np.zeros(0, dtype=str), np.zeros((0, 3))
    return SurfacePoints(names, names, places, places)


def bare_solid(preparation: Preparation) -> tuple[np.ndarray, np.ndarray]:
    """The blank, or a floor below the tip's path where there is none.

    Returns
    -------
    (V, 3) float64, (T, 3) int
        Vertices, mm in workpiece coordinates, and triangles.
    """
    blank = preparation.job.blank
    if blank is None:
        return _box(*_floor(preparation))
    if blank.mesh is not None:
        return np.asarray(blank.mesh.vertices), np.asarray(blank.mesh.faces)
    return _box(blank.min_mm, blank.max_mm)


def _floor(preparation: Preparation) -> tuple[np.ndarray, np.ndarray]:
    """Two corners below all places of the tip, (3,) mm each; at the zero where it never moves."""
    nodes = preparation.path.nodes
    tip = nodes.nose_mm + nodes.tool_mm - preparation.zero_mm if len(nodes) else np.zeros((1, 3))
    low, high = tip.min(axis=0), tip.max(axis=0)
    high[2] = low[2]
    wide = np.array([_FLOOR_MM, _FLOOR_MM, 0.0])
    return low - np.array([0.0, 0.0, _FLOOR_MM]), np.maximum(high, low + wide)


def _box(low_mm: np.ndarray, high_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    triangles = [t for a, b, c, d in _SIDES for t in ((a, b, c), (a, c, d))]
    return low_mm + corners * (high_mm - low_mm), np.array(triangles)
