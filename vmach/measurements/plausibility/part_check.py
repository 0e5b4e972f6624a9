"""Are measured points those of this part, in mm, in the coordinates of its program?

Source: JCGM 100:2008 (GUM), 4.3.7: rounding to a step s has the standard uncertainty s / sqrt(12).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from vmach.base.note import Kind, Note
from vmach.base.units import um_from_mm
from vmach.errors import InputError
from vmach.machine import Variant
from vmach.measurements.measurement import Measurement
from vmach.measurements.plausibility.tool_alternatives import tool_that_would_cut
from vmach.measurements.plausibility.wrong_frame import wrong_frame
from vmach.nominal.points import SurfacePoints
from vmach.path.preparation import Preparation
from vmach.prediction import predict_surface

__all__ = [
    "FINEST_MM",
    "check_aligned",
    "check_cut",
    "check_file",
    "check_near",
    "rounding_mm",
    "rounding_notes",
    "some_of",
]

#: an alignment alone takes six points
_FEWEST = 12
#: share of the points that the program has to cut; with fewer it is another part's program
_MOST_OF_THEM = 0.5
#: a measured part whose points lie further away than this (median) is another part
_OTHER_PART_MM = 0.5
#: median distance from the prediction, alignment taken off, that no machine of this kind has
_FAR_MM = 0.25
#: no CMM is finer, and none that is of use is coarser
FINEST_MM, _COARSEST_MM = 0.02e-3, 0.1
#: coordinates this near to rounded ones are rounded
_NO_DIGIT_MM = 1e-9
#: points on which a guess at what is wrong is tried
_TRIED = 60
#: units that points may be in: how long a millimetre is in them
_UNITS = {"metres": 1e-3, "inches": 1 / 25.4, "centimetres": 0.1, "um": 1e3}


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


def check_aligned(points: SurfacePoints, path: Path) -> None:
    """Refuse measured points that lie nowhere near the nominal ones.

    Raises
    ------
    InputError
        With the shift, turn or exchange of columns that would bring them there, if there is one.
    """
    assert points.measured_mm is not None
    away = np.linalg.norm(points.measured_mm - points.point_mm, axis=1)
    if np.median(np.minimum(away, np.abs(points.measured_deviation_mm))) <= _OTHER_PART_MM:
        return
    raise InputError(
        f"the measured points are {np.median(away):.4g} mm from the nominal ones (median)",
        file=path,
        accepted=f"measured points within {_OTHER_PART_MM} mm of the nominal surface",
        hint=wrong_frame(points.point_mm, points.measured_mm)
        or "is this the measurement of this part, aligned to its datums?",
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


def check_near(part: Measurement, path: Path) -> None:
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
            hint="is this the measurement of the part that this program makes?",
        )


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
    for unit, length in _UNITS.items():
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
