"""How far the blank reaches beyond the final surface: what no earlier pass has taken off yet.

Source: T. Kay and J. Kajiya, Ray tracing complex scenes, SIGGRAPH 1986 (slabs of a box).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vmach.job import Blank

if TYPE_CHECKING:
    import trimesh

__all__ = ["blank_depth_mm"]

#: a surface this near to the blank's own skin counts as lying in it
_SKIN_MM = 1e-4
#: a line may not slip through between two triangles
_SEAM_MM = 1e-6


def blank_depth_mm(
    blank: Blank, point_mm: np.ndarray, direction: np.ndarray, limit_mm: np.ndarray
) -> np.ndarray:
    """Material of the blank from points of the final surface outwards to its first edge, (P,) mm.

    Parameters
    ----------
    blank : Blank
    point_mm : (P, 3)
        In workpiece coordinates, as the blank.
    direction : (P, 3)
        Unit vectors away from the finished part; zero vectors have no depth.
    limit_mm : (P,)
        Largest depth that is told.
    """
    way = np.linalg.norm(direction, axis=1) > 0.0
    depth = np.zeros(len(point_mm))
    start = point_mm[way] - _SKIN_MM * direction[way]
    if blank.mesh is None:
        found = _in_box(blank.min_mm, blank.max_mm, start, direction[way])
    else:
        found = _in_solid(blank.mesh, start, direction[way])
    depth[way] = np.clip(found - _SKIN_MM, 0.0, limit_mm[way])
    return depth


def _in_box(
    low: np.ndarray, high: np.ndarray, start: np.ndarray, direction: np.ndarray
) -> np.ndarray:
    """Way to the face where a line leaves a box, (P,); 0 from outside."""
    wall = np.where(direction > 0.0, high, low)
    way = np.full_like(start, np.inf)
    np.divide(wall - start, direction, out=way, where=direction != 0.0)
    inside = ((start >= low - _SKIN_MM) & (start <= high + _SKIN_MM)).all(axis=1)
    return np.where(inside, way.min(axis=1), 0.0)


def _in_solid(mesh: trimesh.Trimesh, start: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Way to where a line leaves a closed solid, (P,); 0 from outside."""
    import pyvista
    from vtkmodules.vtkCommonCore import mutable
    from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

    locator = vtkStaticCellLocator()
    locator.SetDataSet(pyvista.make_tri_mesh(np.asarray(mesh.vertices, float), mesh.faces))
    locator.BuildLocator()
    share, part, cell = mutable(0.0), mutable(0), mutable(0)
    at, within = [0.0] * 3, [0.0] * 3
    # longer than any way inside, so that a line without a hit began outside
    far_mm = 2.0 * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    ends = start + far_mm * direction
    way = np.zeros(len(start))
    for k, (first, last) in enumerate(zip(start.tolist(), ends.tolist(), strict=True)):
        hit = locator.IntersectWithLine(first, last, _SEAM_MM, share, at, within, part, cell)
        if hit and mesh.face_normals[int(cell)] @ direction[k] > 0.0:
            way[k] = float(share) * far_mm
    return way
