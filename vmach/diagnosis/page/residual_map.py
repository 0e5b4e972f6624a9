"""Measured minus predicted on the part, before and after, ready to be coloured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PIL import Image
from scipy.spatial import cKDTree

from vmach.diagnosis.residuals import Residuals
from vmach.nominal import Mesh
from vmach.report import Colouring, Column, DisplayMesh, InspectedPoints, build_display_mesh
from vmach.report.pictures.camera import isometric_camera, shading
from vmach.report.pictures.colours import colour_range, colours_of
from vmach.report.pictures.display_mesh import vertex_normals
from vmach.report.pictures.rasterise import rasterise

__all__ = ["ResidualMap", "residual_map"]

#: sides of the disc that stands for a point where there is no CAD, and its size: share of the
#: distance to the next point, and of the part at least and at most
_SIDES, _SHARE, _LEAST, _MOST = 10, 0.5, 0.008, 0.02
_WIDTH, _TRIANGLES = 720, 30_000


@dataclass(frozen=True)
class ResidualMap:
    """The measured points of a part and a mesh to colour.

    Attributes
    ----------
    points : InspectedPoints
        With the columns "before" and, where effects were fitted, "after".
    mesh : DisplayMesh
        The nominal CAD, or a disc at each point.
    range_mm : float
        End of the colour scale.
    """

    points: InspectedPoints
    mesh: DisplayMesh
    range_mm: float

    def stills(self) -> dict[str, Image.Image]:
        """A picture of each column on white, for print and browsers without WebGL 2."""
        camera = isometric_camera(self.mesh.vertices_mm)
        size = (_WIDTH, round(_WIDTH * camera.height_mm / camera.width_mm))
        shade = shading(vertex_normals(self.mesh), camera)[:, None]
        found = {}
        for name, colouring in self.mesh.colourings.items():
            colours = shade * colours_of(colouring.value_mm, colouring.known, self.range_mm)
            part = Image.fromarray(rasterise(self.mesh, colours, camera, size), "RGBA")
            white = Image.new("RGBA", part.size, "white")
            found[name] = Image.alpha_composite(white, part)
        return found


def residual_map(residuals: Residuals, nominal: Mesh | None) -> ResidualMap | None:
    """The map of the measured part; None where only instruments measured.

    Parameters
    ----------
    residuals : Residuals
    nominal : Mesh or None
        Of the nominal CAD; without it every point is shown as a small disc.
    """
    points = _points(residuals)
    if points is None:
        return None
    if nominal is None:
        mesh = _discs(points)
    else:
        mesh = build_display_mesh(
            nominal.vertices_mm, nominal.triangles, points, max_triangles=_TRIANGLES
        )
    values = [column.deviation_mm for column in points.columns]
    return ResidualMap(points, mesh, colour_range(values))


def _points(residuals: Residuals) -> InspectedPoints | None:
    survey = residuals.survey
    for m, path, own in zip(survey.measurements, survey.paths, survey.rows, strict=True):
        if not m.on_part:
            continue
        cut = np.full(len(m), "cut")
        # a hole as a whole faces nowhere: its mark lies level
        faces = np.abs(path.normal).max(axis=1, keepdims=True) > 0.0
        return InspectedPoints(
            id=m.id,
            feature=m.group,
            point_mm=path.on_part_mm,
            normal=np.where(faces, path.normal, [0.0, 0.0, 1.0]),
            line=m.states.line,
            tool=m.states.tool,
            move=m.states.move,
            time_s=m.states.time_s,
            columns=tuple(
                Column(state, state, residuals.of(state)[own], cut) for state in residuals.states
            ),
            u_mm=m.u_mm,
        )
    return None


def _discs(points: InspectedPoints) -> DisplayMesh:
    """A small polygon at every point, square to its normal, in the colour of the point alone.

    It has two sides, so that no edge counts as an outline of the part.
    """
    normal = points.normal
    helper = np.where(np.abs(normal[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    across = np.cross(normal, helper)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    other = np.cross(normal, across)
    turn = np.linspace(0.0, 2 * np.pi, _SIDES, endpoint=False)[:, None, None]
    rim = points.point_mm + _radius_mm(points) * (np.cos(turn) * across + np.sin(turn) * other)
    vertices = rim.transpose(1, 0, 2).reshape(-1, 3)
    fan = np.array([[0, k, k + 1] for k in range(1, _SIDES - 1)])
    fan = np.vstack([fan, fan[:, ::-1]])
    triangles = (np.arange(len(points))[:, None, None] * _SIDES + fan).reshape(-1, 3)
    known = np.ones(len(vertices), dtype=bool)
    colourings = {
        v.name: Colouring(np.repeat(v.deviation_mm, _SIDES), known) for v in points.columns
    }
    return DisplayMesh(vertices, triangles, colourings)


def _radius_mm(points: InspectedPoints) -> float:
    size = float(np.linalg.norm(np.ptp(points.point_mm, axis=0)))
    if len(points) < 2:
        return max(_MOST * size, 1.0)
    next_mm = cKDTree(points.point_mm).query(points.point_mm, k=2)[0][:, 1]
    return float(np.clip(_SHARE * np.median(next_mm), _LEAST * size, _MOST * size))
