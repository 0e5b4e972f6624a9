"""Nominal surfaces that features are made of, and the distance of points from them.

Source: closed form derived here: the distance from a surface of revolution is that from its
profile in the half plane of height and radius.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vmach.errors import InputError

__all__ = ["KINDS", "Compound", "Surface", "same_surface"]

#: kinds of surface; a free one is known by its nominal points and normals only
KINDS = ("plane", "cylinder", "cone", "sphere", "torus", "free")

#: sizes of their own that an association may change, by kind
_SIZES = {
    "cylinder": ("radius_mm",),
    "sphere": ("radius_mm",),
    "cone": ("half_angle_rad",),
    "torus": ("radius_mm", "tube_mm"),
}

#: surfaces are one and the same within this, in mm and rad
_SAME = 1e-6


@dataclass(frozen=True)
class Surface:
    """One nominal surface in workpiece coordinates.

    Attributes
    ----------
    kind : str
        One of `KINDS`.
    point_mm : (3,) float64
        A point of the plane; a point of the axis where the cone has `radius_mm`; the centre.
    axis : (3,) float64
        Unit vector: outward normal of a plane, else the direction of the axis.
    radius_mm : float
        Of cylinder and sphere; of the cone at its point; of the torus' circle.
    half_angle_rad : float
        Of a cone: the radius grows by its tangent along the axis.
    tube_mm : float
        Radius of the torus' tube.
    sign : float
        +1 where the material lies inside (shaft, ball), -1 where it lies outside (hole).
    nominal_mm, normals : (N, 3) float64, optional
        Of a free surface: nominal points and outward unit normals, one for every point that is
        looked at later, in their order.
    """

    kind: str
    point_mm: np.ndarray
    axis: np.ndarray
    radius_mm: float = 0.0
    half_angle_rad: float = 0.0
    tube_mm: float = 0.0
    sign: float = 1.0
    nominal_mm: np.ndarray | None = None
    normals: np.ndarray | None = None

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(f"surface of kind {self.kind!r}", accepted=", ".join(KINDS))
        axis = np.array(self.axis, dtype=np.float64)
        object.__setattr__(self, "axis", axis / np.linalg.norm(axis))
        object.__setattr__(self, "point_mm", np.array(self.point_mm, dtype=np.float64))

    @property
    def has_axis(self) -> bool:
        """Whether the surface turns about an axis that a derived feature may be taken from."""
        return self.kind in ("cylinder", "cone")

    @property
    def sizes(self) -> tuple[str, ...]:
        """Names of the attributes that an association may change."""
        return _SIZES.get(self.kind, ())

    def resized(self, change: np.ndarray) -> Surface:
        """The surface with its sizes changed, (K,) in the order of `sizes`."""
        new = {
            name: getattr(self, name) + float(step)
            for name, step in zip(self.sizes, change, strict=True)
        }
        return replace(self, **new) if new else self

    def among(self, chosen: np.ndarray) -> Surface:
        """The surface as it is looked at by some of its points only."""
        if self.nominal_mm is None:
            return self
        return replace(self, nominal_mm=self.nominal_mm[chosen], normals=self.normals[chosen])

    def heights_mm(self, points: np.ndarray) -> np.ndarray:
        """Heights of points (N, 3) along the axis from the surface's point, (N,)."""
        return (points - self.point_mm) @ self.axis

    def radial(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distances of points (N, 3) from the axis, (N,), and unit vectors away from it."""
        arm = points - self.point_mm
        arm = arm - np.outer(arm @ self.axis, self.axis)
        distance = np.linalg.norm(arm, axis=1)
        return distance, arm / np.maximum(distance, 1e-300)[:, None]

    def distance_mm(self, points: np.ndarray) -> np.ndarray:
        """Signed distances of points (N, 3), (N,); positive outside the material."""
        return self._look(points)[0]

    def rows(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Distances (N,), their normals (N, 3), and -d distance/d size (N, K)."""
        return self._look(points)

    def _look(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return _LOOKS[self.kind](self, points)


@dataclass(frozen=True)
class Compound:
    """Several surfaces with the points of each, one after the other, as one feature.

    Attributes
    ----------
    parts : tuple of Surface
    counts : tuple of int
        How many points belong to each.
    """

    parts: tuple[Surface, ...]
    counts: tuple[int, ...]
    kind = "compound"

    @property
    def sizes(self) -> tuple[str, ...]:
        """Names of the sizes of all parts."""
        return tuple(name for part in self.parts for name in part.sizes)

    def resized(self, change: np.ndarray) -> Compound:
        """The parts with their sizes changed, (K,)."""
        ends = np.cumsum([len(part.sizes) for part in self.parts])[:-1]
        steps = np.split(change, ends)
        parts = tuple(p.resized(s) for p, s in zip(self.parts, steps, strict=True))
        return replace(self, parts=parts)

    def rows(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Distances (N,), their normals (N, 3), and -d distance/d size (N, K)."""
        pieces = np.split(points, np.cumsum(self.counts)[:-1])
        seen = [part.rows(piece) for part, piece in zip(self.parts, pieces, strict=True)]
        own = np.zeros((len(points), len(self.sizes)))
        row = column = 0
        for _, _, block in seen:
            own[row : row + len(block), column : column + block.shape[1]] = block
            row, column = row + len(block), column + block.shape[1]
        return np.concatenate([s[0] for s in seen]), np.vstack([s[1] for s in seen]), own


def _plane(s: Surface, points: np.ndarray):
    normals = np.broadcast_to(s.axis, points.shape)
    return s.heights_mm(points), normals, np.empty((len(points), 0))


def _cylinder(s: Surface, points: np.ndarray):
    radius, away = s.radial(points)
    return s.sign * (radius - s.radius_mm), s.sign * away, np.full((len(points), 1), s.sign)


def _sphere(s: Surface, points: np.ndarray):
    arm = points - s.point_mm
    radius = np.linalg.norm(arm, axis=1)
    away = arm / np.maximum(radius, 1e-300)[:, None]
    return s.sign * (radius - s.radius_mm), s.sign * away, np.full((len(points), 1), s.sign)


def _cone(s: Surface, points: np.ndarray):
    radius, away = s.radial(points)
    height = s.heights_mm(points)
    cos, sin = np.cos(s.half_angle_rad), np.sin(s.half_angle_rad)
    above = radius - s.radius_mm
    distance = s.sign * (above * cos - height * sin)
    opening = s.sign * (above * sin + height * cos)
    return distance, s.sign * (cos * away - sin * s.axis), opening[:, None]


def _torus(s: Surface, points: np.ndarray):
    radius, away = s.radial(points)
    height = s.heights_mm(points)
    across = radius - s.radius_mm
    tube = np.hypot(across, height)
    safe = np.maximum(tube, 1e-300)
    out = (across / safe)[:, None] * away + (height / safe)[:, None] * s.axis
    sizes = s.sign * np.column_stack([across / safe, np.ones(len(points))])
    return s.sign * (tube - s.tube_mm), s.sign * out, sizes


def _free(s: Surface, points: np.ndarray):
    distance = np.einsum("ij,ij->i", points - s.nominal_mm, s.normals)
    return distance, s.normals, np.empty((len(points), 0))


_LOOKS = {
    "plane": _plane,
    "cylinder": _cylinder,
    "cone": _cone,
    "sphere": _sphere,
    "torus": _torus,
    "free": _free,
}


def same_surface(one: Surface, other: Surface) -> bool:
    """Whether two faces lie on one surface, as the two halves of a bore do."""
    if one.kind != other.kind or one.sign != other.sign or one.kind == "free":
        return False
    if one.kind == "plane":
        return bool(
            one.axis @ other.axis > 1.0 - _SAME
            and abs((other.point_mm - one.point_mm) @ one.axis) < _SAME
        )
    sizes = np.array([one.radius_mm - other.radius_mm, one.tube_mm - other.tube_mm])
    apart = other.point_mm - one.point_mm
    if one.kind in ("cylinder", "cone"):
        height = apart @ one.axis
        apart = apart - height * one.axis
        along = one.axis @ other.axis
        sizes[0] += height * np.tan(one.half_angle_rad)
        same_way = abs(np.tan(one.half_angle_rad) - along * np.tan(other.half_angle_rad)) < _SAME
        turned = abs(abs(along) - 1.0) > _SAME or not same_way
    else:
        turned = one.kind == "torus" and abs(abs(one.axis @ other.axis) - 1.0) > _SAME
    return bool(not turned and np.abs(sizes).max() < _SAME and np.linalg.norm(apart) < _SAME)
