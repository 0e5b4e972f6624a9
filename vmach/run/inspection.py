"""Inspection: where a job's part is looked at, and the table of what was found there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stock import EdgeStatus
from vmach.base.note import Kind, Note
from vmach.base.units import um_from_mm, urad_from_rad
from vmach.errors import InputError
from vmach.job import Inspection, Job
from vmach.machine import Variant
from vmach.nominal import NominalPart
from vmach.nominal.alignment import align
from vmach.nominal.points import SurfacePoints, read_points_csv
from vmach.prediction import Prediction
from vmach.prediction.error_budget import ErrorBudget
from vmach.report import STATUSES, Column, InspectedPoints

__all__ = [
    "LABELS",
    "check_nominal_in_blank",
    "check_some_cut",
    "inspected_points",
    "remainder_mm",
    "surface_points",
    "with_causes",
]

LABELS = {
    Variant.NONE: "Program alone",
    Variant.HTM: "Conventional HTM",
    Variant.ABBE: "Abbe-consistent",
}
#: how far the nominal part may stand out of the blank
_BLANK_SLACK_MM = 0.05

#: a part that is smaller than its blank by this factor in X, Y and Z alike is in another unit:
#: 10 would be centimetres, 25.4 inches, 1000 metres
_UNIT_DOUBT = 9.5

#: share of the blank's volume that rounding may add to a part that fills it
_VOLUME_SLACK = 1e-3


def surface_points(
    job: Job, nominal: NominalPart | None, *, prefer_measured: bool = False
) -> SurfacePoints:
    """Points to inspect: sampled on the nominal CAD, or those that were measured.

    Raises
    ------
    InputError
        The job has neither; or the nominal part does not fit into the blank.
    """
    if job.measured is not None and (prefer_measured or nominal is None):
        return read_points_csv(job.measured)
    if nominal is None:
        raise InputError(
            "nothing to inspect",
            file=job.path,
            accepted="nominal = an STL or STEP file, or measured = a CSV of points",
        )
    check_nominal_in_blank(job, nominal)
    settings = job.inspection
    points = nominal.sample(settings.spacing_mm, edge_margin_mm=settings.edge_margin_mm)
    if not len(points):
        raise InputError(
            f"no face of the nominal part has room for a point: it measures "
            f"{_size(nominal.bounds_mm)} mm, and points keep {settings.edge_margin_mm:g} mm from "
            "edges",
            file=job.nominal,
            accepted="faces wider than twice [inspection] edge_margin_mm",
            hint=_UNIT_HINT,
        )
    return points


_UNIT_HINT = 'is the CAD in mm? otherwise nominal_unit = "inch", "m" or "cm" in the job'


def check_some_cut(job: Job, points: SurfacePoints, prediction: Prediction) -> None:
    """Refuse a report about nothing: no tool comes near any of the points."""
    if prediction.is_cut.any():
        return
    low, high = points.point_mm.min(axis=0), points.point_mm.max(axis=0)
    raise InputError(
        f"the program cuts none of the {len(points)} points to inspect; they span "
        f"{_box(low, high)} mm",
        file=job.measured if points.measured_mm is not None else job.nominal,
        accepted="points on surfaces that the program cuts",
        hint="are workpiece zero, work offsets and tool lengths right, and is the CAD in mm?",
    )


def check_nominal_in_blank(job: Job, nominal: NominalPart) -> None:
    """Refuse a nominal part that could not have come out of the blank."""
    if job.blank is None:
        return
    _check_unit(job, nominal)
    _check_volume(job, nominal)
    low, high = nominal.bounds_mm
    outside = max((job.blank.min_mm - low).max(), (high - job.blank.max_mm).max())
    if outside > _BLANK_SLACK_MM:
        raise InputError(
            f"the nominal part spans {_box(low, high)} mm and stands {outside:.3g} mm out of "
            "the stock",
            file=job.nominal,
            accepted=f"inside {_box(job.blank.min_mm, job.blank.max_mm)} mm ([stock])",
            hint="is the CAD in workpiece coordinates, in mm?",
        )


def _check_unit(job: Job, nominal: NominalPart) -> None:
    """Ask for the unit where a part is far smaller than its blank in all three directions."""
    size = np.ptp(nominal.bounds_mm, axis=0)
    times = ((job.blank.max_mm - job.blank.min_mm) / np.maximum(size, 1e-12)).min()
    if job.nominal_unit is None and times >= _UNIT_DOUBT:
        raise InputError(
            f"the nominal part measures {_size(nominal.bounds_mm)} mm, the stock at least "
            f"{times:.4g} times as much in every direction",
            file=job.nominal,
            accepted=f"less than {_UNIT_DOUBT:g} times, or the unit stated in the job",
            hint='nominal_unit = "inch", "m" or "cm" in the job; "mm" if it is right',
        )


def _check_volume(job: Job, nominal: NominalPart) -> None:
    """Refuse a part with more material than its blank."""
    part_mm3, blank_mm3 = nominal.volume_mm3, job.blank.volume_mm3
    if part_mm3 > (1.0 + _VOLUME_SLACK) * blank_mm3 and _fits(job, nominal):
        raise InputError(
            f"the nominal part has {part_mm3:.6g} mm3, the stock that it lies in {blank_mm3:.6g}",
            file=job.nominal,
            accepted="no more material than the stock has",
            hint="do bodies of the CAD overlap?",
        )


def _fits(job: Job, nominal: NominalPart) -> bool:
    low, high = nominal.bounds_mm
    return bool((low >= job.blank.min_mm).all() and (high <= job.blank.max_mm).all())


def _box(low: np.ndarray, high: np.ndarray) -> str:
    return " x ".join(f"{x:g}..{y:g}" for x, y in zip(low, high, strict=True))


def _size(bounds_mm: np.ndarray) -> str:
    return " x ".join(f"{x:.4g}" for x in np.ptp(bounds_mm, axis=0))


def inspected_points(
    job: Job, points: SurfacePoints, predictions: Sequence[Prediction]
) -> tuple[InspectedPoints, tuple[Note, ...]]:
    """The table of deviations, one column a variant, and notes on it.

    Predicted deviations are aligned as the job asks. Measured ones, where the points have them,
    are aligned by best fit to the last prediction, since a part's pose on the CMM is arbitrary;
    for every variant the RMS of measured minus predicted after its own best fit is given.

    Raises
    ------
    InputError
        The points do not allow the alignment that the job asks for.
    """
    notes: list[Note] = []
    try:
        columns = [_column(points, p, job.inspection, notes) for p in predictions]
    except InputError as error:  # of the alignment, which does not know the job's file
        raise InputError(
            error.what, file=job.path, accepted=error.accepted, hint=error.hint
        ) from None
    primary = predictions[-1]
    if points.measured_mm is not None:
        columns.append(_measured_column(points, primary))
    notes += _notes_on_states(primary)
    return _table(points, primary, columns), tuple(notes)


def with_causes(points: InspectedPoints, budget: ErrorBudget) -> InspectedPoints:
    """The table with the largest shares of every cut point's deviation in words."""
    words = [
        ", ".join(f"{name} {um_from_mm(share):+.2f}" for name, share in budget.largest(row))
        for row in range(len(budget.share_mm))
    ]
    cause = np.full(len(points), "", dtype=f"U{max(map(len, words), default=1)}")
    cause[points.primary.is_cut] = words
    return replace(points, cause=cause)


def _notes_on_states(prediction: Prediction) -> list[Note]:
    """Say what was not cut, and where the program cuts into surfaces that the part has."""
    notes = []
    uncut = int((prediction.edges.status == EdgeStatus.UNCUT).sum())
    if uncut:
        said = f"no tool came near {uncut} points: raw stock, or material left"
        notes.append(Note.plain(Kind.UNCUT, said, uncut, "1"))
    gouged = int((prediction.edges.status == EdgeStatus.GOUGED).sum())
    if gouged:
        said = f"{gouged} points lie where the program removes the surface altogether"
        notes.append(Note.plain(Kind.GOUGED, said, gouged, "1"))
    overcut = int(prediction.overcut.sum())
    if overcut:
        line = prediction.states.line[np.argmax(prediction.overcut[prediction.is_cut])]
        said = (
            f"{overcut} measured points, the first from line {line}, would be cut away by other "
            "moves of the program as read. They are predicted from the move that makes them"
        )
        notes.append(Note.plain(Kind.OVERCUT, said, overcut, "1", place=f"line {line}"))
    return notes


def _column(
    points: SurfacePoints, prediction: Prediction, settings: Inspection, notes: list[Note]
) -> Column:
    cut = prediction.is_cut
    deviation = np.array(prediction.deviation_mm)
    if settings.alignment != "none" and cut.any():
        found = align(
            _some(points, cut),
            deviation[cut],
            mode=settings.alignment,
            datums=settings.datums,
            weights=None if points.weight is None else points.weight[cut],
        )
        deviation[cut] = found.apply(points.point_mm[cut], points.normal[cut], deviation[cut])
        shift = ", ".join(f"{um_from_mm(x):.2f}" for x in found.shift_mm)
        turn = ", ".join(f"{urad_from_rad(x):.1f}" for x in found.rotation_rad)
        label = LABELS[prediction.variant]
        said = f"{label}: {settings.alignment} took away [{shift}] um, [{turn}] urad"
        size_um = float(um_from_mm(np.linalg.norm(found.shift_mm)))
        place = str(prediction.variant)
        notes.append(Note.plain(Kind.ALIGNMENT, said, size_um, "um", place=place))
    return Column(
        name=str(prediction.variant),
        label=LABELS[prediction.variant],
        deviation_mm=deviation,
        status=np.array(STATUSES)[prediction.edges.status],
        remainder_mm=remainder_mm(points, prediction),
        weight=points.weight,
    )


def remainder_mm(points: SurfacePoints, prediction: Prediction) -> np.ndarray | None:
    """Measured minus predicted after a best fit, (P,); NaN where nothing was cut.

    None without measured points.
    """
    cut = prediction.is_cut
    if points.measured_mm is None or not cut.any():
        return None
    left = np.where(cut, points.measured_deviation_mm - prediction.deviation_mm, np.nan)
    pose = align(_some(points, cut), left[cut])
    return pose.apply(points.point_mm, points.normal, left)


def _measured_column(points: SurfacePoints, primary: Prediction) -> Column:
    cut = primary.is_cut
    measured = np.array(points.measured_deviation_mm)
    if cut.any():
        left = (measured - primary.deviation_mm)[cut]
        pose = align(_some(points, cut), left)
        measured -= pose.deviation_mm(points.point_mm, points.normal)
    status = np.full(len(points), "cut")
    return Column("measured", "Measured, best fit to the prediction", measured, status)


def _some(points: SurfacePoints, mask: np.ndarray) -> SurfacePoints:
    return SurfacePoints(
        points.id[mask], points.feature[mask], points.point_mm[mask], points.normal[mask]
    )


def _table(points: SurfacePoints, primary: Prediction, columns: list[Column]) -> InspectedPoints:
    """Points with the move that made each; zeros where none did."""
    cut, states = primary.is_cut, primary.states

    def spread(values: np.ndarray, empty: float = 0) -> np.ndarray:
        full = np.full(len(points), empty, dtype=values.dtype)
        full[cut] = values
        return full

    return InspectedPoints(
        id=points.id,
        feature=points.feature,
        point_mm=points.point_mm,
        normal=points.normal,
        line=spread(states.line),
        tool=spread(states.tool),
        move=spread(states.move, -1),
        time_s=spread(states.time_s),
        columns=tuple(columns),
        u_mm=points.u_mm,
    )
