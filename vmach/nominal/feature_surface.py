"""Faces of the nominal CAD, and clouds of nominal points, as surfaces that features are made of.

Source: ISO 10303-42 (surfaces and their senses); closed form derived here: the normals of a
cylinder's points lie across its axis, and its points stand off it by the radius along them.
"""

from __future__ import annotations

import numpy as np

from vmach.errors import InputError
from vmach.features.surface import Surface
from vmach.nominal.part import Face
from vmach.nominal.surfaces import Cone, Cylinder, Plane, Sphere, Torus
from vmach.nominal.surfaces.face import SurfaceFace

__all__ = ["surface_of_face", "surface_of_points"]

#: points of a plane, a cylinder or a sphere keep to it within this, mm
_FITS_MM = 2e-3


def surface_of_face(face: Face, points: np.ndarray, normals: np.ndarray) -> Surface:
    """The surface of a face.

    Parameters
    ----------
    face : Face
    points, normals : (N, 3) array
        Nominal points on it, and outward unit normals, in the order in which they are used.
    """
    if not isinstance(face, SurfaceFace):
        kind = "plane" if face.kind == "plane" else "free"
        return surface_of_points(kind, points, normals)
    surface, sign = face.surface, face.outward
    if isinstance(surface, Plane):
        return Surface("plane", surface.frame.origin, sign * surface.frame.axes[2])
    if not isinstance(surface, Cylinder | Cone | Sphere | Torus):
        return _free(points, normals)
    if isinstance(surface, Torus) and surface.major_mm < surface.minor_mm:
        return _free(points, normals)  # its tube crosses the axis; the face may be on either side
    frame = surface.frame
    place, axis = frame.origin, frame.axes[2]
    if isinstance(surface, Torus):
        return Surface("torus", place, axis, surface.major_mm, tube_mm=surface.minor_mm, sign=sign)
    if isinstance(surface, Cone):
        return Surface("cone", place, axis, surface.radius_mm, surface.half_angle_rad, sign=sign)
    kind = "cylinder" if isinstance(surface, Cylinder) else "sphere"
    return Surface(kind, place, axis, surface.radius_mm, sign=sign)


def surface_of_points(kind: str, points: np.ndarray, normals: np.ndarray) -> Surface:
    """The surface of nominal points (N, 3) whose outward normals (N, 3) are known.

    Raises
    ------
    InputError
        The points do not lie on such a surface.
    """
    if kind == "free" or not len(points):
        return _free(points, normals)
    if kind == "plane":
        found = Surface("plane", points.mean(axis=0), normals.mean(axis=0))
    elif kind == "cylinder":
        found = _cylinder(points, normals)
    else:
        found = _sphere(points, normals)
    far = float(np.abs(found.distance_mm(points)).max())
    if far > _FITS_MM:
        raise InputError(
            f"the nominal points are up to {far:.3g} mm from a {kind}",
            accepted=f'points within {_FITS_MM} mm, or kind = "free"',
        )
    return found


def _free(points: np.ndarray, normals: np.ndarray) -> Surface:
    place = points.mean(axis=0) if len(points) else np.zeros(3)
    return Surface("free", place, np.array([0.0, 0.0, 1.0]), nominal_mm=points, normals=normals)


def _cylinder(points: np.ndarray, normals: np.ndarray) -> Surface:
    axis = np.linalg.svd(normals, full_matrices=False)[2][2]
    flat = np.eye(3) - np.outer(axis, axis)
    centre, reach = _centre_and_reach(points @ flat, normals, flat)
    return Surface("cylinder", centre, axis, abs(reach), sign=np.sign(reach) or 1.0)


def _sphere(points: np.ndarray, normals: np.ndarray) -> Surface:
    centre, reach = _centre_and_reach(points, normals, np.eye(3))
    return Surface("sphere", centre, [0, 0, 1], abs(reach), sign=np.sign(reach) or 1.0)


def _centre_and_reach(points: np.ndarray, normals: np.ndarray, flat: np.ndarray):
    """Centre c and signed radius r of points = c + r normal; r is below zero in a hole."""
    rows = np.zeros((3 * len(points), 4))
    rows[:, :3] = np.tile(flat, (len(points), 1))
    rows[:, 3] = (normals @ flat).ravel()
    found = np.linalg.lstsq(rows, points.ravel(), rcond=None)[0]
    return found[:3], float(found[3])
