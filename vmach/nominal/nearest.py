"""The nominal surface under points that were measured anywhere on the part.

Source: closed form derived here: the foot of a perpendicular, d = (m - p) . n, on the face's exact
surface; of facets (STL), on the plane of the nearest one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from vmach.nominal.part import NominalPart
from vmach.nominal.surfaces import unit_normals
from vmach.nominal.surfaces.face import SurfaceFace

__all__ = ["Feet", "feet_on"]

#: of the points that tell which face is near; no closer than the size of the part allows
_SPACING_MM, _SMALLEST_SHARE = 1.0, 1.0 / 300.0
#: faces that are looked at under each point
_FACES = 6
#: steps towards the foot of a perpendicular; each squares the error
_STEPS = 3


@dataclass(frozen=True)
class Feet:
    """Points of the nominal surface under P measured ones.

    Attributes
    ----------
    point_mm, normal : (P, 3) float64
        With outward unit normals.
    feature : (P,) str
        Name of the face.
    distance_mm : (P,) float64
        Signed, along the normal.
    """

    point_mm: np.ndarray
    normal: np.ndarray
    feature: np.ndarray
    distance_mm: np.ndarray


def feet_on(part: NominalPart, measured_mm: np.ndarray) -> Feet:
    """The nearest point of the nominal surface for every measured one, (P, 3) mm."""
    size = float(np.linalg.norm(np.ptp(part.bounds_mm, axis=0)))
    known = part.sample(max(_SPACING_MM, size * _SMALLEST_SHARE))
    names = np.array([face.name for face in part.faces])
    number = {name: k for k, name in enumerate(names)}
    face_of = np.array([number[name] for name in known.feature])
    near = min(4 * _FACES, len(known))
    distance, index = cKDTree(known.point_mm).query(measured_mm, k=near)
    distance, index = distance.reshape(-1, near), index.reshape(-1, near)
    best = np.full(len(measured_mm), np.inf)
    point, normal = known.point_mm[index[:, 0]].copy(), known.normal[index[:, 0]].copy()
    chosen = face_of[index[:, 0]]
    for number_of_face in np.unique(face_of[index]):
        rows, column = _first_of(face_of[index] == number_of_face)
        start = index[rows, column]
        foot, out = _foot(
            part.faces[number_of_face], measured_mm[rows], known.point_mm[start],
            known.normal[start],
        )  # fmt: skip
        apart = np.linalg.norm(measured_mm[rows] - foot, axis=1)
        # beyond the edge of its face a foot lies on no surface: the face's own points are far
        beyond = np.linalg.norm(foot - known.point_mm[start], axis=1)
        apart = np.where(beyond > 2.0 * _reach(known.point_mm, face_of == number_of_face),
                         distance[rows, column], apart)  # fmt: skip
        better = apart < best[rows] - 1e-9
        take = rows[better]
        best[take], chosen[take] = apart[better], number_of_face
        point[take], normal[take] = foot[better], out[better]
    signed = np.einsum("ij,ij->i", measured_mm - point, normal)
    return Feet(point, normal, names[chosen], signed)


def _first_of(mask: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows with a true entry, and the column of the first one in each."""
    rows = np.flatnonzero(mask.any(axis=1))
    return rows, np.argmax(mask[rows], axis=1)


def _reach(points_mm: np.ndarray, own: np.ndarray) -> float:
    """How far apart the points of a face lie, at most."""
    if np.count_nonzero(own) < 2:
        return float("inf")
    apart, _ = cKDTree(points_mm[own]).query(points_mm[own], k=2)
    return float(apart[:, 1].max())


def _foot(
    face: object, measured_mm: np.ndarray, start_mm: np.ndarray, normal: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Foot of the perpendicular on a face's surface, and outward normals there, (P, 3) each."""
    if not isinstance(face, SurfaceFace):
        out = np.einsum("ij,ij->i", measured_mm - start_mm, normal)
        return measured_mm - out[:, None] * normal, normal
    foot = measured_mm
    for _ in range(_STEPS):
        uv = face.surface.parameters(foot)
        uv = np.where(np.isfinite(uv), uv, 0.0)
        point = face.surface.evaluate(uv)
        normal = face.outward * unit_normals(face.surface, uv)
        out = np.einsum("ij,ij->i", measured_mm - point, normal)
        foot = measured_mm - out[:, None] * normal
    return point, normal
