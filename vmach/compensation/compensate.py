"""The user's program in, the program moved against the predicted error out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from gcode import MoveKind
from vmach.base.memory import give_back_free_memory
from vmach.base.note import Note
from vmach.compensation.aim.part_aim import PartAim, aim_at_part
from vmach.compensation.aim.part_view import PartView
from vmach.compensation.doubt_comment import with_doubts
from vmach.compensation.grid.part_rounding import round_program
from vmach.compensation.iteration import Iteration, Solution
from vmach.compensation.model import TipModel
from vmach.compensation.residual import Residual
from vmach.compensation.safety import check_corrections, check_part, check_result
from vmach.compensation.uncorrected import answered_once, uncorrected
from vmach.job import Job
from vmach.machine import Variant
from vmach.nominal.points import SurfacePoints
from vmach.path.preparation import Preparation, prepare
from vmach.prediction import ActingEffect
from vmach.program_text import (
    LineModes,
    Rewriter,
    block_modes,
    check_meaning,
    check_words,
    prepare_plain,
    target_control,
)

__all__ = ["Compensation", "Solved", "compensate", "finish", "solve"]


@dataclass(frozen=True)
class Compensation:
    """A compensated program and what re-reading it found.

    Attributes
    ----------
    text : bytes
        The program, at the target's resolution.
    before, unrounded, after : Residual
        Of the original program, of the compensated one before rounding, and of `text`.
    largest_correction_mm : float
    growth : float
        Blocks of `text` over blocks of the original.
    arcs, arcs_kept : int
        Arcs of the program, and those of them that are written as arcs only.
    left_lines : tuple of int
        Lines that stay because their positions are the machine's own (G53, G28, G30).
    swallowed : int
        Words that need no change because the correction is below the resolution.
    expanded_lines : mapping of int to str
        Lines of the program that were written out in plain blocks, and why.
    uncorrected : mapping of int to (float, str)
        Lines that keep more than the tolerance before rounding: how much, mm, and why.
    steps : int
        Inserted blocks that only take up a jump of the error, as by lost motion.
    tilt_rad : float
        Largest tilt of the tool while it cuts, which stays.
    part_aim : PartAim, optional
        Of a program that is aimed at the part.
    notes : tuple of Note
        What the user should know of the program before trusting the figures.
    """

    text: bytes
    before: Residual
    unrounded: Residual
    after: Residual
    largest_correction_mm: float
    growth: float
    arcs: int
    arcs_kept: int
    left_lines: tuple[int, ...]
    swallowed: int
    expanded_lines: Mapping[int, str] = field(default_factory=dict)
    uncorrected: Mapping[int, tuple[float, str]] = field(default_factory=dict)
    steps: int = 0
    tilt_rad: float = 0.0
    part_aim: PartAim | None = None
    notes: tuple[Note, ...] = ()


@dataclass(frozen=True)
class Solved:
    """A compensated program before rounding.

    Attributes
    ----------
    iteration : Iteration
        With the shift of the path that is aimed at.
    solution : Solution
    view : PartView, optional
        Of the surface to round for.
    part_aim : PartAim, optional
    """

    iteration: Iteration
    solution: Solution
    view: PartView | None
    part_aim: PartAim | None


def compensate(
    job: Job,
    effects: Sequence[ActingEffect] = (),
    *,
    variant: Variant = Variant.ABBE,
    resolution_mm: float = 1e-3,
    tolerance_mm: float = 1e-4,
    limit_mm: float = 0.5,
    residual_limit_mm: float = 5e-3,
    dialect: str | None = None,
    aim_points: SurfacePoints | None = None,
    round_points: SurfacePoints | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Compensation:
    """Move the job's program against the predicted error of the tool.

    The position to program is the q of q + e(q) = q_nominal for the tip, see `Iteration`. The
    tilt of the tool remains; three axes cannot correct it. Aimed at the part, the tip is asked
    beside its nominal path instead, where what tilt and effects at the cutting edge leave on the
    surface is least, see `aim_at_part`.

    Parameters
    ----------
    job : Job
    effects : sequence of ActingEffect
    variant : Variant
    resolution_mm : float
        Of the target control; in inch programs one decimal more.
    tolerance_mm : float
        Largest residual before rounding; points are inserted where it would be larger.
    limit_mm : float
        Largest correction accepted.
    residual_limit_mm : float
        Largest distance of the tool from its path that the written program may leave.
    dialect : str, optional
        Control that the program is written for (`CONTROLS`); by default the one whose dialect
        it is written in.
    aim_points : SurfacePoints, optional
        Surface to aim at; without it the tool is kept on its nominal path.
    round_points : SurfacePoints, optional
        Surface that decides between points of the control's grid; by default the one that is
        aimed at, without either the path does.
    progress : callable, optional
        Called with rounds done and expected.

    Raises
    ------
    InputError, gcode.ProgramError
        The program cannot be read or rewritten, a correction or what remains exceeds its limit,
        or the compensated program leaves the travel.
    """
    solved = solve(job, effects, variant=variant, tolerance_mm=tolerance_mm, limit_mm=limit_mm,
                   dialect=dialect, aim_points=aim_points, round_points=round_points,
                   progress=progress)  # fmt: skip
    if solved is None:
        return _unchanged(prepare(job), TipModel(variant, tuple(effects)))
    return finish(solved, resolution_mm=resolution_mm, tolerance_mm=tolerance_mm,
                  residual_limit_mm=residual_limit_mm)  # fmt: skip


def finish(
    solved: Solved, *, resolution_mm: float = 1e-3, tolerance_mm: float = 1e-4,
    residual_limit_mm: float = 5e-3,
) -> Compensation:  # fmt: skip
    """The second part of `compensate`, with its parameters: rounds, reads back and checks."""
    iteration, found, part_aim = solved.iteration, solved.solution, solved.part_aim
    preparation, expansion = iteration.preparation, iteration.expansion
    rounded = round_program(iteration, found, resolution_mm, solved.view)
    written, run = rounded.written, rounded.run
    check_result(preparation, run, residual_limit_mm, expansion)
    if part_aim is not None and rounded.part is not None:
        check_part(preparation, part_aim, rounded.part, residual_limit_mm, expansion)
    arcs, kept = _arcs(preparation, found)
    modes = iteration.rewriter.modes
    before, tilt_rad = _before(preparation, iteration.model)
    return Compensation(
        text=with_doubts(written.text, preparation.doubts, preparation.program.dialect),
        before=before.told_in(expansion),
        unrounded=found.residual.told_in(expansion),
        after=run.residual.told_in(expansion),
        largest_correction_mm=float(np.linalg.norm(found.target.ends_mm, axis=1).max(initial=0.0)),
        growth=1.0 + written.inserted / max(len(modes), 1),
        arcs=arcs,
        arcs_kept=kept,
        left_lines=tuple(expansion.user_line(modes.left_lines()).tolist()),
        swallowed=written.swallowed,
        expanded_lines=expansion.reasons,
        uncorrected=uncorrected(iteration, found, tolerance_mm),
        steps=int(found.plan.is_step.sum()),
        tilt_rad=tilt_rad,
        part_aim=part_aim,
        notes=(*preparation.notes, *(answered_once(iteration.model.effects) if part_aim else ())),
    )


def solve(
    job: Job, effects: Sequence[ActingEffect] = (), *, variant: Variant = Variant.ABBE,
    tolerance_mm: float = 1e-4, limit_mm: float = 0.5, dialect: str | None = None,
    aim_points: SurfacePoints | None = None, round_points: SurfacePoints | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Solved | None:  # fmt: skip
    """The first part of `compensate`, with its parameters; None where there is nothing to do."""
    model = TipModel(variant, tuple(effects))
    give_back_free_memory()  # what the search for a surface took
    preparation = prepare(job)
    control = target_control(preparation.program.dialect, dialect, file=preparation.program.path)
    check_meaning(preparation.program, control)
    if model.is_none(preparation) and aim_points is None:
        return None
    preparation, expansion = prepare_plain(preparation, floating_tap=control.floating_tap)
    check_words(preparation.program, control)
    modes = block_modes(preparation.program)
    rewriter = Rewriter(preparation.program, modes, expansion.written, control)
    preparation = replace(preparation, program=rewriter.program)
    iteration = Iteration(
        preparation,
        rewriter,
        model,
        expansion,
        lambda target: check_corrections(preparation, target, limit_mm, expansion),
        progress,
    )
    found = iteration.solve(_rewritable(preparation, modes), tolerance_mm)
    points = round_points if aim_points is None else aim_points
    view = None if points is None else PartView(preparation, model, points)
    part_aim = None
    if aim_points is not None:
        found, part_aim = aim_at_part(iteration, found, view, tolerance_mm=tolerance_mm)
    return Solved(iteration, found, view, part_aim)


def _rewritable(preparation: Preparation, modes: LineModes) -> np.ndarray:
    """Moves that may be rewritten, (M,) int64."""
    moves = preparation.path.nodes.moves
    left = np.isin(moves.line, modes.left_lines())
    return np.flatnonzero((moves.kind != MoveKind.DWELL) & ~left)


def _arcs(preparation: Preparation, found: Solution) -> tuple[int, int]:
    """Arcs of the program, and how many of them stay arcs all along."""
    kind = preparation.path.nodes.moves.kind
    pieces = found.plan.pieces
    arcs = np.unique(pieces.move[kind[pieces.move] == MoveKind.ARC])
    broken = pieces.move[~(pieces.is_arc | pieces.kept | pieces.is_step)]
    return len(arcs), len(np.setdiff1d(arcs, broken))


def _unchanged(preparation: Preparation, model: TipModel) -> Compensation:
    """The user's bytes: there is nothing to correct."""
    before, _ = _before(preparation, model)
    arcs = int((preparation.path.nodes.moves.kind == MoveKind.ARC).sum())
    return Compensation(
        text=preparation.program.source.data,
        before=before,
        unrounded=before,
        after=before,
        largest_correction_mm=0.0,
        growth=1.0,
        arcs=arcs,
        arcs_kept=arcs,
        left_lines=(),
        swallowed=0,
        notes=preparation.notes,
    )


def _before(preparation: Preparation, model: TipModel) -> tuple[Residual, float]:
    """What the user's program leaves, and the largest angle, rad, of the tool while it cuts."""
    nodes = preparation.path.nodes
    rows = np.flatnonzero(nodes.moves.kind[nodes.move] != MoveKind.RAPID)
    error = model.displacement_at(preparation, nodes.move[rows], nodes.parameter[rows])
    tilt_rad = np.linalg.norm(error.tilt_rad, axis=1).max(initial=0.0)
    return Residual.of(np.linalg.norm(error.shift_mm, axis=1), nodes.line[rows]), float(tilt_rad)
