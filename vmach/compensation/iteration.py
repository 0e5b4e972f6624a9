"""Fixed-point iteration: programs are written, read back and run until the tool is there.

Source: S. Banach's fixed-point theorem: q = q_nominal - e(q) converges where e changes by less
than one part in one; Bhattacharyya, Adv. Ind. Manuf. Eng. 5 (2022) 100089, compensation by -e.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gcode import MoveKind
from vmach.base.memory import give_back_free_memory
from vmach.compensation.aim.path_shift import PathShift
from vmach.compensation.model import TipModel
from vmach.compensation.pieces.arcs import LARGEST_SWEEP_RAD
from vmach.compensation.pieces.plan import Plan
from vmach.compensation.pieces.planning import plan_pieces
from vmach.compensation.pieces.sampling import sample_error
from vmach.compensation.residual import Residual
from vmach.compensation.written_run import LONG, WrittenRun
from vmach.errors import InputError
from vmach.path.geometry import position_at
from vmach.path.preparation import Preparation
from vmach.program_text import Expanded, Rewriter, Target, Written

__all__ = ["Iteration", "Solution"]

#: the iteration ends when the tool is this close to its aim, or after so many rounds
_CLOSE_MM = 2e-6
_ROUNDS = 6
#: so often pieces that leave too much are cut once more
_REFINEMENTS = 5
#: so often the whole program is planned
_ATTEMPTS = 4
#: share of the tolerance that points are planned with at first
_ROOM = 0.97
#: pieces are cut no shorter than this
_SHORTEST_MM = 0.05
#: resolution of the program that is iterated on
_FINE_MM = 1e-7


@dataclass(frozen=True)
class Solution:
    """A plan, its corrections, and what they leave before rounding."""

    plan: Plan
    target: Target
    run: WrittenRun
    residual: Residual


@dataclass
class Iteration:
    """Finds the q of q + e(q) = q_nominal for the pieces of a plan.

    Every round writes the program, reads it back and runs it through the model, so direction
    memory, time and feeds are those of the compensated program itself. A correction that turns
    an axis back changes its error by the lost motion, at once: such places get a step, and
    pieces that leave too much are halved.

    Attributes
    ----------
    preparation : Preparation
        The nominal program, in plain blocks.
    rewriter : Rewriter
    model : TipModel
    expansion : Expanded
        Where the lines of the plain blocks come from.
    check : callable
        Called with every target; refuses one that must not be written.
    progress : callable
        Called with rounds done and expected.
    shift : PathShift, optional
        Where the tool shall be beside the nominal path; on it without.
    done : int
        Rounds so far.
    stuck : (M, 3) bool
        Axes, for every move, that have no word in their block and may not get one.
    """

    preparation: Preparation
    rewriter: Rewriter
    model: TipModel
    expansion: Expanded
    check: Callable[[Target], None]
    progress: Callable[[int, int], None]
    shift: PathShift | None = None
    done: int = 0

    def __post_init__(self) -> None:
        """Find the axes that are stuck, and refuse arcs that would have to be divided blindly."""
        rewriter, moves = self.rewriter, self.preparation.path.nodes.moves
        far = np.abs(moves.sweep_rad) > LARGEST_SWEEP_RAD
        for move in np.flatnonzero(rewriter.unknown_start & far)[:1]:
            raise InputError(
                f"an arc of {np.degrees(abs(moves.sweep_rad[move])):.4g} degrees begins at "
                "a position that the program does not state",
                file=self.preparation.program.path,
                line=int(self.expansion.user_line(moves.line[move])),
                accepted=f"arcs of at most {np.degrees(LARGEST_SWEEP_RAD):g} degrees, which need "
                "not be divided",
                hint="name X, Y and Z in blocks before it",
            )
        self.stuck = np.zeros((len(moves), 3), bool)
        incomplete = ~rewriter.programmed.all(axis=1) & (moves.kind != MoveKind.DWELL)
        for move in np.flatnonzero(incomplete):
            named = {word.letter for word in rewriter.text.words(int(moves.line[move]))}
            self.stuck[move] = ~rewriter.programmed[move] & [axis not in named for axis in "XYZ"]
            if rewriter.angle[move] != 0.0:
                self.stuck[move, :2] |= self.stuck[move, :2].any()

    def solve(self, used: np.ndarray, tolerance_mm: float) -> Solution:
        """Plan and corrections that leave no more than a tolerance, where that can be.

        Parameters
        ----------
        used : (M,) int64
            Moves that may be rewritten.
        tolerance_mm : float

        Raises
        ------
        InputError
            From `check`, or the program is refused when it is read back.
        """
        return self._best_refined(self._planned(used, tolerance_mm), tolerance_mm)

    def solve_again(self, plan: Plan, target: Target, tolerance_mm: float) -> Solution:
        """A plan solved once more, for another `shift`.

        Parameters
        ----------
        plan : Plan
        target : Target
            Corrections to begin with.
        tolerance_mm : float
        """
        found = self._rounds(plan, target.ends_mm - plan.aim_mm, target.middles_mm)
        return self._best_refined(found, tolerance_mm)

    def _best_refined(self, best: Solution, tolerance_mm: float) -> Solution:
        """Pieces that leave too much cut once more, as long as that helps."""
        for _ in range(_REFINEMENTS):
            refined = self._refined(best, tolerance_mm)
            if refined is None:
                break
            found = self._rounds(*refined)
            if found.residual.largest_mm >= best.residual.largest_mm:
                break
            best = found
        return best

    def _planned(self, used: np.ndarray, tolerance_mm: float) -> Solution:
        """Planned along the nominal path; moves that turn out a little worse get less room."""
        moves, rewriter = self.preparation.path.nodes.moves, self.rewriter
        room = np.full(len(moves), _ROOM * tolerance_mm)
        along = None
        for _ in range(_ATTEMPTS):
            if along is None:
                along = sample_error(moves, used, self._nominal_error, tolerance_mm=tolerance_mm)
            plan = plan_pieces(moves, along, self._nominal_error, tolerance_mm=room[used],
                               rewritten=rewriter.rewritten[used],
                               unknown_start=rewriter.unknown_start[used])  # fmt: skip
            if len(moves) > LONG:
                along = None  # samples of a long program are rather found once more
            give_back_free_memory()
            found = self._rounds(plan, *self._first_guess(plan))
            left = np.zeros(len(moves))
            np.maximum.at(left, plan.move, found.run.residual_of_pieces[0])
            over = (left > tolerance_mm) & (left < 2.0 * tolerance_mm)
            if not over.any():
                break
            room[over] *= _ROOM * tolerance_mm / left[over]
        return found

    def _nominal_error(self, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
        """Tool minus the place where it shall be, on the nominal path."""
        error = self.model.error_at(self.preparation, move, parameter)
        if self.shift is not None:
            error = error - self.shift.at(move, parameter)
        if self.stuck.any():
            error[self.stuck[move]] = 0.0
        return error

    def write(self, target: Target, resolution_mm: float) -> Written:
        """The text of a target."""
        return self.rewriter.write(target, resolution_mm)

    def run(self, plan: Plan, written: Written) -> WrittenRun:
        """What the model makes of a text."""
        return WrittenRun.of(
            self.preparation,
            written,
            plan,
            model=self.model,
            expansion=self.expansion,
            programmed=self.rewriter.programmed,
            unknown_start=self.rewriter.unknown_start,
            stuck=self.stuck,
            shift=self.shift,
        )

    def _first_guess(self, plan: Plan) -> tuple[np.ndarray, np.ndarray]:
        """Corrections at ends and middles by the error on the nominal path, (K, 3) mm each."""
        ends = np.where(plan.is_kept[:, None], 0.0, self._nominal_error(plan.move, plan.answered))
        return -ends, -self._nominal_error(plan.move, plan.parameter(0.5))

    def _rounds(self, plan: Plan, ends: np.ndarray, middles: np.ndarray) -> Solution:
        best: tuple[float, Target, WrittenRun] | None = None
        ends = ends + plan.aim_mm
        for _ in range(_ROUNDS):
            target = Target(plan.pieces, self._within_travel(plan, ends), middles.copy())
            self.check(target)
            self.done += 1
            self.progress(self.done, max(self.done + 1, 2 * _ROUNDS))
            run = self.run(plan, self.write(target, _FINE_MM))
            end = self._end_miss(run) - plan.aim_mm[run.written]
            middle = run.miss_of_middles()
            stuck = self.stuck[plan.move[run.written]]
            end[stuck] = middle[stuck] = end[plan.is_kept[run.written]] = 0.0
            cuts = run.cuts
            off = float(np.linalg.norm(end[cuts], axis=1).max(initial=0.0))
            if best is None or off < best[0]:
                best = off, target, run
            if off <= _CLOSE_MM:
                break
            ends[run.written] -= end
            middles[run.written] -= middle
        assert best is not None
        return Solution(plan, best[1], best[2], best[2].residual)

    def _end_miss(self, run: WrittenRun) -> np.ndarray:
        """Tool minus nominal position at the ends of the written pieces, (K, 3) mm.

        A step's end answers for the piece after it, where the error is there in full.
        """
        miss, plan = run.miss(1.0), run.plan
        following = np.flatnonzero(np.diff(run.written) == 1)
        steps = following[plan.is_step[run.written[following]]]
        miss[steps] = run.miss(plan.ready[run.written[steps + 1]], steps + 1)
        return miss

    def _refined(
        self, found: Solution, tolerance_mm: float
    ) -> tuple[Plan, np.ndarray, np.ndarray] | None:
        """The plan with pieces that leave too much cut or stepped into; None for none."""
        plan, run = found.plan, found.run
        left, at_start, ready = run.residual_of_pieces
        moves = self.preparation.path.nodes.moves
        span = plan.last - plan.first
        length = span * self.rewriter.length_mm[plan.move]
        can_step = ~plan.is_step
        can_step[1:] &= ~plan.is_step[:-1]
        cuts = moves.kind[plan.move] != MoveKind.RAPID
        step = cuts & can_step & (np.linalg.norm(at_start, axis=1) > tolerance_mm)
        split = cuts & ~step & (left > tolerance_mm) & (length > 2 * _SHORTEST_MM)
        if not (step.any() or split.any()):
            return None
        refined, origin = plan.refined(split, step, ready)
        ends, middles = self._first_guess(refined)
        kept = origin >= 0
        ends[kept] = found.target.ends_mm[origin[kept]] - plan.aim_mm[origin[kept]]
        whole = kept & ~split[np.maximum(origin, 0)]
        middles[whole] = found.target.middles_mm[origin[whole]]
        new_steps = np.flatnonzero(refined.is_step & ~kept)
        before = found.target.ends_mm[np.maximum(-1 - origin[new_steps] - 1, 0)]
        ends[new_steps] = before - at_start[-1 - origin[new_steps]]
        return refined, ends, middles

    def _within_travel(self, plan: Plan, ends_mm: np.ndarray) -> np.ndarray:
        """Corrections of rapids cut off where the travel ends; those of feed moves stay."""
        moves = self.preparation.path.nodes.moves
        low, high = self.preparation.job.machine.travel_mm
        nominal = position_at(moves, plan.move, plan.last)
        inside = np.clip(nominal + ends_mm, low, high) - nominal
        return np.where((moves.kind[plan.move] == MoveKind.RAPID)[:, None], inside, ends_mm)
