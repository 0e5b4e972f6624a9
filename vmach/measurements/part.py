"""CMM points of the job's part as a `Measurement`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.machine import Variant
from vmach.measurements.measurement import Measurement, apart_from_neighbours
from vmach.points import SurfacePoints, read_points_csv
from vmach.prediction import ActingEffect, Prediction, predict_surface
from vmach.preparation import Preparation
from vmach.units import um_from_mm

__all__ = ["measure_part"]

#: a measured part whose points lie further away than this (median) is another part
_OTHER_PART_MM = 0.5
#: a point further away than this is no measurement of the surface
_ASTRAY_MM = 0.5
#: an alignment alone takes six points
_FEWEST = 12
#: share of the points that the program has to cut; with fewer it is another part's program
_MOST_OF_THEM = 0.5
#: median distance from the prediction, alignment taken off, that no machine of this kind has
_FAR_MM = 0.25
#: no CMM is finer than this
_FINEST_MM = 0.02e-3
#: by how many u, and how far, a point has to stand out to be left out before any fit
_OUTLIER_U = 12.0
_GROSS_MM = 0.06


def measure_part(
    preparation: Preparation,
    path: Path,
    *,
    variant: Variant = Variant.ABBE,
    effects: Sequence[ActingEffect] = (),
) -> tuple[Measurement, Prediction]:
    """Measured points of the part beside what the model predicts for them.

    Points that no move cut, that lie astray or that repeat another row are left out and said.

    Raises
    ------
    InputError
        The file cannot be read, has no measured coordinates, holds another unit or another part,
        or too few of its points were cut by the program.
    """
    points = read_points_csv(path)
    deviation = points.measured_deviation_mm
    _check_same_part(points, deviation, path)
    prediction = predict_surface(preparation, points, variant, effects)
    cut = np.flatnonzero(prediction.is_cut)
    if len(cut) < max(_FEWEST, _MOST_OF_THEM * len(points)):
        raise _not_cut(preparation, points, len(cut), path)
    part = _where_cut(points, prediction, path.name)
    _check_near(part, path)
    part = _without_repeats(part, points.point_mm[cut])
    if points.u_mm is None:
        note = "no uncertainty in the file: taken from the scatter between neighbouring points"
        u_mm = np.full(len(part), _scatter_of_neighbours_mm(part))
        part = replace(part, u_mm=u_mm, notes=(*part.notes, note))
    return _without_outliers(part), prediction


def _where_cut(points: SurfacePoints, prediction: Prediction, name: str) -> Measurement:
    """The points that a move cut, beside their prediction; without u_um they weigh the same."""
    cut = np.flatnonzero(prediction.is_cut)
    notes = (*prediction.preparation.notes, *points.notes)
    if len(cut) < len(points):
        uncut = points.id[~prediction.is_cut]
        notes = (*notes, f"{len(uncut)} points that no move cut are left out: {_listed(uncut)}")
    normal = points.normal[cut]
    arm = points.point_mm[cut] - points.point_mm[cut].mean(axis=0)
    return Measurement(
        kind="part",
        name=name,
        id=points.id[cut],
        states=prediction.states,
        sensing=normal,
        measured_mm=points.measured_deviation_mm[cut],
        predicted_mm=prediction.deviation_mm[cut],
        u_mm=np.ones(len(cut)) if points.u_mm is None else points.u_mm[cut],
        group=points.feature[cut],
        nuisance=np.hstack([normal, np.cross(arm, normal)]),
        notes=notes,
    )


def _check_same_part(points: SurfacePoints, deviation: np.ndarray, path: Path) -> None:
    if points.u_mm is not None and np.median(points.u_mm) < _FINEST_MM:
        raise InputError(
            f"u_um is {um_from_mm(np.median(points.u_mm)):.2g} um (median)",
            file=path,
            accepted=f"{um_from_mm(_FINEST_MM):g} um or more",
            hint="is the column in mm? It has to be in um",
        )
    for note in points.notes:
        if "look like" in note:
            raise InputError(note, file=path, accepted="all coordinates in mm")
    away = np.linalg.norm(points.measured_mm - points.point_mm, axis=1)
    if np.median(np.minimum(away, np.abs(deviation))) > _OTHER_PART_MM:
        raise InputError(
            f"the measured points are {np.median(away):.3g} mm from the nominal ones (median)",
            file=path,
            accepted=f"measured points within {_OTHER_PART_MM} mm of the nominal surface",
            hint="is this the measurement of this part, aligned to its datums?",
        )


def _check_near(part: Measurement, path: Path) -> None:
    """Refuse points that fit the program's surfaces by chance only."""
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


def _not_cut(preparation: Preparation, points: SurfacePoints, cut: int, path: Path) -> InputError:
    """The error for points that the program does not cut, with the unit that would fit."""
    hint = "are the points in workpiece coordinates, and is this the part's program?"
    blank = preparation.job.blank
    if blank is not None:
        size = np.ptp(points.point_mm, axis=0).max() / np.max(blank.max_mm - blank.min_mm)
        for factor, unit in ((1e-3, "metres"), (1 / 25.4, "inches"), (0.1, "centimetres")):
            if 0.5 < size / factor < 1.1:
                hint = f"by their size the coordinates are in {unit}; they have to be in mm"
    return InputError(
        f"the program cuts {cut} of the {len(points)} measured points",
        file=path,
        accepted=f"at least {_MOST_OF_THEM:.0%}, and no fewer than {_FEWEST}, of the points",
        hint=hint,
    )


def _without_repeats(part: Measurement, points_mm: np.ndarray) -> Measurement:
    rows = np.column_stack([points_mm, part.sensing, part.measured_mm])
    _, first = np.unique(rows, axis=0, return_index=True)
    if len(first) == len(part):
        return part
    told = tuple(note for note in part.notes if "repeat an earlier point" not in note)
    count = len(part) - len(first)
    note = f"{count} rows that repeat another row, reading and all, are left out"
    return replace(part, notes=told).keep(np.sort(first), note)


def _without_outliers(part: Measurement) -> Measurement:
    """Leave out points that no neighbour on either side agrees with: a chip under the probe.

    A step, such as backlash makes, has one side that agrees. Small ones are left to the fit:
    near a corner the machine itself can be tens of micrometres away over a millimetre.
    """
    residual = part.measured_mm - part.predicted_mm
    apart = apart_from_neighbours(residual, part.group)
    good = (apart < _GROSS_MM) | (apart < _OUTLIER_U * part.u_mm)
    good &= np.abs(part.measured_mm) < _ASTRAY_MM
    if good.all():
        return part
    bad = part.id[~good]
    return part.keep(
        good,
        f"{len(bad)} points stand out from their neighbours and are left out "
        f"(a chip under the probe?): {_listed(bad)}",
    )


def _scatter_of_neighbours_mm(part: Measurement) -> float:
    """Standard uncertainty from second differences within each group; robust, in mm."""
    residual = part.measured_mm - part.predicted_mm
    bends = [np.diff(residual[part.group == group], 2) for group in np.unique(part.group)]
    bend = np.concatenate(bends)
    if len(bend) == 0:
        return float(np.std(residual))
    return float(1.4826 * np.median(np.abs(bend)) / np.sqrt(6.0))


def _listed(names: np.ndarray, most: int = 6) -> str:
    shown = ", ".join(str(name) for name in names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"
