"""The compensated program on the part's surface: what it leaves of the predicted deviations.

Source: closed form derived here: deviation of the inexact minus that of the perfect machine.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from vmach.compensation.aim.program_surface import ProgramSurface
from vmach.errors import InputError
from vmach.job import Job
from vmach.machine import Variant
from vmach.nominal import Mesh, NominalPart, read_nominal
from vmach.nominal.patches import patches
from vmach.nominal.points import SurfacePoints
from vmach.path.preparation import prepare
from vmach.prediction import (
    ActingEffect,
    Prediction,
    displacement_of,
    predict_surface,
)
from vmach.run.inspection import surface_points
from vmach.uncertainty.first_order import prediction_u_mm

__all__ = ["Surface", "SurfaceCheck", "check_surface", "read_surface"]

#: spacing of the points that are aimed at over that of the inspection points
_FINER = 0.618
#: points that are nearer than this are one
_SAME_MM = 1e-3


@dataclass(frozen=True)
class Surface:
    """Where a job's part is looked at.

    Attributes
    ----------
    points : SurfacePoints
    mesh : Mesh
        To draw them on.
    source : str
        What the points were taken from.
    aim : SurfacePoints, optional
        Points to aim a program at, none of which is among `points`.
    """

    points: SurfacePoints
    mesh: Mesh
    source: str
    aim: SurfacePoints | None = None


@dataclass(frozen=True)
class SurfaceCheck:
    """Error of Q surface points, predicted minus that of the same program without any error.

    Points count that every program cuts, or none leaves alone (`Prediction.overcut`).

    Attributes
    ----------
    surface : Surface
    row : (Q,) int64
        Rows of the surface's points.
    before_mm, after_mm : (Q,) float64
        Along the outward normal, of the user's program and of the compensated one.
    line, tool, move : (Q,) int
        What makes each point, in the user's program.
    time_s : (Q,) float64
    tilt_mm : (Q,) float64
        Share of the tool's tilt in what the compensated program leaves.
    at_edge_mm : dict of str to (Q,) float64
        Shares of the effects that act at the cutting edge, by label.
    lost : int
        Points that the user's program cuts, and the compensated one does not.
    u_mm : (Q,) float64
        Standard uncertainty of `after_mm` by what the tables and the effects leave open, as
        `prediction_u_mm` finds it.
    """

    surface: Surface
    row: np.ndarray
    before_mm: np.ndarray
    after_mm: np.ndarray
    line: np.ndarray
    tool: np.ndarray
    move: np.ndarray
    time_s: np.ndarray
    tilt_mm: np.ndarray
    at_edge_mm: dict[str, np.ndarray]
    lost: int
    u_mm: np.ndarray

    @property
    def expected_rms_mm(self) -> float:
        """RMS to be expected on a machine that is what the tables and their uncertainty say."""
        return float(np.sqrt(self.mean(self.after_mm**2 + self.u_mm**2)))

    def mean(self, values: np.ndarray) -> float:
        """Mean over the points, (Q,), each by its weight."""
        weight = self.surface.points.weight
        return float(np.average(values, weights=None if weight is None else weight[self.row]))

    @property
    def ratio(self) -> float:
        """Mean error before over mean error after; infinite where nothing is left."""
        after = self.mean(np.abs(self.after_mm)) if len(self.after_mm) else 0.0
        return self.mean(np.abs(self.before_mm)) / after if after else np.inf


def read_surface(job: Job, *, with_aim: bool = False) -> Surface | None:
    """The job's inspection points; of the part that the perfect program cuts where it has none.

    None for a job without CAD and blank.

    Parameters
    ----------
    job : Job
    with_aim : bool
        Take a second sample to aim a program at, so that the first one tells what came of it.
    """
    if job.nominal is not None:
        nominal = read_nominal(job.nominal, job.nominal_unit)
        surface = Surface(surface_points(job, nominal), nominal.mesh, "nominal CAD")
        return _with_aim(surface, _sampled(nominal, job)) if with_aim else surface
    if job.blank is None:
        return None
    spacing_mm = job.inspection.spacing_mm
    if job.measured is not None:
        points, source = surface_points(job, None), "measured points"
        program = ProgramSurface(job) if with_aim else None
    else:
        program = ProgramSurface(job)
        points, source = program.sample(spacing_mm), "the part that the perfect program cuts"
    surface = Surface(points, patches(points.point_mm, points.normal), source)
    return _with_aim(surface, program.sample(_FINER * spacing_mm)) if with_aim else surface


def _sampled(part: NominalPart, job: Job) -> SurfacePoints:
    settings = job.inspection
    return part.sample(_FINER * settings.spacing_mm, edge_margin_mm=settings.edge_margin_mm)


def _with_aim(surface: Surface, points: SurfacePoints) -> Surface:
    """The surface with points to aim at, none of which is an inspection point."""
    distance, _ = cKDTree(surface.points.point_mm).query(points.point_mm)
    own = distance > _SAME_MM
    return replace(surface, aim=SurfacePoints(
        points.id[own], points.feature[own], points.point_mm[own], points.normal[own]
    ))  # fmt: skip


def check_surface(
    job: Job,
    text: bytes,
    surface: Surface,
    *,
    effects: Sequence[ActingEffect] = (),
    variant: Variant = Variant.ABBE,
) -> SurfaceCheck:
    """Predict the part before and after, from the texts of both programs.

    Raises
    ------
    InputError
        No point of the surface is cut.
    """
    before = prepare(job)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / job.program.name
        path.write_bytes(text)
        after = prepare(job, program_path=path)

    perfect = predict_surface(before, surface.points, Variant.NONE)
    old = predict_surface(before, surface.points, variant, effects)
    new = predict_surface(after, surface.points, variant, effects, is_compensated=True)
    was_cut = perfect.is_cut & old.is_cut & (perfect.overcut == old.overcut)
    rows = np.flatnonzero(was_cut & new.is_cut & (new.overcut == old.overcut))
    if not len(rows):
        raise InputError(
            f"none of the {len(surface.points)} inspection points is cut",
            file=job.path,
            hint="is the CAD in workpiece coordinates?",
        )
    states, at_edge = old.states, {}
    of_old, of_new = _places(old, rows), _places(new, rows)
    left, normal = new.states[of_new], surface.points.normal[rows]
    tilt = displacement_of(after, left, variant, effects).tilt_rad
    for effect in effects:
        share = np.einsum("ij,ij->i", effect.at_surface(left), normal)
        if share.any():
            at_edge[effect.label] = share
    return SurfaceCheck(
        surface=surface,
        row=rows,
        before_mm=(old.deviation_mm - perfect.deviation_mm)[rows],
        after_mm=(new.deviation_mm - perfect.deviation_mm)[rows],
        line=states.line[of_old],
        tool=states.tool[of_old],
        move=states.move[of_old],
        time_s=states.time_s[of_old],
        tilt_mm=np.einsum("ij,ij->i", np.cross(tilt, left.contact_mm), normal),
        at_edge_mm=at_edge,
        lost=int((was_cut & ~new.is_cut).sum()),
        u_mm=prediction_u_mm(new)[of_new],
    )


def _places(prediction: Prediction, rows: np.ndarray) -> np.ndarray:
    """Where rows of the points are in the prediction's states."""
    return (np.cumsum(prediction.is_cut) - 1)[rows]
