"""CMM points of the job's part as a `Measurement`.

Source: closed form derived here: a number that is rounded to r has the uncertainty r / sqrt(12).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path

import numpy as np

from vmach.base.note import Kind, Level, Note, in_file
from vmach.base.units import um_from_mm
from vmach.machine import Variant
from vmach.measurements.instrument import Instrument
from vmach.measurements.measurement import Measurement
from vmach.measurements.neighbours import (
    apart_from_neighbours,
    scatter_of_neighbours,
    unfiltered_scatter,
)
from vmach.measurements.plausibility.alternatives import alternative_notes
from vmach.measurements.plausibility.gross_mistakes import gross_mistake
from vmach.measurements.plausibility.odd_uncertainty import odd_uncertainty_notes
from vmach.measurements.plausibility.part_alternatives import part_alternatives
from vmach.measurements.plausibility.part_check import (
    FEW,
    FINEST_MM,
    MANY_UNCUT,
    astray,
    beside_notes,
    beside_pose_mm,
    check_aligned,
    check_astray,
    check_cut,
    check_file,
    check_near,
    check_unit_of_points,
    rounding_mm,
    rounding_notes,
    some_of,
)
from vmach.measurements.plausibility.tool_alternatives import tool_that_would_cut
from vmach.measurements.repeats import check_degrees, clampings_differ, mean_of_repeats
from vmach.measurements.stretches import stretches_of
from vmach.nominal.points import SurfacePoints, read_points_csv
from vmach.nominal.seat import Seat, seat_of
from vmach.path.preparation import Preparation
from vmach.prediction import ActingEffect, Prediction, predict_surface
from vmach.prediction.made_surface import MadeSurface

__all__ = ["PartPoints", "measure_part"]

#: neighbours that scatter by so many times u_um make it doubtful
_DOUBTFUL = 3.0
#: a part that lay further from its nominal place than this (median) is worth a note, mm
_NOTABLE_MM = 0.1
#: by how many u, and how far, a point has to stand out to be left out before any fit
_OUTLIER_U = 12.0
_GROSS_MM = 0.06
#: points that tell what may be wrong with a file, at least, where there are twice as many; chosen:
#: a mean of so many is known to a hundredth of the scatter
_ASKED = 10_000


class PartPoints(Instrument):
    """Points of the machined part, touched by a coordinate measuring machine."""

    name = "part"
    title = "Points of the part"
    sign_meaning = "a deviation is (m - p) along i, j, k and positive where material is left"
    left_free = "pose of the part"
    is_section_of_job = False  # the job names them by its key `measured`


def measure_part(
    preparation: Preparation,
    path: Path,
    *,
    effects: Sequence[ActingEffect] = (),
) -> tuple[Measurement, Prediction]:
    """Measured points of the part beside what the model predicts for them.

    The pose of the part is taken off before anything is judged by it. Points that no move cut,
    that lie astray or that repeat another row are left out and said. Readings stand in the order
    of measuring, where the file tells it.

    Raises
    ------
    InputError
        The file cannot be read, has no measured coordinates, holds another unit, another zero or
        another part, or too few of its points were cut by the program.
    """
    points = _in_order(read_points_csv(path))
    check_file(points, path)
    seat = seat_of(points)
    seated = _seated(points, seat)
    prediction = predict_surface(preparation, seated, Variant.ABBE, effects)
    cut = np.flatnonzero(prediction.is_cut)
    check_cut(preparation, points, len(cut), path=path)

    def cause() -> str | None:
        return gross_mistake(_where_cut(points, prediction, path.name), preparation.job)

    check_aligned(points, seat, path, cause)
    doubts = check_unit_of_points(preparation, points, prediction.is_cut, path)
    if points.u_mm is not None:
        odd = odd_uncertainty_notes(um_from_mm(points.u_mm), points.line)
        doubts = (*doubts, *in_file(odd, path))
    part = _where_cut(seated, prediction, path.name).made_beside(()).noted(*doubts)
    # the pose stays in the readings, which leave it free, without what of a turn is not linear
    pose_mm = seat.deviation_mm(points.point_mm, points.normal)[cut]
    part = replace(part, measured_mm=part.measured_mm + pose_mm)
    check_near(part, path, cause)
    check_astray(_rows_of(seated, cut), path, cause)
    part = _without_repeats(part, _rows_of(points, cut))
    is_stated = points.u_mm is not None
    if is_stated:
        part = _without_outliers(part)
    assert part.surface is not None
    place = part.surface.points_mm, part.surface.normals
    part = mean_of_repeats(part, place)
    if is_stated:
        place = part.surface.points_mm, part.surface.normals
        part = part.noted(*clampings_differ(part, place, beside_pose_mm(part)))
    check_degrees(part, path)
    if not is_stated:
        u_mm = np.full(len(part), _uncertainty_mm(part, points))
        part = replace(part, u_mm=u_mm).noted(
            *in_file([Note.plain(Kind.UNCERTAINTY, _NO_UNCERTAINTY, place="u_um")], path)
        )
        part = _without_outliers(part)
    few = part.thinned(_ASKED)
    asked = alternative_notes(few, part_alternatives(few, preparation))
    return part.noted(*_doubtful_uncertainty(part), *asked), prediction


def _in_order(points: SurfacePoints) -> SurfacePoints:
    """The points in the order of measuring; as in the file where that is not told."""
    if points.measured_at is None:
        return points
    return _rows_of(points, np.argsort(points.measured_at, kind="stable"))


def _rows_of(points: SurfacePoints, rows: np.ndarray) -> SurfacePoints:
    """Some of the points by their index, (R,) int."""
    own = {field.name: getattr(points, field.name) for field in fields(points)}
    chosen = {name: v[rows] for name, v in own.items() if isinstance(v, np.ndarray)}
    return replace(points, **chosen)


def _seated(points: SurfacePoints, seat: Seat) -> SurfacePoints:
    """The points with the part brought back to its nominal place; a note where it lay far off.

    What the measured digits tell, as how they are rounded, is said of them as they are.
    """
    assert points.measured_mm is not None
    at_place = replace(points, measured_mm=seat.taken_back(points.measured_mm))
    notes = (*points.notes, *rounding_notes(points), *beside_notes(at_place))
    if (far := seat.size_mm(points)) > _NOTABLE_MM:
        by = ", ".join(f"{value:.3f}" for value in np.round(seat.shift_of_zero_mm, 3) + 0.0)
        said = (
            f"the measured part lies {far:.3g} mm from its nominal place, its zero at "
            f"({by}) mm: taken for its pose on the measuring machine"
        )
        notes = (*notes, Note.plain(Kind.ALIGNMENT, said, far, "mm", place="mx my mz"))
    return replace(at_place, notes=notes)


_NO_UNCERTAINTY = (
    "no uncertainty in the file: taken from the scatter between neighbouring points, or rounding"
)


def _where_cut(points: SurfacePoints, prediction: Prediction, name: str) -> Measurement:
    """The points that a move cut, beside their prediction; without u_um they weigh the same."""
    cut = np.flatnonzero(prediction.is_cut)
    notes = (*prediction.preparation.notes, *points.notes)
    if len(cut) < len(points):
        notes = (*notes, _uncut_note(points, prediction, name))
    normal = points.normal[cut]
    arm = points.point_mm[cut] - points.point_mm[cut].mean(axis=0)
    return Measurement(
        instrument=PartPoints,
        name=name,
        id=points.id[cut],
        states=prediction.states,
        sensing=normal,
        measured_mm=points.measured_deviation_mm[cut],
        predicted_mm=prediction.deviation_mm[cut],
        u_mm=np.ones(len(cut)) if points.u_mm is None else points.u_mm[cut],
        group=_groups(points)[cut],
        nuisance=np.hstack([normal, np.cross(arm, normal)]),
        notes=notes,
        clamping=None if points.clamping is None else points.clamping[cut],
        measured_at=None if points.measured_at is None else points.measured_at[cut],
        surface=MadeSurface(
            prediction.preparation,
            points.point_mm[cut],
            normal,
            prediction.variant,
            prediction.effects,
        ),
    )


def _groups(points: SurfacePoints) -> np.ndarray:
    """The feature of each point, (P,) str; where the file names none, the stretch of a surface."""
    if (points.feature != "").any():
        return points.feature
    return stretches_of(points.point_mm, points.normal)


def _uncut_note(points: SurfacePoints, prediction: Prediction, name: str) -> Note:
    """Which points no move cut, and why that may be where they are many."""
    uncut = points.id[~prediction.is_cut]
    said = f"left out because no move cuts them ({len(uncut)} of {len(points)}): {_listed(uncut)}"
    note = Note.plain(Kind.UNCUT, said, len(uncut), "1", file=name)
    if len(uncut) <= MANY_UNCUT * len(points):
        return note
    few = some_of(points, np.flatnonzero(~prediction.is_cut))
    why = tool_that_would_cut(prediction.preparation, few)
    why = why or "is this the measurement of this part, with the program's zero?"
    return replace(note, level=Level.QUESTION, sentence=f"{said}; so many: {why}")


def _without_repeats(part: Measurement, points: SurfacePoints) -> Measurement:
    """Leave out rows that repeat another row of the points, as they stand in the file."""
    rows = np.column_stack([points.point_mm, part.sensing, points.measured_deviation_mm])
    _, first = np.unique(rows, axis=0, return_index=True)
    if len(first) == len(part):
        return part
    told = tuple(note for note in part.notes if note.kind is not Kind.REPEAT)
    count = len(part) - len(first)
    said = f"{count} rows that repeat another row, reading included, are left out"
    note = Note.plain(Kind.LEFT_OUT, said, count, "1", file=part.name)
    return replace(part, notes=told).keep(np.sort(first), note)


def _without_outliers(part: Measurement) -> Measurement:
    """Leave out points that no neighbour on either side agrees with: a chip under the probe.

    More than a few of them have another cause, and stay. A step, such as backlash makes, has one
    side that agrees. Small ones are left to the fit:
    near a corner the machine itself can be tens of micrometres away over a millimetre.
    """
    residual = beside_pose_mm(part)
    apart = apart_from_neighbours(residual, part.group)
    is_astray = astray(residual)
    is_apart = (apart >= _GROSS_MM) & (apart >= _OUTLIER_U * part.u_mm)
    if (count := np.count_nonzero(is_apart | is_astray)) > FEW * len(part):
        said = (
            f"{count} of {len(part)} readings stand apart from their neighbours, too many for "
            f"chips under the probe: they stay, the first is {part.id[is_apart][0]}"
        )
        part = part.noted(Note.question(Kind.SCATTER, said, count, "1", file=part.name))
        is_apart = is_astray
    good = ~(is_apart | is_astray)
    if good.all():
        return part
    bad = part.id[~good]
    said = (
        "left out as outliers among their neighbours, such as a chip under "
        f"the probe ({len(bad)} of {len(part)}): {_listed(bad)}"
    )
    return part.keep(good, Note.plain(Kind.LEFT_OUT, said, len(bad), "1", file=part.name))


def _doubtful_uncertainty(part: Measurement) -> tuple[Note, ...]:
    """A note where neighbouring points scatter far more than their uncertainty says."""
    scatter = scatter_of_neighbours(beside_pose_mm(part), part.group)
    u_mm = float(np.median(part.u_mm))
    if scatter < _DOUBTFUL * u_mm:
        return ()
    said = (
        f"neighbouring points scatter by {um_from_mm(scatter):.2g} um where u_um "
        f"says {um_from_mm(u_mm):.2g} um (median): is u_um too small?"
    )
    size_um = float(um_from_mm(scatter))
    return (Note.question(Kind.UNCERTAINTY, said, size_um, "um", place="u_um", file=part.name),)


def _uncertainty_mm(part: Measurement, points: SurfacePoints) -> float:
    """Standard uncertainty of readings that state none: what their rounding leaves, or more.

    Readings that are all rounded to what was predicted would scatter by nothing.
    """
    rounding = rounding_mm(points) / np.sqrt(12.0)
    return max(unfiltered_scatter(beside_pose_mm(part), part.group), rounding, FINEST_MM)


def _listed(names: np.ndarray, most: int = 6) -> str:
    shown = ", ".join(str(name) for name in names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"
