"""Form: straightness, flatness, roundness, cylindricity, as minimum zones.

Source: ISO 1101; ISO 12780-1, ISO 12781-1, ISO 12181-1, ISO 12180-1 (minimum zone references).
"""

from __future__ import annotations

import numpy as np

from vmach.errors import InputError
from vmach.features.association.associate import associate
from vmach.features.association.linear_program import least_width
from vmach.features.datum_system import DatumSystem
from vmach.features.derived import derived_points, in_plane, largest_gap_rad, section_rows
from vmach.features.drawing.callout import Callout
from vmach.features.feature import Feature, Member, Points
from vmach.features.measure import Measure, largest
from vmach.features.zone import across_axis, derived_zone

__all__ = ["cylindricity", "flatness", "roundness", "straightness"]

#: lines of a plane are taken from points whose places across differ by less than this, mm
_LINE_MM = 1e-3
#: of a width, relative
_ROUNDING = 1e-9


def flatness(feature: Feature, points: Points, callout: Callout) -> Measure:
    """Width of the zone between two parallel planes, the largest of a pattern's members."""
    return _minimum_zone(feature, points, callout, "plane")


def cylindricity(feature: Feature, points: Points, callout: Callout) -> Measure:
    """Difference of the radii of two coaxial cylinders."""
    return _minimum_zone(feature, points, callout, "cylinder")


def _minimum_zone(feature: Feature, points: Points, callout: Callout, kind: str) -> Measure:
    _check_kind(feature, callout, (kind,))
    found = []
    for member in _members(feature, points):
        zone = associate(member.surface, points.actual_mm[member.rows], criterion="minimum zone")
        found.append(Measure(zone.value_mm, member.rows, zone.weight))
    return largest(found)


def _check_kind(feature: Feature, callout: Callout, kinds: tuple[str, ...]) -> None:
    seen = {member.surface.kind for member in feature.members}
    if not seen <= set(kinds):
        raise InputError(
            f"tolerance {callout.text!r} of {feature.name!r}, which is a {feature.kind}",
            accepted=f"{callout.characteristic} of: {', '.join(kinds)}",
            hint=feature.hint_on_kind,
        )


def _members(feature: Feature, points: Points) -> list[Member]:
    known = [member.known(points) for member in feature.members]
    kept = [member for member in known if len(member.rows)]
    if not kept:
        feature.pooled(points)  # raises
    return kept


def roundness(feature: Feature, points: Points, callout: Callout) -> Measure:
    """Difference of the radii of two concentric circles, the largest of all sections.

    Raises
    ------
    InputError
        The feature is no cylinder or cone, or no section has points all round.
    """
    _check_kind(feature, callout, ("cylinder", "cone"))
    found = []
    for member in _members(feature, points):
        actual = points.actual_mm[member.rows]
        surface = associate(member.surface, actual).placed
        for rows in section_rows(member.surface.heights_mm(points.nominal_mm[member.rows])):
            if len(rows) >= 4 and largest_gap_rad(surface, surface.radial(actual[rows])[1]) < np.pi:
                found.append(_circle_zone(surface, actual[rows], member.rows[rows]))
    if not found:
        raise InputError(
            f"no section of {feature.name!r} has points all round", accepted="4 or more a section",
            hint="[inspection] spacing_mm may be too large, or the face is not a full turn",
        )  # fmt: skip
    return largest(found)


def _circle_zone(surface, actual: np.ndarray, rows: np.ndarray) -> Measure:
    """Minimum zone circle of one section, by linear programs from the axis on."""
    flat = (actual - surface.point_mm) @ in_plane(surface.axis).T
    centre = np.zeros(2)
    for _ in range(20):
        arm = flat - centre
        radius = np.hypot(*arm.T)
        unit = arm / radius[:, None]
        step, width, weight = least_width(radius - radius.mean(), unit)
        centre = centre + step
        if np.abs(step).max() < 1e-12:
            break
    return Measure(width, rows, surface.sign * weight)


def straightness(feature: Feature, points: Points, callout: Callout) -> Measure:
    """Straightness of a plane's lines, or with Ø of the median line of a cylinder or cone.

    Raises
    ------
    InputError
        The feature is of another kind, or no line has three points.
    """
    if callout.zone:
        if feature.element not in ("cylinder", "cone"):
            raise InputError(
                f"tolerance {callout.text!r} of {feature.name!r}, which is a {feature.kind}",
                accepted="Ø for the median line of a cylinder or a cone",
                hint=feature.hint_on_kind,
            )
        return largest([_of_axis(member, points, feature) for member in feature.members])
    _check_kind(feature, callout, ("plane",))
    found = [m for member in _members(feature, points)
             for m in _plane_lines(member, points, callout)]  # fmt: skip
    if not found:
        raise InputError(f"no line of {feature.name!r} has three points",
                         accepted="[inspection] with a smaller spacing_mm")  # fmt: skip
    return largest(found)


def _of_axis(member: Member, points: Points, feature: Feature) -> Measure:
    one = Feature(feature.name, (member,))
    derived = derived_points(one, points)[0]
    count = len(derived.points_mm)
    system = DatumSystem(about_mm=derived.points_mm.mean(axis=0))
    nominal = np.broadcast_to(member.surface.point_mm, (count, 3))
    flat = np.broadcast_to(across_axis(member.surface.axis), (count, 3, 3))
    return derived_zone(derived, nominal, flat, system, np.eye(6))


def _plane_lines(member: Member, points: Points, callout: Callout) -> list[Measure]:
    """Lines of a plane, but for those that are straighter than another for sure."""
    nominal = points.nominal_mm[member.rows]
    direction = _line_direction(member, nominal, callout)
    across = np.cross(member.surface.axis, direction)
    place, height = nominal @ across, member.surface.distance_mm(points.actual_mm[member.rows])
    order = np.argsort(place, kind="stable")
    lines = np.split(order, np.flatnonzero(np.diff(place[order]) > _LINE_MM) + 1)
    lines = [rows for rows in lines if len(rows) >= 3]
    along = nominal @ direction
    most = np.array([_width_about_line(along[rows], height[rows]) for rows in lines])
    found: dict[int, Measure] = {}
    widest_mm = 0.0
    for k in np.argsort(-most, kind="stable").tolist():
        if most[k] < widest_mm:
            break
        rows = lines[k]
        length = along[rows, None]
        _, width, weight = least_width(height[rows], length - length.mean())
        found[k] = Measure(width, member.rows[rows], weight)
        widest_mm = max(widest_mm, width)
    return [found[k] for k in sorted(found)]


def _width_about_line(length: np.ndarray, height: np.ndarray) -> float:
    """Width about the least squares line, (N,) mm each: no zone between parallels needs more."""
    length = length - length.mean()
    square = float(length @ length)
    slope = float(length @ height) / square if square > 0.0 else 0.0
    return float(np.ptp(height - slope * length)) * (1.0 + _ROUNDING)


def _line_direction(member: Member, nominal: np.ndarray, callout: Callout) -> np.ndarray:
    """Direction of the lines within the plane: as asked, else along the plane's greatest extent."""
    normal = member.surface.axis
    if callout.along:
        axis = np.eye(3)["XYZ".index(callout.along)]
        axis = axis - (axis @ normal) * normal
        if np.linalg.norm(axis) < 1e-6:
            raise InputError(
                f"tolerance {callout.text!r}: the plane is normal to {callout.along}",
                accepted="an axis that lies in the plane",
            )
        return axis / np.linalg.norm(axis)
    # the rows that points are sampled in run along a coordinate axis or the plane's edges
    flat = nominal - nominal.mean(axis=0)
    frame = in_plane(normal)
    turns = np.linspace(0.0, np.pi, 180, endpoint=False)
    ways = np.cos(turns)[:, None] * frame[0] + np.sin(turns)[:, None] * frame[1]
    best = ways[np.argmax(np.ptp(flat @ ways.T, axis=0))]
    edges = [axis for axis in (*np.eye(3), *_sampled(flat, normal)) if abs(axis @ normal) < 1e-6]
    return max(edges, key=lambda axis: abs(axis @ best)) if edges else best


def _sampled(flat: np.ndarray, normal: np.ndarray) -> list[np.ndarray]:
    """Direction from a point to the next one, which is that of a row, and the one across it."""
    if len(flat) < 2:
        return []
    row = flat[1] - flat[0]
    row = row - (row @ normal) * normal
    size = np.linalg.norm(row)
    return [row / size, np.cross(normal, row / size)] if size > 0.0 else []
