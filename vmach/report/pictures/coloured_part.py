"""Colours of the virtual part by the deviation of the inspected points nearest to it."""

from __future__ import annotations

import numpy as np

from vmach.report.figures.statistics import common_range_mm
from vmach.report.pictures.colours import colours_of
from vmach.report.pictures.display_mesh import interpolate_to_mesh
from vmach.report.result import DisplayMesh, InspectedPoints

__all__ = ["part_colours"]


def part_colours(
    vertices_mm: np.ndarray, triangles: np.ndarray, points: InspectedPoints
) -> np.ndarray:
    """Colour of every vertex on the scale of the heat map, (V, 3) uint8.

    Parameters
    ----------
    vertices_mm, triangles : (V, 3) float64, (T, 3) int
    points : InspectedPoints
        The primary column counts; vertices that no cut point is near to are grey.
    """
    column = points.primary
    value_mm = np.where(column.is_cut, column.deviation_mm, np.nan)
    colouring = interpolate_to_mesh(points, value_mm, DisplayMesh(vertices_mm, triangles))
    colours = colours_of(colouring.value_mm, colouring.known, common_range_mm(points.columns))
    return np.round(255 * colours).astype(np.uint8)
