"""A job's part ready to be looked at: mesh, points, and what the model says of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vmach.base.note import Note
from vmach.effects import EffectInstance, load_effect_file, read_effects
from vmach.errors import InputError
from vmach.job import Job, read_job
from vmach.machine import Machine, Variant
from vmach.nominal import NominalPart, read_nominal
from vmach.nominal.alignment import align
from vmach.nominal.patches import patches
from vmach.nominal.points import SurfacePoints, read_points_csv
from vmach.path.preparation import Preparation, prepare
from vmach.prediction import Prediction, predict, predict_surface
from vmach.report import DisplayMesh
from vmach.report.pictures.display_mesh import shaped_for_display
from vmach.run.inspection import check_some_cut, surface_points
from vmach.uncertainty.first_order import prediction_u_mm
from vmach.workbench.model.bare_job import MISSING, bare_solid, is_bare, no_points
from vmach.workbench.model.point_set import PointSet

if TYPE_CHECKING:
    from vmach.fit.survey import Survey

__all__ = ["PartModel", "load_part"]

#: triangles of the mesh that is shown, at most
_TRIANGLES = 100_000


@dataclass(frozen=True)
class PartModel:
    """What is open: a job, its machine's errors at every inspected point, and a mesh.

    Attributes
    ----------
    job : Job
    preparation : Preparation
    effects : tuple of EffectInstance
        Those of the job.
    mesh : DisplayMesh
    surface : PointSet
        Points on the nominal CAD; where the job has none, the measured ones.
    prediction : Prediction
        Of these P points and those that no tool cut.
    points_mm : (P, 3) float64
    notes : tuple of Note
    """

    job: Job
    preparation: Preparation
    effects: tuple[EffectInstance, ...]
    mesh: DisplayMesh
    surface: PointSet
    prediction: Prediction
    points_mm: np.ndarray
    notes: tuple[Note, ...]

    @property
    def is_measured(self) -> bool:
        """Whether anything was measured for the job."""
        return self.has_measured_part or bool(self.job.measurements)

    @property
    def missing(self) -> str | None:
        """What the job lacks so that a part could be shown, for people; None where it has it."""
        return MISSING if is_bare(self.preparation) else None

    @cached_property
    def has_measured_part(self) -> bool:
        """Whether the job names measured points: nominal ones alone say where to look.

        A file that cannot be read counts: what is wrong with it is said where it is asked for.
        """
        if self.job.measured is None:
            return False
        try:
            return read_points_csv(self.job.measured).measured_mm is not None
        except InputError:
            return True

    def cut_anew(
        self, changed: Sequence[EffectInstance], machine: Machine | None = None
    ) -> np.ndarray:
        """Predicted deviations (C,) mm of the surface's points with effects in place of the job's.

        And with another machine in place of it. A point that no tool cuts any more keeps the
        deviation that it had.
        """
        effects = {e.label: e for e in self.effects} | {e.label: e for e in changed}
        prediction, preparation = self.prediction, self.preparation
        if machine is not None:
            preparation = replace(preparation, job=replace(self.job, machine=machine))
        found = predict(
            preparation, self.points_mm, prediction.normals, variant=Variant.ABBE,
            effects=tuple(effects.values()),
        )  # fmt: skip
        deviation = np.where(found.is_cut, found.deviation_mm, prediction.deviation_mm)
        return deviation[prediction.is_cut]

    @cached_property
    def u_mm(self) -> np.ndarray:
        """Standard uncertainty of the deviation of every point of the surface, (C,) mm."""
        return prediction_u_mm(self.prediction)

    @cached_property
    def survey(self) -> Survey | None:
        """All that was measured; None where nothing was."""
        if not self.is_measured:
            return None
        from vmach.diagnosis.residuals.job_survey import survey_job  # the picture needs none of it

        job = self.job if self.has_measured_part else replace(self.job, measured=None)
        return survey_job(job)

    @cached_property
    def measured(self) -> PointSet | None:
        """The measured points of the part; None where it was not measured."""
        if not self.has_measured_part or self.survey is None:
            return None
        for m, path in zip(self.survey.measurements, self.survey.paths, strict=True):
            if m.on_part:
                return PointSet(
                    name="measured", id=m.id, feature=m.group, point_mm=path.on_part_mm,
                    normal=m.sensing, states=m.states, predicted_mm=m.predicted_mm,
                    align=_without(m.nuisance, m.u_mm), job=self.job, effects=self.effects,
                    measured_mm=m.measured_mm, u_mm=m.u_mm,
                )  # fmt: skip
        return None

    def point_set(self, name: str) -> PointSet:
        """The set of a name.

        Raises
        ------
        InputError
            Nothing was measured, or there is no such set.
        """
        found = {"surface": lambda: self.surface, "measured": lambda: self.measured}.get(name)
        points = found() if found else None
        if points is None:
            raise InputError(f"no points called {name!r}", accepted="surface, measured")
        return points


def load_part(job_path: Path, effect_files: Sequence[Path] = ()) -> PartModel:
    """Read a job and predict its part.

    Raises
    ------
    InputError, gcode.ProgramError, stock.StockError
    """
    for file in effect_files:
        load_effect_file(file)
    job = read_job(job_path)
    effects = read_effects(job.effects, file=job.path, job=job)
    preparation = prepare(job)
    nominal = read_nominal(job.nominal, job.nominal_unit) if job.nominal else None
    bare = is_bare(preparation)
    points = no_points() if bare else surface_points(job, nominal)
    prediction = predict_surface(preparation, points, Variant.ABBE, effects)
    if not bare:
        check_some_cut(job, points, prediction)
    mesh = shaped_for_display(
        *_solid(preparation, points, nominal),
        point_count=len(points), max_triangles=_TRIANGLES,
    )  # fmt: skip
    notes = (*preparation.notes, *points.notes)
    surface = _surface_set(job, points, prediction, effects)
    return PartModel(job, preparation, effects, mesh, surface, prediction, points.point_mm, notes)


def _solid(
    preparation: Preparation, points: SurfacePoints, nominal: NominalPart | None
) -> tuple[np.ndarray, np.ndarray]:
    """What is drawn: vertices (V, 3) mm and triangles (T, 3)."""
    if is_bare(preparation):
        return bare_solid(preparation)
    solid = patches(points.point_mm, points.normal) if nominal is None else nominal.mesh
    return solid.vertices_mm, solid.triangles


def _surface_set(
    job: Job, points: SurfacePoints, prediction: Prediction, effects: tuple[EffectInstance, ...]
) -> PointSet:
    cut = prediction.is_cut
    some = SurfacePoints(
        points.id[cut], points.feature[cut], points.point_mm[cut], points.normal[cut]
    )

    weight = None if points.weight is None else points.weight[cut]

    def aligned(deviation_mm: np.ndarray) -> np.ndarray:
        if not len(some):
            return deviation_mm
        settings = job.inspection
        pose = align(
            some, deviation_mm, mode=settings.alignment, datums=settings.datums, weights=weight
        )
        return pose.apply(some.point_mm, some.normal, deviation_mm)

    return PointSet(
        name="surface", id=some.id, feature=some.feature, point_mm=some.point_mm,
        normal=some.normal, states=prediction.states, predicted_mm=prediction.deviation_mm[cut],
        align=aligned, job=job, effects=effects, weight=weight,
        bare=(points.point_mm[~cut], points.normal[~cut]),
    )  # fmt: skip


def _without(nuisance: np.ndarray, u_mm: np.ndarray):
    """Takes the best fit of what a measurement leaves free off values at its readings."""
    weight = 1.0 / u_mm

    def aligned(values_mm: np.ndarray) -> np.ndarray:
        free = np.linalg.lstsq(nuisance * weight[:, None], values_mm * weight, rcond=None)[0]
        return values_mm - nuisance @ free

    return aligned
