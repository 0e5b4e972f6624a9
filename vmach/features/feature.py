"""A feature of the part: nominal surfaces, and which of the inspected points lie on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vmach.errors import InputError
from vmach.features.surface import Compound, Surface, same_surface

__all__ = ["Feature", "Member", "Points", "as_members", "make_feature"]

#: two planes face each other when their normals are opposite within this, rad
_OPPOSITE_RAD = 1e-6


@dataclass(frozen=True)
class Points:
    """P inspected points as one part shows them.

    Attributes
    ----------
    nominal_mm, normal : (P, 3) float64
        Nominal points and outward unit normals.
    deviation_mm : (P,) float64
        Along the normal, positive where material is left.
    is_known : (P,) bool
        Points that have a deviation.
    """

    nominal_mm: np.ndarray
    normal: np.ndarray
    deviation_mm: np.ndarray
    is_known: np.ndarray

    @classmethod
    def nominal(cls, nominal_mm: np.ndarray, normal: np.ndarray) -> Points:
        """The part without a deviation."""
        count = len(nominal_mm)
        return cls(nominal_mm, normal, np.zeros(count), np.ones(count, dtype=bool))

    @property
    def actual_mm(self) -> np.ndarray:
        """Where the points of the part lie, (P, 3)."""
        moved = np.where(self.is_known, self.deviation_mm, 0.0)
        return self.nominal_mm + moved[:, None] * self.normal


@dataclass(frozen=True)
class Member:
    """One surface of a feature and the rows, (N,) int, of the points that lie on it."""

    surface: Surface
    rows: np.ndarray

    def known(self, points: Points) -> Member:
        """The member with the points that have a deviation only."""
        chosen = points.is_known[self.rows]
        return Member(self.surface.among(chosen), self.rows[chosen])


#: an STL tells planes alone
_SAY_KIND = 'where it is round in an STL, say kind = "cylinder" or "sphere" in [[features]]'


@dataclass(frozen=True)
class Feature:
    """A named feature.

    Attributes
    ----------
    name : str
    members : tuple of Member
        One a surface: the faces of one bore are one member, four bores are four.
    faces : tuple of str
        Names of the faces that it is made of.
    """

    name: str
    members: tuple[Member, ...]
    faces: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """A kind of surface, ``width`` (two planes that face apart), ``pattern``, ``compound``."""
        surfaces = [member.surface for member in self.members]
        if len(surfaces) == 1:
            return surfaces[0].kind
        if len(surfaces) == 2 and all(s.kind == "plane" for s in surfaces):
            one, other = surfaces
            if np.linalg.norm(one.axis + other.axis) < _OPPOSITE_RAD:
                return "width"
        alike = {(s.kind, round(s.radius_mm, 6), s.sign) for s in surfaces}
        return "pattern" if len(alike) == 1 and surfaces[0].kind != "free" else "compound"

    @property
    def element(self) -> str:
        """Kind of a pattern's members; else the kind itself."""
        return self.members[0].surface.kind if self.kind == "pattern" else self.kind

    @property
    def hint_on_kind(self) -> str | None:
        """What to do where a surface is needed that nothing tells, as of facets of an STL."""
        is_free = any(member.surface.kind == "free" for member in self.members)
        return _SAY_KIND if is_free else None

    def pooled(self, points: Points) -> Member:
        """All members as one; its surface is a `Compound` where there are several.

        Raises
        ------
        InputError
            None of the points has a deviation.
        """
        members = [member.known(points) for member in self.members]
        rows = np.concatenate([member.rows for member in members])
        if not rows.size:
            raise InputError(
                f"no point of feature {self.name!r} was cut or measured",
                accepted="features that the program cuts, or that the file of points holds",
            )
        if len(members) == 1:
            return members[0]
        counts = tuple(len(member.rows) for member in members)
        return Member(Compound(tuple(m.surface for m in members), counts), rows)


def as_members(surfaces: Sequence[Surface], rows: Sequence[np.ndarray]) -> tuple[Member, ...]:
    """Faces, each with the rows (K,) of its points, put together where they lie on one surface."""
    members: list[Member] = []
    for surface, own in zip(surfaces, rows, strict=True):
        for k, member in enumerate(members):
            if same_surface(member.surface, surface):
                members[k] = Member(member.surface, np.concatenate([member.rows, own]))
                break
        else:
            members.append(Member(surface, own))
    return tuple(members)


def make_feature(
    name: str, surfaces: Sequence[Surface], rows: Sequence[np.ndarray], faces: Sequence[str] = ()
) -> Feature:
    """A feature of faces: their surfaces, and the rows (K,) of the points on each.

    Raises
    ------
    InputError
        No point lies on it.
    """
    if not sum(len(own) for own in rows):
        raise InputError(
            f"no point lies on feature {name!r}",
            accepted="faces with inspected points",
            hint="is [inspection] spacing_mm or edge_margin_mm too large for it?",
        )
    return Feature(name, as_members(surfaces, rows), tuple(faces))
