"""Are measured points those of this part, in mm, in the coordinates of its program?

Source: JCGM 100:2008 (GUM), 4.3.7: rounding to a step s has the standard uncertainty s / sqrt(12).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from gcode import MoveKind
from vmach.base.note import Kind, Note
from vmach.base.units import um_from_mm
from vmach.errors import InputError
from vmach.machine import Variant
from vmach.measurements.measurement import Measurement
from vmach.measurements.plausibility.tool_alternatives import tool_that_would_cut
from vmach.measurements.plausibility.wrong_frame import motion_in_words, wrong_frame
from vmach.nominal.points import COORDINATE_UNITS, SurfacePoints
from vmach.nominal.seat import Seat, motion_beside_odd_ones
from vmach.path.preparation import Preparation
from vmach.prediction import predict_surface

__all__ = [
    "EXPLAINED_MM",
    "FEW",
    "FINEST_MM",
    "MANY_UNCUT",
    "astray",
    "beside_notes",
    "beside_pose_mm",
    "check_aligned",
    "check_astray",
    "check_cut",
    "check_file",
    "check_near",
    "check_unit_of_points",
    "rounding_mm",
    "rounding_notes",
    "some_of",
]

#: an alignment alone takes six points
_FEWEST = 12
#: share of the points that the program has to cut; with fewer it is another part's program
_MOST_OF_THEM = 0.5
#: a measured part whose points lie further away than this (median) is another part, or has
#: another zero; a single point this far beside the others is no measurement of the surface
_OTHER_PART_MM = 0.5
#: a probe touches within some tenths of the place that it is sent to
_BESIDE_MM = 1.0
#: a motion that leaves points this near (median, mm) is what was done to them; so is a wrong tool
#: or work offset that leaves all but odd ones so. Chosen: no machine of this kind errs by more
EXPLAINED_MM = 0.1
#: share of the readings up to which odd ones are chips under the probe; more have a cause
FEW = 0.05
#: share of points that no move cut from which on a wrong zero or unit is as likely as odd points
MANY_UNCUT = 0.1
#: share of the points that the program cuts where their unit is the right one
_NEARLY_ALL = 0.95
#: median distance from the prediction, alignment taken off, that no machine of this kind has
_FAR_MM = 0.25
#: no CMM is finer, and none that is of use is coarser
FINEST_MM, _COARSEST_MM = 0.02e-3, 0.1
#: coordinates this near to rounded ones are rounded
_NO_DIGIT_MM = 1e-9
#: points on which a guess at what is wrong is tried
_TRIED = 60


def check_file(points: SurfacePoints, path: Path) -> None:
    """Refuse what the file alone shows to be wrong.

    Raises
    ------
    InputError
        No measured points, too few of them, in another unit than the nominal ones, or an
        uncertainty that is not in um.
    """
    if points.measured_mm is None:
        raise InputError(
            f"none of the {len(points)} points has a measured place",
            file=path,
            accepted="columns mx, my, mz, in mm",
        )
    if len(points) < _FEWEST:
        raise InputError(
            f"{len(points)} measured points",
            file=path,
            accepted=f"{_FEWEST} or more",
            hint="the alignment of the part alone takes six numbers from them",
        )
    if points.u_mm is not None and not FINEST_MM <= np.median(points.u_mm) <= _COARSEST_MM:
        unit = "mm" if np.median(points.u_mm) < FINEST_MM else "nm"
        raise InputError(
            f"u_um is {um_from_mm(np.median(points.u_mm)):.4g} um (median)",
            file=path,
            accepted=f"{um_from_mm(FINEST_MM):g} to {um_from_mm(_COARSEST_MM):g} um",
            hint=f"is the column in {unit}? It has to be in um",
        )
    for note in points.notes:
        if note.kind is Kind.UNIT:
            accepted = "all coordinates in mm"
            raise InputError(note.sentence, file=path, accepted=accepted, note=note)


def check_cut(preparation: Preparation, points: SurfacePoints, count: int, *, path: Path) -> None:
    """Refuse points of which the program cuts only a few.

    Parameters
    ----------
    preparation : Preparation
    points : SurfacePoints
    count : int
        How many of them the program cuts.
    path : Path
        The file.

    Raises
    ------
    InputError
        With what would make the program cut them, if that is found.
    """
    if count >= max(_FEWEST, _MOST_OF_THEM * len(points)):
        return
    few = some_of(points, np.arange(len(points)))
    hints = (
        hint
        for hint, guess in _guesses(few, preparation)
        if np.mean(predict_surface(preparation, guess, Variant.NONE).is_cut) >= _MOST_OF_THEM
    )
    raise InputError(
        f"the program cuts {count} of the {len(points)} measured points",
        file=path,
        accepted=f"at least {_MOST_OF_THEM:.0%}, and no fewer than {_FEWEST}, of the points",
        hint=next(hints, None)
        or tool_that_would_cut(preparation, few)
        or "are the points in workpiece coordinates, and is this the part's program?",
    )


def check_unit_of_points(
    preparation: Preparation, points: SurfacePoints, is_cut: np.ndarray, path: Path
) -> tuple[Note, ...]:
    """Refuse points that the program cuts in another unit, and in mm not.

    A zero in a corner of the part keeps its faces where they are, whatever the unit.

    Parameters
    ----------
    preparation : Preparation
    points : SurfacePoints
    is_cut : (P,) bool
        Which of them the program cuts.
    path : Path
        The file.

    Returns
    -------
    tuple of Note
        A question, where the program cuts nearly all of them in mm as well.

    Raises
    ------
    InputError
        With the first point that is not cut.
    """
    unit = _unit_that_is_cut(preparation, points)
    if unit is None:
        return ()
    uncut = np.flatnonzero(~is_cut)
    size = " x ".join(f"{length:.3g}" for length in np.ptp(points.point_mm, axis=0))
    if len(uncut) <= MANY_UNCUT * len(points):
        said = f"the points span {size} mm, and the program would cut them in {unit} too: is it mm?"
        return (Note.question(Kind.UNIT, said, place="x y z", file=path.name),)
    first = int(uncut[0])
    place = ", ".join(f"{value:.5g}" for value in points.point_mm[first])
    raise InputError(
        f"the points span {size} mm, and the program does not cut {len(uncut)} of the "
        f"{len(points)}, the first at x, y, z = {place}",
        file=path,
        line=None if points.line is None else int(points.line[first]),
        accepted="coordinates in mm, on surfaces that the program cuts",
        hint=f"the coordinates look like {unit}, in which it cuts them; they have to be in mm",
    )


def _unit_that_is_cut(preparation: Preparation, points: SurfacePoints) -> str | None:
    """The unit, longer than mm, in which the program cuts nearly all points; None without one."""
    few = some_of(points, np.arange(len(points)))
    for unit, length in COORDINATE_UNITS.items():
        if length > 1.0:  # shrunk to the zero, faces through it are cut in any case
            continue
        guess = SurfacePoints(few.id, few.feature, few.point_mm / length, few.normal)
        if not _is_within_reach(preparation, guess.point_mm):
            continue
        if np.mean(predict_surface(preparation, guess, Variant.NONE).is_cut) >= _NEARLY_ALL:
            return unit
    return None


def _is_within_reach(preparation: Preparation, points_mm: np.ndarray) -> bool:
    """Whether points (P, 3) mm lie where the program's tools cut at all; seen from afar."""
    moves, tools = preparation.program.moves, preparation.job.tools
    cutting = np.flatnonzero((moves.kind != MoveKind.RAPID) & (moves.tool > 0))
    if not len(cutting):
        return False
    is_arc = moves.kind[cutting] == MoveKind.ARC
    radius = np.linalg.norm((moves.start_mm - moves.centre_mm)[cutting[is_arc]], axis=1)
    slack = radius.max(initial=0.0) + max(tool.diameter_mm for tool in tools.values())
    longest = max(tool.length_mm for tool in tools.values())
    ends = np.vstack([moves.start_mm[cutting], moves.end_mm[cutting]]) - preparation.zero_mm
    low, high = ends.min(axis=0) - slack, ends.max(axis=0) + slack
    low[2] -= longest
    return bool(((points_mm >= low) & (points_mm <= high)).all())


def _no_cause() -> None:
    """Nothing that explains a part that lies far off."""


def check_aligned(
    points: SurfacePoints, seat: Seat, path: Path, cause: Callable[[], str | None] = _no_cause
) -> None:
    """Refuse measured points that lie nowhere near the nominal ones, or have another zero.

    Parameters
    ----------
    points : SurfacePoints
    seat : Seat
        The motion that brings the nominal points to the measured ones.
    path : Path
        The file.
    cause : callable
        Which tool or work offset explains it, if one does.

    Raises
    ------
    InputError
        With the shift, turn or exchange of columns that would bring them there, if there is one.
    """
    assert points.measured_mm is not None
    away = np.linalg.norm(points.measured_mm - points.point_mm, axis=1)
    apart = float(np.median(away))
    is_far = np.median(np.minimum(away, np.abs(points.measured_deviation_mm))) > _OTHER_PART_MM
    why = None
    if apart > _OTHER_PART_MM and not _is_on_normals(points):
        why = wrong_frame(points.point_mm, points.measured_mm)
    if why is None and _is_elsewhere(points, seat):
        apart = seat.size_mm(points)
        why = motion_in_words(seat.rotation, seat.shift_of_zero_mm)
    if not is_far and why is None:
        return
    raise InputError(
        f"the measured points are {apart:.4g} mm from the nominal ones (median)",
        file=path,
        accepted=f"measured points within {_OTHER_PART_MM} mm of the nominal surface",
        hint=cause() or why or "is this the measurement of this part, aligned to its datums?",
    )


def _is_on_normals(points: SurfacePoints) -> bool:
    """Whether most measured points lie on the normals of the nominal ones: none tells its place."""
    return bool(np.median(_beside_normals_mm(points)) <= EXPLAINED_MM)


def _is_elsewhere(points: SurfacePoints, seat: Seat) -> bool:
    """Whether a large motion of the part is what keeps most of the points away."""
    is_explained = np.median(np.abs(_beside(points, seat))) <= EXPLAINED_MM
    return bool(is_explained) and seat.size_mm(points) > _OTHER_PART_MM


def _beside(points: SurfacePoints, seat: Seat) -> np.ndarray:
    """Deviation of measured points with the motion taken back, (P,) mm."""
    assert points.measured_mm is not None
    apart = seat.taken_back(points.measured_mm) - points.point_mm
    return np.einsum("ij,ij->i", apart, points.normal)


def astray(deviation_mm: np.ndarray) -> np.ndarray:
    """Which deviations, the pose of the part taken off, are none of the surface, (P,) bool."""
    return np.abs(deviation_mm) >= _OTHER_PART_MM


def check_astray(points: SurfacePoints, path: Path, cause: Callable[[], str | None]) -> None:
    """Refuse a file where more than a few points lie astray, the part's pose taken off.

    Raises
    ------
    InputError
        With the first of them.
    """
    rows = np.flatnonzero(astray(points.measured_deviation_mm))
    if len(rows) <= FEW * len(points):
        return
    first = int(rows[0])
    raise InputError(
        f"{len(rows)} of the {len(points)} measured points that the program cuts lie further from "
        f"the nominal surface than {_OTHER_PART_MM} mm, the pose of the part taken off; the first "
        f"is point {points.id[first]} with {points.measured_deviation_mm[first]:.4g} mm",
        file=path,
        line=None if points.line is None else int(points.line[first]),
        accepted=f"{FEW:.0%} of them at most, which are then left out",
        hint=cause()
        or "do x, y, z and mx, my, mz of a row belong together, and is this the finished part?",
    )


def rounding_mm(points: SurfacePoints) -> float:
    """Step that all measured coordinates are rounded to, mm; 0 where they have more digits."""
    assert points.measured_mm is not None
    for digits in (0, 1, 2, 3):
        rounded = np.round(points.measured_mm, digits)
        if np.abs(points.measured_mm - rounded).max() <= _NO_DIGIT_MM:
            return 10.0**-digits
    return 0.0


def rounding_notes(points: SurfacePoints) -> tuple[Note, ...]:
    """A note where measured coordinates are rounded more coarsely than their uncertainty allows."""
    if points.u_mm is None:
        return ()
    step_mm, u_mm = rounding_mm(points), float(np.median(points.u_mm))
    if step_mm / np.sqrt(12.0) < u_mm:
        return ()
    said = (
        f"mx, my, mz are rounded to {step_mm:g} mm, u_um says {um_from_mm(u_mm):.2g} um "
        "(median): export them with more digits"
    )
    return (Note.question(Kind.ROUNDING, said, step_mm, "mm", place="mx my mz"),)


def check_near(part: Measurement, path: Path, cause: Callable[[], str | None]) -> None:
    """Refuse points that fit the program's surfaces by chance only.

    Raises
    ------
    InputError
        They lie further from the prediction than a machine ever errs.
    """
    residual = part.measured_mm - part.predicted_mm
    pose = np.linalg.lstsq(part.nuisance, residual, rcond=None)[0]
    away = float(np.median(np.abs(residual - part.nuisance @ pose)))
    if away > _FAR_MM:
        raise InputError(
            f"the measured part is {away:.2g} mm from the predicted one (median, aligned)",
            file=path,
            accepted=f"within {_FAR_MM} mm",
            hint=cause() or "is this the measurement of the part that this program makes?",
        )


def beside_pose_mm(part: Measurement) -> np.ndarray:
    """Measured minus predicted, (P,) mm, without the pose that most readings agree on.

    In each clamping that has readings enough the part has a pose of its own.
    """
    assert part.surface is not None
    residual = part.measured_mm - part.predicted_mm
    arm_mm = part.surface.points_mm - part.surface.points_mm.mean(axis=0)
    moved = np.hstack([part.sensing, np.cross(arm_mm, part.sensing)])
    rows = [np.full(len(part), True)]
    if part.clamping is not None:
        rows += [part.clamping == name for name in np.unique(part.clamping)]
    for own in rows:
        if np.count_nonzero(own) >= _FEWEST:
            motion = motion_beside_odd_ones(arm_mm[own], part.sensing[own], residual[own])
            residual[own] -= moved[own] @ motion
    return residual


def beside_notes(points: SurfacePoints) -> tuple[Note, ...]:
    """A question where measured points lie beside the nominal ones, along the surface.

    Their deviations along the normal may look right, and be those of another place.
    """
    beside = _beside_normals_mm(points)
    rows = np.flatnonzero(beside > _BESIDE_MM)
    if not len(rows):
        return ()
    said = (
        f"{len(rows)} of {len(points)} measured points lie more than {_BESIDE_MM:g} mm beside the "
        f"nominal ones, along the surface, {beside.max():.3g} mm at most, the first is "
        f"{points.id[rows[0]]}: do x, y, z and mx, my, mz of a row belong together?"
    )
    return (Note.question(Kind.FAR, said, float(beside.max()), "mm", place="mx my mz"),)


def _beside_normals_mm(points: SurfacePoints) -> np.ndarray:
    """How far measured points lie from the normals of the nominal ones, (P,) mm."""
    assert points.measured_mm is not None
    along = points.measured_deviation_mm[:, None] * points.normal
    return np.linalg.norm(points.measured_mm - points.point_mm - along, axis=1)


def some_of(points: SurfacePoints, rows: np.ndarray) -> SurfacePoints:
    """Nominal places of a few of the points with indices `rows` (R,), from all over them."""
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, _TRIED).astype(int))]
    return SurfacePoints(
        points.id[rows], points.feature[rows], points.point_mm[rows], points.normal[rows]
    )


def _guesses(
    points: SurfacePoints, preparation: Preparation
) -> Iterator[tuple[str, SurfacePoints]]:
    """What may be wrong with points, and the points with it put right."""

    def put(point_mm: np.ndarray, normal: np.ndarray) -> SurfacePoints:
        return SurfacePoints(points.id, points.feature, point_mm, normal)

    point, normal = points.point_mm, points.normal
    yield (
        "the program would cut them if i, j, k were turned round: they have to point out of the "
        "material",
        put(point, -normal),
    )
    for unit, length in COORDINATE_UNITS.items():
        hint = f"the coordinates look like {unit}; they have to be in mm"
        yield hint, put(point / length, normal)
    for name, zero in preparation.job.work_offsets_mm.items():
        hint = f"they look like machine coordinates: take off the zero of the part, {name}"
        yield hint, put(point - zero, normal)
    middles = [0.5 * (point.min(axis=0) + point.max(axis=0)), np.zeros(3)]
    if (blank := preparation.job.blank) is not None:
        middles.append(0.5 * (blank.min_mm + blank.max_mm))
    for (axis, name), middle in itertools.product(enumerate("xyz"), middles):
        over = np.where(np.arange(3) == axis, -1.0, 1.0)
        hint = f"they look like those of the part mirrored in {name}"
        yield hint, put(middle + over * (point - middle), over * normal)
