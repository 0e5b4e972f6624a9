"""Orientation, location and profile: zones that stand in the frame of datums.

Source: ISO 1101, ISO 1660 (profile), ISO 5458 (patterns), ISO 5459 (datum systems).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vmach.errors import InputError
from vmach.features.association.associate import associate
from vmach.features.datum_system import DatumSystem
from vmach.features.derived import DerivedPoints, derived_points, section_rows
from vmach.features.drawing.callout import Callout
from vmach.features.feature import Feature, Member, Points
from vmach.features.measure import Measure, largest
from vmach.features.surface import Surface
from vmach.features.zone import across_axis, along, derived_zone, everywhere

__all__ = ["coaxiality", "line_profile", "location", "orientation", "profile", "runout"]

#: angles between nominal directions agree within this, rad
_SAME_RAD = 1e-6
#: axes are one within this, mm
_SAME_MM = 1e-3
_ANGLE = {"parallelism": 0.0, "perpendicularity": 0.5 * np.pi}


def orientation(
    feature: Feature, points: Points, callout: Callout, system: DatumSystem, primary: Feature
) -> Measure:
    """Parallelism, perpendicularity and angularity of planes and axes.

    Raises
    ------
    InputError
        The nominal angle to the primary datum contradicts the characteristic.
    """
    _check_angle(feature, callout, primary)
    basis = system.turned_only
    if feature.element == "plane":
        return largest(
            [_surface_zone(m.known(points), points, system, basis) for m in feature.members]
        )
    derived = derived_points(feature, points)
    return largest(
        [
            _zone_of(feature, callout, [part], [member], system, basis)
            for part, member in zip(derived, feature.members, strict=False)
        ]
    )


def _check_angle(feature: Feature, callout: Callout, primary: Feature) -> None:
    wanted = _ANGLE.get(callout.characteristic)
    own, datum = _direction(feature), _direction(primary)
    if own is None or datum is None:
        raise InputError(
            f"tolerance {callout.text!r}: {(feature if own is None else primary).name!r} has no "
            "direction",
            accepted="planes, cylinders, cones and widths",
        )
    # a plane's direction is its normal, which a plane has at right angles to what lies in it
    angle = np.arccos(min(abs(float(own[0] @ datum[0])), 1.0))
    if own[1] != datum[1]:
        angle = 0.5 * np.pi - angle
    if wanted is not None and abs(angle - wanted) > _SAME_RAD:
        raise InputError(
            f"tolerance {callout.text!r}: the CAD has an angle of {np.degrees(angle):.6g} deg "
            f"between {feature.name!r} and the datum",
            accepted=f"{np.degrees(wanted):g} deg with {callout.characteristic}",
            hint="angularity takes any angle",
        )


def _direction(feature: Feature) -> tuple[np.ndarray, bool] | None:
    """Normal of a plane or a width (and True), or direction of an axis (and False)."""
    surface = feature.members[0].surface
    if surface.kind == "plane":
        return surface.axis, True
    return (surface.axis, False) if surface.kind in ("cylinder", "cone", "torus") else None


def location(feature: Feature, points: Points, callout: Callout, system: DatumSystem) -> Measure:
    """Position and symmetry; the members of a pattern hold together.

    Raises
    ------
    InputError
        A position of one feature without a datum.
    """
    if callout.characteristic == "position" and not callout.datums and len(feature.members) < 2:
        raise InputError(
            f"tolerance {callout.text!r} of one feature without a datum",
            accepted="datums, or a pattern whose members are located by each other",
        )
    if feature.kind in ("plane", "free", "compound"):
        return _surface_zone(feature.pooled(points), points, system, system.free)
    derived = derived_points(feature, points)
    return _zone_of(feature, callout, derived, list(feature.members), system, system.free)


def coaxiality(
    feature: Feature, points: Points, callout: Callout, system: DatumSystem, datum: Feature
) -> Measure:
    """Diameter of the zone about the datum axis that holds the median line.

    Raises
    ------
    InputError
        The axes are not the same in the CAD.
    """
    own, other = feature.members[0].surface, datum.members[0].surface
    if not (own.has_axis and other.has_axis):
        raise InputError(f"tolerance {callout.text!r} of {feature.name!r}",
                         accepted="cylinders and cones about one axis")  # fmt: skip
    apart = float(own.radial(other.point_mm[None])[0][0])
    if abs(abs(own.axis @ other.axis) - 1.0) > _SAME_RAD or apart > _SAME_MM:
        raise InputError(
            f"tolerance {callout.text!r}: the axis of {feature.name!r} is {apart:.6g} mm beside "
            "that of the datum in the CAD",
            accepted="features about one axis",
            hint="position has any place",
        )
    derived = derived_points(feature, points)
    return _zone_of(feature, callout, derived, list(feature.members), system, system.free, "Ø")


def _zone_of(
    feature: Feature,
    callout: Callout,
    derived: list[DerivedPoints],
    members: list[Member],
    system: DatumSystem,
    basis: np.ndarray,
    zone: str | None = None,
) -> Measure:
    """Zone of derived points about the nominal places of their members."""
    nominal, projection = [], []
    for part, member in zip(derived, members, strict=False):
        count = len(part.points_mm)
        surface = member.surface
        seen = system.pose.undo(part.points_mm)
        if feature.kind == "width":
            sides = [m.surface for m in feature.members]
            nominal.append(np.broadcast_to((sides[0].point_mm + sides[1].point_mm) / 2, (count, 3)))
        else:
            nominal.append(_nominal_places(surface, seen))
        matrix = _projection(feature, callout, surface, callout.zone if zone is None else zone)
        projection.append(np.broadcast_to(matrix, (count, 3, 3)))
    pooled = derived[0]
    for part in derived[1:]:
        pooled = pooled + part
    return derived_zone(pooled, np.vstack(nominal), np.vstack(projection), system, basis)


def _nominal_places(surface: Surface, seen: np.ndarray) -> np.ndarray:
    if not surface.has_axis:
        return np.broadcast_to(surface.point_mm, seen.shape)
    return surface.point_mm + np.outer(surface.heights_mm(seen), surface.axis)


def _projection(feature: Feature, callout: Callout, surface: Surface, zone: str) -> np.ndarray:
    if feature.kind == "width":
        return along(surface.axis)
    if zone == "SØ" or (zone == "Ø" and surface.kind == "sphere"):
        return everywhere()
    if zone == "Ø":
        return across_axis(surface.axis)
    if callout.along:
        axis = np.eye(3)["XYZ".index(callout.along)]
        if surface.has_axis and abs(abs(axis @ surface.axis) - 1.0) < _SAME_RAD:
            raise InputError(
                f"tolerance {callout.text!r}: {callout.along} is the axis of {feature.name!r}",
                accepted="an axis across it",
            )
        return along(axis)
    raise InputError(
        f"tolerance {callout.text!r} of {feature.name!r}",
        accepted="Ø before the value (SØ for a centre), or 'along X', 'along Y', 'along Z'",
    )


def profile(feature: Feature, points: Points, system: DatumSystem) -> Measure:
    """Width of the zone that lies half on either side of the nominal surface."""
    return _surface_zone(feature.pooled(points), points, system, system.free)


def line_profile(feature: Feature, points: Points, callout: Callout, system: DatumSystem):
    """Profile of any line: sections across the axis, or across the axis that `along` names.

    Raises
    ------
    InputError
        A feature without an axis needs `along`.
    """
    member = feature.pooled(points)
    nominal = points.nominal_mm[member.rows]
    if callout.along:
        heights = nominal @ np.eye(3)["XYZ".index(callout.along)]
    elif getattr(member.surface, "has_axis", False):
        heights = member.surface.heights_mm(nominal)
    else:
        raise InputError(
            f"tolerance {callout.text!r} of {feature.name!r}",
            accepted="'along X', 'along Y' or 'along Z': the sections are across it",
        )
    found = []
    for rows in section_rows(heights):
        part = feature_part(feature, points, member, rows)
        found.append(_surface_zone(part, points, system, system.free))
    return largest(found)


def feature_part(feature: Feature, points: Points, member: Member, rows: np.ndarray) -> Member:
    """Some points of a feature, by their places in its pooled member, as one member."""
    wanted = member.rows[rows]
    kept = []
    for one in feature.members:
        known = one.known(points)
        chosen = np.isin(known.rows, wanted)
        kept.append(Member(known.surface.among(chosen), known.rows[chosen]))
    used = tuple(m for m in kept if len(m.rows))
    return Feature(feature.name, used).pooled(points)


def _surface_zone(
    member: Member, points: Points, system: DatumSystem, basis: np.ndarray
) -> Measure:
    """Symmetrical zone about the nominal surface, moved as the basis (6, F) allows."""
    found = associate(
        member.surface,
        points.actual_mm[member.rows],
        criterion="minimum zone",
        pose=system.pose,
        basis=basis,
        about_mm=system.about_mm,
        is_sized=False,
    )
    by_frame = -(found.weight @ found.rows[:, :6]) @ system.gain
    return Measure(
        found.value_mm,
        np.concatenate([member.rows, system.rows]),
        np.concatenate([found.weight, by_frame]),
    )


def runout(
    feature: Feature,
    points: Points,
    callout: Callout,
    system: DatumSystem,
    datums: Sequence[Feature],
) -> Measure:
    """Circular runout of sections, or total runout, about the axis of the datums or along it.

    Raises
    ------
    InputError
        The feature does not turn about the datum axis.
    """
    member = feature.pooled(points)
    surface = member.surface
    if surface.kind not in ("cylinder", "cone", "plane"):
        raise InputError(f"tolerance {callout.text!r} of a {feature.kind}",
                         accepted="a cylinder, a cone or a plane across the axis",
                         hint=feature.hint_on_kind)  # fmt: skip
    axis = _axis_of(datums, callout)
    _check_turns(surface, axis, feature, callout)
    seen = system.pose.undo(points.actual_mm[member.rows])
    nominal = points.nominal_mm[member.rows]
    distance, _, _ = surface.rows(seen)
    if callout.characteristic == "total runout":
        groups = [np.arange(len(distance))]
    elif surface.kind == "plane":
        groups = section_rows(axis.radial(nominal)[0])
    else:
        groups = section_rows(surface.heights_mm(nominal))
    return largest([_range_of(member, surface, system, seen, distance, rows) for rows in groups])


def _axis_of(datums: Sequence[Feature], callout: Callout) -> Surface:
    """The nominal surface whose axis the datums turn about.

    Raises
    ------
    InputError
        None of them has an axis.
    """
    surfaces = [member.surface for feature in datums for member in feature.members]
    found = next((one for one in surfaces if one.has_axis), None)
    if found is None:
        raise InputError(
            f"tolerance {callout.text!r}: no datum has an axis", accepted="a cylinder or a cone"
        )
    return found


def _check_turns(surface: Surface, axis: Surface, feature: Feature, callout: Callout) -> None:
    """Refuse what does not turn about an axis."""
    apart = 0.0 if surface.kind == "plane" else float(surface.radial(axis.point_mm[None])[0][0])
    if abs(abs(surface.axis @ axis.axis) - 1.0) > _SAME_RAD or apart > _SAME_MM:
        raise InputError(
            f"tolerance {callout.text!r}: {feature.name!r} does not turn about the axis of the "
            "datum in the CAD",
            accepted="surfaces about the axis, planes across it",
        )


def _range_of(member, surface, system, seen, distance, rows) -> Measure:
    from vmach.features.association.pose import motion_rows

    high, low = rows[distance[rows].argmax()], rows[distance[rows].argmin()]
    _, normals, _ = surface.rows(seen)
    table = motion_rows(seen, normals, system.about_mm)
    return Measure(
        float(distance[high] - distance[low]),
        np.r_[member.rows[[high, low]], system.rows],
        np.r_[1.0, -1.0, -(table[high] - table[low]) @ system.gain],
    )
