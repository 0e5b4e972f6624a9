"""The main job: from an NC program to the predicted part and its deviations.

`machine_part` reads like the description of the program; everything it calls is a stage that can
be used on its own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from stock import Collision, CutAside, Sweeps, VirtualPart
from vmach.base.note import Kind, Level, Note, in_file
from vmach.base.stage_clock import Progress, StageClock, silent
from vmach.base.units import um_from_mm
from vmach.effects import EffectInstance, read_effects
from vmach.errors import InputError
from vmach.features.circular_test import CircularTest
from vmach.features.result import FeatureResult
from vmach.job import Job, read_job
from vmach.machine import Variant
from vmach.measurements.plausibility.part_check import (
    check_aligned,
    check_cut,
    check_file,
    check_unit_of_points,
)
from vmach.nominal import NominalPart, read_nominal
from vmach.nominal.points import SurfacePoints, read_points_csv
from vmach.nominal.seat import seat_of
from vmach.path.preparation import Preparation, prepare
from vmach.path.toolpath import PathStates
from vmach.plausibility import machine_notes
from vmach.prediction import Prediction, displaced_sweeps, predict_surface
from vmach.prediction.error_budget import ErrorBudget, error_budget
from vmach.report import InspectedPoints, SolidComparison
from vmach.run.circular_tests import job_circular_tests
from vmach.run.collisions import collision_notes, job_collisions
from vmach.run.inspection import check_some_cut, inspected_points, surface_points, with_causes
from vmach.run.solid_comparison import compare_solids, comparison_notes

if TYPE_CHECKING:
    from vmach.uncertainty.monte_carlo import Plan

__all__ = [
    "SOLID_MOVES",
    "MachinedPart",
    "PartInspection",
    "inspect_part",
    "machine_part",
    "predict_points",
]


#: programs of more moves are inspected without a solid, unless it is asked for: cutting it takes
#: minutes from here on
SOLID_MOVES = 100_000


@dataclass(frozen=True, kw_only=True)
class PartInspection:
    """The surface of a job's part under several error models, without a solid.

    Attributes
    ----------
    job : Job
    preparation : Preparation
    points : InspectedPoints
        Deviations of every variant, aligned as the job asks.
    states : PathStates
        How the points that were cut under the last variant were made.
    budget : ErrorBudget
        Of the same points and variant, without alignment.
    nominal : NominalPart or None
    notes : tuple of Note
        What the user should know before trusting the numbers.
    features : tuple of FeatureResult
        What the drawing asks for; empty where the job has no tolerances.
    circular_tests : tuple of CircularTest
        Circles of the program; empty where the job does not ask for them.
    """

    job: Job
    preparation: Preparation
    points: InspectedPoints
    states: PathStates
    budget: ErrorBudget
    nominal: NominalPart | None
    notes: tuple[Note, ...]
    features: tuple[FeatureResult, ...] = ()
    circular_tests: tuple[CircularTest, ...] = ()


@dataclass(frozen=True, kw_only=True)
class MachinedPart(PartInspection):
    """What the main job found.

    Attributes
    ----------
    part : VirtualPart or None
        The solid that the displaced tools leave; None where it was not cut.
    model : Variant
        The error model that the solid was cut with.
    comparison : SolidComparison or None
        The solid against the nominal CAD.
    stages_s : dict of str to float
    """

    part: VirtualPart | None
    model: Variant
    comparison: SolidComparison | None
    stages_s: dict[str, float]


def machine_part(
    job_path: Job | str | Path,
    *,
    model: Variant = Variant.ABBE,
    variants: Sequence[Variant] = (Variant.NONE, Variant.ABBE),
    prefer_measured: bool = False,
    solid: bool | None = None,
    plan: Plan | None = None,
    meanwhile: Callable[[PartInspection], None] | None = None,
    progress: Progress = silent,
) -> MachinedPart:
    """Machine the job's part virtually and inspect it.

    Parameters
    ----------
    job_path : Job or path
        A job, its file, or its folder.
    model : Variant
        Error model that the solid is cut with.
    variants : sequence of Variant
        Error models to inspect, side by side.
    prefer_measured : bool
        Inspect the measured points of the job, where it has them, and not the nominal CAD.
    solid : bool, optional
        Whether to cut the solid; by default for programs of up to `SOLID_MOVES` moves. The
        deviations come from the exact engine, with or without it.
    plan : Plan, optional
        Draws for the values that the drawing asks for; to first order where left out.
    meanwhile : callable, optional
        Called with what the inspection found while the solid is being cut.
    progress : Progress

    Raises
    ------
    InputError, gcode.ProgramError, stock.StockError

    Examples
    --------
    >>> from dataclasses import replace
    >>> import vmach
    >>> job = vmach.read_job("samples/freecad_pocket")
    >>> job = replace(job, inspection=replace(job.inspection, spacing_mm=12.0))
    >>> found = vmach.machine_part(job, solid=False)
    >>> [column.name for column in found.points.columns]
    ['none', 'abbe']
    """
    clock = StageClock(progress)
    job = read_job(job_path)
    if solid is not False:
        _check_blank(job)
    ready = _displaced(job, (*variants, model), clock)
    preparation = ready.preparation
    moves = len(preparation.program.moves)
    is_left_out = solid is None and moves > SOLID_MOVES
    is_cut = solid or (solid is None and not is_left_out)
    part = comparison = None
    with ready.cut_aside(model) if is_cut else nullcontext() as cut:
        found = _inspected(ready, variants, plan, clock, prefer_measured=prefer_measured)
        with clock.stage("collide") as step:
            collisions = ready.collisions(model, step)
        if meanwhile is not None:
            with clock.stage("draw"):
                meanwhile(found)
        if cut is not None:
            with clock.stage("cut") as step:
                part = cut.part(step)
    if part is not None and found.nominal is not None:
        with clock.stage("solids"):
            limit_mm = job.inspection.difference_mm
            comparison = compare_solids(preparation, part, found.nominal, limit_mm)
    return MachinedPart(
        job=job,
        preparation=found.preparation,
        points=found.points,
        states=found.states,
        budget=found.budget,
        part=part,
        nominal=found.nominal,
        model=model,
        comparison=comparison,
        stages_s=clock.seconds,
        notes=(
            *collision_notes(found.preparation, collisions),
            *comparison_notes(comparison),
            *([_no_solid_note(moves)] if is_left_out else []),
            *([_joined_note(part.joined_mm)] if part is not None and part.joined_mm else []),
            *found.notes,
        ),
        features=found.features,
        circular_tests=found.circular_tests,
    )


def inspect_part(
    job_path: Job | str | Path,
    *,
    variants: Sequence[Variant] = (Variant.NONE, Variant.ABBE),
    prefer_measured: bool = False,
    plan: Plan | None = None,
) -> PartInspection:
    """Inspect the part that a job makes: deviations of its surface, without a solid.

    Parameters
    ----------
    job_path : Job or path
    variants : sequence of Variant
        Error models to inspect, side by side.
    prefer_measured : bool
        Inspect the measured points of the job, where it has them, and not the nominal CAD.
    plan : Plan, optional
        Draws for the values that the drawing asks for; to first order where left out.

    Raises
    ------
    InputError, gcode.ProgramError, stock.StockError
    """
    clock = StageClock(silent)
    ready = _displaced(job_path, variants, clock)
    return _inspected(ready, variants, plan, clock, prefer_measured=prefer_measured)


@dataclass(frozen=True)
class _Displaced:
    """All that cutting needs.

    Attributes
    ----------
    job, preparation
        As of `PartInspection`.
    effects : tuple of EffectInstance
    sweeps : dict of Variant to Sweeps
        Those that are kept: long paths are displaced as they are asked for.
    """

    job: Job
    effects: tuple[EffectInstance, ...]
    preparation: Preparation
    sweeps: dict[Variant, Sweeps]

    def of(self, variant: Variant) -> Sweeps:
        """The sweeps of one variant."""
        if variant in self.sweeps:
            return self.sweeps[variant]
        return displaced_sweeps(self.preparation, variant, self.effects)

    def cut_aside(self, model: Variant) -> CutAside:
        """The solid, in a process of its own."""
        return CutAside(self.of(model), self.preparation.cutters, self.job.blank.solid)

    def collisions(
        self, model: Variant, progress: Callable[[int, int], None]
    ) -> tuple[Collision, ...]:
        """Nothing can be said of a job without a blank."""
        if self.job.blank is None:
            return ()
        return job_collisions(self.preparation, self.of(model), progress=progress)


def _displaced(
    job_path: Job | str | Path, variants: Sequence[Variant], clock: StageClock
) -> _Displaced:
    """Read the job, and displace its path by every variant."""
    with clock.stage("read"):
        job = read_job(job_path)
        effects = read_effects(job.effects, file=job.path, job=job)
        preparation = prepare(job)
    with clock.stage("displace"):
        is_long = not effects and len(preparation.program.moves) > SOLID_MOVES
        kept = () if is_long else dict.fromkeys(variants)
        sweeps = {v: displaced_sweeps(preparation, v, effects) for v in kept}
    return _Displaced(job, effects, preparation, sweeps)


def _inspected(
    ready: _Displaced,
    variants: Sequence[Variant],
    plan: Plan | None,
    clock: StageClock,
    *,
    prefer_measured: bool,
) -> PartInspection:
    """Compare the surface with the nominal one, under every variant."""
    job, preparation, effects = ready.job, ready.preparation, ready.effects
    with clock.stage("read"):
        nominal = read_nominal(job.nominal, job.nominal_unit) if job.nominal else None
        points = surface_points(job, nominal, prefer_measured=prefer_measured)
        if points.measured_mm is not None:
            check_file(points, job.measured)
            check_aligned(points, seat_of(points), job.measured)
    with clock.stage("compare") as step:
        predictions: list[Prediction] = []
        for variant in variants:
            predictions.append(
                predict_surface(
                    preparation, points, variant, effects, sweeps=ready.sweeps.get(variant)
                )
            )
            step(len(predictions), len(variants))
        in_mm: tuple[Note, ...] = ()
        if points.measured_mm is None:
            check_some_cut(job, points, predictions[-1])
        else:
            is_cut = predictions[-1].is_cut
            check_cut(preparation, points, int(is_cut.sum()), path=job.measured)
            in_mm = check_unit_of_points(preparation, points, is_cut, job.measured)
    inspected, notes = inspected_points(job, points, predictions)
    budget = error_budget(predictions[-1], effects)
    features: tuple[FeatureResult, ...] = ()
    doubts: tuple[Note, ...] = ()
    has_pmi = nominal is not None and bool(nominal.pmi) and job.drawing.reads_pmi
    if job.drawing.tolerances or has_pmi:
        with clock.stage("features") as step:
            features, doubts = _features(
                job, nominal, points, inspected, predictions[-1], budget, plan, step
            )
    return PartInspection(
        job=job,
        preparation=preparation,
        points=with_causes(inspected, budget),
        states=predictions[-1].states,
        budget=budget,
        nominal=nominal,
        notes=(*preparation.notes, *_assumptions(job), *points.notes, *in_mm, *notes, *doubts),
        features=features,
        circular_tests=job_circular_tests(job, preparation, variants[-1], effects),
    )


def _features(job: Job, *found) -> tuple[tuple[FeatureResult, ...], tuple[Note, ...]]:
    """What the drawing asks for; jobs without one do not wait for its modules."""
    from vmach.run.feature_results import feature_results

    return feature_results(job, *found)


def _assumptions(job: Job) -> tuple[Note, ...]:
    """What was assumed of the machine; what is doubtful stands in the preparation's notes."""
    assumed = [note for note in machine_notes(job.machine) if note.level is Level.NOTE]
    return in_file(assumed, job.machine_path)


def _no_solid_note(moves: int) -> Note:
    said = (
        f"no solid was cut: the program has {moves} moves, more than {SOLID_MOVES}; the deviations "
        "come from the exact engine all the same ('--solid' cuts it)"
    )
    return Note.plain(Kind.SOLID, said, moves, "1")


def _joined_note(joined_mm: float) -> Note:
    said = (
        f"solid: moves within {um_from_mm(joined_mm):g} um of one line were cut as one, as there "
        "are very many; the deviations come from the exact engine, move by move"
    )
    return Note.plain(Kind.SOLID, said, joined_mm, "mm")


def _check_blank(job: Job) -> None:
    """Refuse a job without the blank that the virtual part is cut from."""
    if job.blank is None:
        raise InputError(
            "the virtual part needs a blank",
            file=job.path,
            accepted="[stock] with min_mm and max_mm, or file",
            hint="--no-solid inspects the surface without a virtual part",
        )


def predict_points(
    job_path: Job | str | Path,
    points_path: SurfacePoints | str | Path,
    *,
    program_path: str | Path | None = None,
    variant: Variant = Variant.ABBE,
    progress: Progress = silent,
) -> tuple[SurfacePoints, Prediction]:
    """Predicted deviation at given surface points, of the job's program or of another.

    Raises
    ------
    InputError, gcode.ProgramError, stock.StockError
    """
    clock = StageClock(progress)
    with clock.stage("read"):
        job = read_job(job_path)
        effects = read_effects(job.effects, file=job.path, job=job)
        points = points_path
        if not isinstance(points, SurfacePoints):
            points = read_points_csv(points)
        preparation = prepare(job, program_path=Path(program_path) if program_path else None)
    with clock.stage("predict"):
        prediction = predict_surface(preparation, points, variant, effects)
    return points, prediction
