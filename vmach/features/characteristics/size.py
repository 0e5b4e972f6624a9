"""Sizes: two-point, least squares, maximum inscribed, minimum circumscribed; distances.

Source: ISO 14405-1 (linear sizes: LP, GG, GX, GN, envelope requirement).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vmach.errors import InputError
from vmach.features.association.associate import Association, associate
from vmach.features.derived import derived_points, in_plane, largest_gap_rad, section_rows
from vmach.features.drawing.callout import Callout, distance_to_itself
from vmach.features.feature import Feature, Member, Points
from vmach.features.measure import Measure

__all__ = ["distance", "size"]

#: a stated nominal size may be this far from that of the CAD, mm
_SAME_MM = 1e-3
#: two-point sizes need points all round: no gap wider than this
_WIDEST_GAP_RAD = 0.5 * np.pi
_CRITERION = {"GG": "least squares", "GX": "inscribed", "GN": "circumscribed"}


def size(feature: Feature, points: Points, callout: Callout) -> list[Measure]:
    """Size of a cylinder, a sphere or a width; smallest and largest where it is local.

    A pattern gives the smallest and the largest of its members.

    Raises
    ------
    InputError
        The feature has no size, or another nominal one than the callout.
    """
    if feature.kind == "width":
        return _width(feature, points, callout)
    if feature.element not in ("cylinder", "sphere"):
        raise InputError(
            f"{feature.name!r} is a {feature.kind}, which has no size",
            accepted="a cylinder, a sphere, a pattern of them, or two opposite planes",
            hint=feature.hint_on_kind,
        )
    factor = 1.0 if callout.is_radius else 2.0
    _check_nominal(feature, callout, factor * feature.members[0].surface.radius_mm)
    found = [m for member in feature.members
             for m in _round(member.known(points), points, callout, factor)]  # fmt: skip
    return _extremes(found)


def _extremes(found: list[Measure]) -> list[Measure]:
    if len(found) == 1:
        return found
    low, high = (pick(found, key=lambda m: m.value_mm) for pick in (min, max))
    return [replace(low, label="smallest"), replace(high, label="largest")]


def _check_nominal(feature: Feature, callout: Callout, has_mm: float) -> None:
    if abs(has_mm - callout.nominal_mm) > max(_SAME_MM, 10.0 * callout.tolerance_mm):
        what = "distance" if callout.to else "size"
        raise InputError(
            f"tolerance {callout.text!r} of {feature.name!r}, which is {has_mm:.6g} mm in the CAD",
            accepted=f"the nominal {what} of the CAD",
            hint=None if callout.to else "Ø or nothing means the diameter, R the radius",
        )


def _round(member: Member, points: Points, callout: Callout, factor: float) -> list[Measure]:
    actual, nominal = (places[member.rows] for places in (points.actual_mm, points.nominal_mm))
    fitted = associate(member.surface, actual)
    modifier = callout.modifier
    is_hole = member.surface.sign < 0.0
    if modifier == "E":
        contact = _contact(member, actual, "inscribed" if is_hole else "circumscribed")
        local = _local(member, fitted, actual, nominal) or [_gauss(member, fitted)]
        far = (max if is_hole else min)(local, key=lambda m: m.value_mm)
        return [contact.scaled(factor), far.scaled(factor)]
    if modifier in ("GX", "GN"):
        return [_contact(member, actual, _CRITERION[modifier]).scaled(factor)]
    least_squares = _gauss(member, fitted)
    if modifier != "LP":
        return [least_squares.scaled(factor)]
    # without full sections, and of a ball, another size than the one that was asked for
    local = _local(member, fitted, actual, nominal)
    return [m.scaled(factor) for m in local or [replace(least_squares, label="least squares")]]


def _gauss(member: Member, fitted: Association) -> Measure:
    """Least squares radius."""
    return Measure(fitted.surface.radius_mm, member.rows, fitted.gain[6])


def _contact(member: Member, actual: np.ndarray, criterion: str) -> Measure:
    found = associate(member.surface, actual, criterion=criterion)
    # a distance counts outward from the material; the radius follows it on a shaft
    return Measure(found.value_mm, member.rows, found.weight)


def _local(
    member: Member, fitted: Association, actual: np.ndarray, nominal: np.ndarray
) -> list[Measure]:
    """Half of the smallest and of the largest two-point size; none without full sections.

    Points are of one section where the nominal ones, (N, 3) mm, are: the axis that was found leans.
    """
    if member.surface.kind != "cylinder":
        return []
    surface = fitted.placed
    found = []
    for rows in section_rows(member.surface.heights_mm(nominal)):
        _, away = surface.radial(actual[rows])
        if len(rows) >= 4 and largest_gap_rad(surface, away) < _WIDEST_GAP_RAD:
            found += _section_sizes(surface, actual[rows], member.rows[rows])
    if not found:
        return []
    return [min(found, key=lambda m: m.value_mm), max(found, key=lambda m: m.value_mm)]


def _section_sizes(surface, actual: np.ndarray, rows: np.ndarray) -> list[Measure]:
    """Smallest and largest half chord through the centre of a section's least squares circle."""
    radius, away = surface.radial(actual)
    axes = in_plane(surface.axis)
    plane = away @ axes.T
    offset = np.linalg.lstsq(np.column_stack([plane, np.ones(len(rows))]), radius, rcond=None)[0]
    flat = radius[:, None] * plane - offset[:2]
    radius, angle = np.hypot(*flat.T), np.arctan2(flat[:, 1], flat[:, 0])
    order = np.argsort(angle)
    radius, angle, rows = radius[order], angle[order], rows[order]
    after = np.searchsorted(angle, _half_turn(angle)) % len(angle)
    before = after - 1
    step = np.mod(angle[after] - angle[before], 2.0 * np.pi)
    share = np.mod(_half_turn(angle) - angle[before], 2.0 * np.pi) / np.maximum(step, 1e-300)
    half = 0.5 * (radius + (1.0 - share) * radius[before] + share * radius[after])
    return [
        Measure(
            float(half[k]),
            rows[[k, before[k], after[k]]],
            0.5 * surface.sign * np.array([1.0, 1.0 - share[k], share[k]]),
        )
        for k in (int(half.argmin()), int(half.argmax()))
    ]


def _half_turn(angle: np.ndarray) -> np.ndarray:
    """The opposite angle, from -pi to pi."""
    return np.where(angle > 0.0, angle - np.pi, angle + np.pi)


def _width(feature: Feature, points: Points, callout: Callout) -> list[Measure]:
    """Two-point or least squares distance of two opposite planes."""
    one, other = (member.known(points) for member in feature.members)
    for member in (one, other):
        if not len(member.rows):
            raise InputError(f"one side of {feature.name!r} was not cut",
                             accepted="points on both sides")  # fmt: skip
    normal = one.surface.axis
    nominal = float((one.surface.point_mm - other.surface.point_mm) @ normal)
    _check_nominal(feature, callout, abs(nominal))
    sign = 1.0 if nominal > 0.0 else -1.0
    if callout.modifier == "GG":
        middle = [points.nominal_mm[m.rows].mean(axis=0) for m in (one, other)]
        return [_between(one, other, points, sign, (middle[0] + middle[1]) / 2.0)]
    if callout.modifier != "LP":
        raise InputError(f"{callout.modifier} size of two planes", accepted="LP or GG")
    from scipy.spatial import cKDTree  # late: commands without features do not wait for it

    flat = np.eye(3) - np.outer(normal, normal)
    near, partner = cKDTree(points.nominal_mm[other.rows] @ flat).query(
        points.nominal_mm[one.rows] @ flat
    )
    facing = near <= max(4.0 * float(np.median(near)), 1e-9)
    total = points.deviation_mm[one.rows] + points.deviation_mm[other.rows[partner]]
    total = np.where(facing, total, np.nan)
    chosen = (int(np.nanargmin(sign * total)), int(np.nanargmax(sign * total)))
    found = [
        Measure(
            abs(nominal) + sign * float(total[k]),
            np.array([one.rows[k], other.rows[partner[k]]]),
            np.full(2, sign),
        )
        for k in chosen
    ]
    return _extremes(found)


def _between(one: Member, other: Member, points: Points, sign: float, at: np.ndarray) -> Measure:
    """Distance of two least squares planes along the nominal normal at a place."""
    normal, value, rows, weight = one.surface.axis, 0.0, [], []
    for member, side in ((one, 1.0), (other, -1.0)):
        found = associate(member.surface, points.actual_mm[member.rows])
        plane = found.placed
        value += side * float((plane.point_mm - at) @ plane.axis / (plane.axis @ normal))
        arm = at - found.about_mm
        lift = member.surface.axis @ found.gain[:3]
        lift = lift + np.cross(arm, member.surface.axis) @ found.gain[3:6]
        rows.append(member.rows)
        weight.append(side * float(member.surface.axis @ normal) * lift)
    return Measure(sign * value, np.concatenate(rows), sign * np.concatenate(weight))


def distance(feature: Feature, other: Feature, points: Points, callout: Callout) -> list[Measure]:
    """Distance of two features: parallel planes, axes, centres, or an axis from a plane.

    Raises
    ------
    InputError
        They are one feature, are not parallel, or have another nominal distance.
    """
    own = _points_of(feature)
    if own and own == _points_of(other):
        raise distance_to_itself(callout, feature.name)
    ends = [_reference(f, points) for f in (feature, other)]
    normals = [end[2] for end in ends if end[2] is not None]
    nominal = ends[1][1] - ends[0][1]
    if normals:
        if len(normals) == 2 and np.linalg.norm(np.cross(*normals)) > 1e-6:
            raise InputError(
                f"{feature.name!r} and {other.name!r} are not parallel",
                accepted="a distance between parallel planes",
            )
        direction = normals[0] * (np.sign(nominal @ normals[0]) or 1.0)
    else:
        axes = [end[3] for end in ends if end[3] is not None]
        for axis in axes:
            nominal = nominal - (nominal @ axis) * axis
        direction = nominal / (np.linalg.norm(nominal) or 1.0)
    _check_nominal(feature, callout, float(nominal @ direction))
    value, rows, weight = 0.0, [], []
    for sign, (actual, _, _, _, own, gain) in zip((-1.0, 1.0), ends, strict=True):
        value += sign * float(actual @ direction)
        rows.append(own)
        weight.append(sign * direction @ gain)
    return [Measure(value, np.concatenate(rows), np.concatenate(weight))]


def _points_of(feature: Feature) -> set[int]:
    """Indices of all points of a feature."""
    return {row for member in feature.members for row in member.rows.tolist()}


def _reference(feature: Feature, points: Points):
    """Middle point: actual and nominal; normal of a plane; axis; rows and gain (3, N)."""
    if feature.kind == "plane":
        member = feature.members[0].known(points)
        found = associate(member.surface, points.actual_mm[member.rows])
        middle = points.nominal_mm[member.rows].mean(axis=0)
        normal = member.surface.axis
        plane = found.placed
        actual = middle + normal * ((plane.point_mm - middle) @ plane.axis / (plane.axis @ normal))
        lift = normal @ found.gain[:3] + np.cross(middle - found.about_mm, normal) @ found.gain[3:6]
        return actual, middle, normal, None, member.rows, np.outer(normal, lift)
    derived = derived_points(feature, points)
    if len(derived) != 1:
        raise InputError(f"{feature.name!r} is a pattern", accepted="one member of it")
    only, surface = derived[0], feature.members[0].surface
    share = 1.0 / len(only.points_mm)
    rows = np.concatenate(only.rows)
    gain = np.hstack([share * g for g in only.gain])
    actual = only.points_mm.mean(axis=0)
    if feature.kind == "width":
        one, two = (member.surface for member in feature.members)
        nominal = actual + one.axis * (((one.point_mm + two.point_mm) / 2 - actual) @ one.axis)
        return actual, nominal, one.axis, None, rows, gain
    axis = surface.axis if surface.has_axis else None
    nominal = surface.point_mm
    if axis is not None:
        nominal = nominal + axis * ((actual - nominal) @ axis)
    return actual, nominal, None, axis, rows, gain
