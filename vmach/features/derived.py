"""Derived features: the median line of a bore, the centre of a ball, the median plane of a slot.

Source: ISO 17450-1 and ISO 14660-2 (extracted median line: centres of least squares circles in
sections normal to the associated axis; extracted median surface).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.errors import InputError
from vmach.features.association.associate import Association, associate
from vmach.features.feature import Feature, Member, Points
from vmach.features.surface import Surface

__all__ = ["DerivedPoints", "derived_points", "section_rows"]

#: heights of points of one section agree within this
_SECTION_MM = 1e-3
#: fewer points than this, on average, are no sections: the points are put into slabs
_LEAST_POINTS = 4
#: points of a slab, on average
_SLAB_POINTS = 12
#: a section whose largest gap is wider has no centre of its own
_WIDEST_GAP_RAD = 0.75 * np.pi


@dataclass(frozen=True)
class DerivedPoints:
    """S points of a derived feature.

    Attributes
    ----------
    points_mm : (S, 3) float64
    rows : tuple of (N_s,) int
        Inspected points that each one follows.
    gain : tuple of (3, N_s) float64
        Its motion with the deviation of each.
    """

    points_mm: np.ndarray
    rows: tuple[np.ndarray, ...]
    gain: tuple[np.ndarray, ...]

    def __add__(self, other: DerivedPoints) -> DerivedPoints:
        points = np.vstack([self.points_mm, other.points_mm])
        return DerivedPoints(points, self.rows + other.rows, self.gain + other.gain)


def derived_points(feature: Feature, points: Points) -> list[DerivedPoints]:
    """The derived feature of every member, or of the two planes of a width.

    Raises
    ------
    InputError
        The feature has no derived feature, or too few points.
    """
    if feature.kind == "width":
        return [_median_plane(feature, points)]
    if feature.element not in ("cylinder", "cone", "sphere", "torus"):
        raise InputError(
            f"{feature.name!r} is a {feature.kind}, which has no axis and no centre",
            accepted="a cylinder, cone, sphere or torus, a pattern of them, or two opposite planes",
            hint=feature.hint_on_kind,
        )
    return [_of_member(member.known(points), points, feature.name) for member in feature.members]


def _of_member(member: Member, points: Points, name: str) -> DerivedPoints:
    actual = points.actual_mm[member.rows]
    try:
        found = associate(member.surface, actual)
    except InputError as error:
        raise InputError(f"feature {name!r}: {error.what}", accepted=error.accepted) from None
    if not member.surface.has_axis:
        return _centre(found, member)
    nominal = points.nominal_mm[member.rows]
    sections = [_section_centre(found, actual, rows) for rows in
                section_rows(member.surface.heights_mm(nominal))]  # fmt: skip
    kept = [section for section in sections if section is not None]
    if len(kept) < 2:
        return _axis_ends(found, member, nominal)
    centres, rows, gain = zip(*kept, strict=True)
    return DerivedPoints(np.array(centres), tuple(member.rows[r] for r in rows), gain)


def section_rows(heights_mm: np.ndarray) -> list[np.ndarray]:
    """Points, by their heights (N,), put into sections: rows of one height, else slabs."""
    order = np.argsort(heights_mm, kind="stable")
    breaks = np.flatnonzero(np.diff(heights_mm[order]) > _SECTION_MM) + 1
    sections = np.split(order, breaks)
    if len(order) >= _LEAST_POINTS * len(sections):
        return sections
    return np.array_split(order, max(len(order) // _SLAB_POINTS, 1))


def _section_centre(found: Association, actual: np.ndarray, rows: np.ndarray):
    """Centre of the least squares circle of a section, the rows, and its gain (3, N_s)."""
    surface = found.placed
    _, away = surface.radial(actual[rows])
    if len(rows) < _LEAST_POINTS or largest_gap_rad(surface, away) > _WIDEST_GAP_RAD:
        return None
    first, second = in_plane(surface.axis)
    slope = np.cos(surface.half_angle_rad) * surface.sign
    design = slope * np.column_stack([away @ first, away @ second, np.ones(len(rows))])
    gain = np.linalg.pinv(design)[:2]
    offset = gain @ found.residual_mm[rows]
    height = float(surface.heights_mm(actual[rows]).mean())
    centre = surface.point_mm + height * surface.axis + offset @ np.array([first, second])
    return centre, rows, np.array([first, second]).T @ gain


def in_plane(axis: np.ndarray) -> np.ndarray:
    """Two unit vectors normal to an axis and to each other, (2, 3)."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    first = np.cross(axis, helper)
    first = first / np.linalg.norm(first)
    return np.array([first, np.cross(axis, first)])


def largest_gap_rad(surface: Surface, away: np.ndarray) -> float:
    """Widest angle about the axis without a point; directions `away` (N, 3)."""
    first, second = in_plane(surface.axis)
    angle = np.sort(np.arctan2(away @ second, away @ first))
    return float(np.max(np.diff(np.append(angle, angle[0] + 2.0 * np.pi))))


def _follow(found: Association, at_mm: np.ndarray) -> np.ndarray:
    """Motion of a point of the associated feature with every distance, (3, N)."""
    arm = found.pose.undo(at_mm[None])[0] - found.about_mm
    cross = np.array([[0, arm[2], -arm[1]], [-arm[2], 0, arm[0]], [arm[1], -arm[0], 0]])
    return found.pose.turn @ (found.gain[:3] + cross @ found.gain[3:6])


def _axis_ends(found: Association, member: Member, nominal: np.ndarray) -> DerivedPoints:
    """Both ends of the associated axis, where the sections have no centres of their own."""
    surface = found.placed
    heights = member.surface.heights_mm(nominal)
    ends = np.array(
        [surface.point_mm + h * surface.axis for h in (float(heights.min()), float(heights.max()))]
    )
    # along the axis a point of it may lie anywhere
    flat = np.eye(3) - np.outer(surface.axis, surface.axis)
    gain = tuple(flat @ _follow(found, end) for end in ends)
    return DerivedPoints(ends, (member.rows, member.rows), gain)


def _centre(found: Association, member: Member) -> DerivedPoints:
    centre = found.placed.point_mm
    return DerivedPoints(centre[None], (member.rows,), (_follow(found, centre),))


def _median_plane(feature: Feature, points: Points) -> DerivedPoints:
    """Points in the middle between the least squares planes of both sides of a width."""
    one, other = (member.known(points) for member in feature.members)
    for member in (one, other):
        if len(member.rows) < 3:
            raise InputError(
                f"{len(member.rows)} points on one side of {feature.name!r}",
                accepted="at least 3 points that are cut",
            )
    normal = one.surface.axis
    first = associate(one.surface, points.actual_mm[one.rows])
    second = associate(other.surface, points.actual_mm[other.rows])
    both = np.concatenate([one.rows, other.rows])
    nominal = points.nominal_mm[both]
    feet = [_on_plane(found, nominal, normal) for found in (first, second)]
    middle = 0.5 * (feet[0] + feet[1])
    gain = []
    for foot_one, foot_other in zip(*feet, strict=True):
        lift = [
            0.5 * (_follow(found, foot).T @ found.placed.axis) / (found.placed.axis @ normal)
            for found, foot in ((first, foot_one), (second, foot_other))
        ]
        gain.append(np.outer(normal, np.concatenate(lift)))
    return DerivedPoints(middle, (both,) * len(middle), tuple(gain))


def _on_plane(found: Association, points: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Points (N, 3) moved along a direction on to an associated plane."""
    plane = found.placed
    return points - np.outer(plane.heights_mm(points) / (plane.axis @ along), along)
