"""The program aimed at the part: its path shifted so that the surface is centred."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vmach.compensation.iteration import Iteration, Solution
from vmach.compensation.path_shift import PathShift, no_shift
from vmach.compensation.pieces import Piece
from vmach.compensation.plan import Plan
from vmach.compensation.rewriting import Target
from vmach.compensation.shift_fit import SurfaceDemand, centred
from vmach.compensation.written_run import WrittenRun
from vmach.machine import Variant
from vmach.points import SurfacePoints
from vmach.prediction import Prediction, predict

__all__ = ["PartAim", "PartDeviation", "aim_at_part"]

#: so often the part is predicted and the path shifted
_ROUNDS = 4
#: norm of the deviations by which rounds are compared
_NORM = 6
#: deviations smaller than this are none
_NOTHING_MM = 1e-9
#: pieces that are shifted by less stay as they are
_STAYS_MM = 1e-7


@dataclass(frozen=True)
class PartDeviation:
    """Deviation of surface points, and what made them.

    Attributes
    ----------
    row : (Q,) int64
        Rows of the points that every program cuts.
    error_mm : (Q,) float64
        Along the outward normal, beyond that of the perfect program.
    move : (Q,) int64
        Nominal moves.
    parameter : (Q,) float64
        Places on them.
    """

    row: np.ndarray
    error_mm: np.ndarray
    move: np.ndarray
    parameter: np.ndarray

    @property
    def largest_mm(self) -> float:
        """Largest size; 0 without points."""
        return float(np.abs(self.error_mm).max(initial=0.0))

    @property
    def mean_mm(self) -> float:
        """Mean size; 0 without points."""
        return float(np.abs(self.error_mm).mean()) if len(self.error_mm) else 0.0

    @property
    def norm_mm(self) -> float:
        """Mean that large deviations govern."""
        return float((np.abs(self.error_mm) ** _NORM).mean() ** (1.0 / _NORM))


@dataclass(frozen=True)
class PartAim:
    """What aiming at the part found, on the points that it was aimed at, before rounding.

    Attributes
    ----------
    shift : PathShift
    tool, part : PartDeviation
        With the tool on its nominal path, and with the path shifted.
    rounds : int
        Of the shift that was kept; 0 where the nominal path is best.
    """

    shift: PathShift
    tool: PartDeviation
    part: PartDeviation
    rounds: int

    @property
    def largest_shift_mm(self) -> float:
        """Largest shift of a knot."""
        return float(np.linalg.norm(self.shift.value_mm, axis=1).max(initial=0.0))


def aim_at_part(
    iteration: Iteration, found: Solution, points: SurfacePoints, *, tolerance_mm: float
) -> tuple[Solution, PartAim]:
    """Shift the path so that the predicted part is centred on the nominal one.

    Parameters
    ----------
    iteration : Iteration
        Left with the shift that is found.
    found : Solution
        With the tool on its nominal path.
    points : SurfacePoints
        Surface that is aimed at.
    tolerance_mm : float
        Of the tool, from where it shall be.
    """
    look = _part_looker(iteration, points)
    moves = iteration.preparation.path.nodes.moves
    shift = no_shift(moves, found.plan, iteration.rewriter.said & ~iteration.stuck)
    before = now = best = look(found.run)
    kept, rounds, demand = (found, shift), 0, None
    for number in range(1, _ROUNDS + 1):
        if now.largest_mm < _NOTHING_MM:
            break
        demand = _demand(shift, now, points).beside(demand)
        old, shift = shift, centred(shift, demand)
        iteration.shift = shift
        found = iteration.solve_again(*_shifted(found, old, shift), tolerance_mm)
        now = look(found.run)
        if now.norm_mm < best.norm_mm:
            best, kept, rounds = now, (found, shift), number
    found, iteration.shift = kept
    return found, PartAim(kept[1], before, best, rounds)


def _part_looker(
    iteration: Iteration, points: SurfacePoints
) -> Callable[[WrittenRun], PartDeviation]:
    """What tells the deviation of the part that a written program cuts."""
    model = iteration.model

    def predicted(preparation, rows, variant, effects) -> Prediction:
        return predict(preparation, points.point_mm[rows], points.normal[rows],
                       variant=variant, effects=effects)  # fmt: skip

    everywhere = np.arange(len(points.point_mm))
    perfect = predicted(iteration.preparation, everywhere, Variant.NONE, ())
    made = np.flatnonzero(perfect.is_cut)

    def look(run: WrittenRun) -> PartDeviation:
        found = predicted(run.again, made, model.variant, model.effects)
        cut = np.flatnonzero(found.is_cut)
        piece = np.full(len(run.again.path.nodes.moves), -1)
        piece[run.row] = run.written
        piece = piece[found.states.move]
        start, end = run.plan.parameter(0.0)[piece], run.plan.parameter(1.0)[piece]
        known = piece >= 0
        error = found.deviation_mm[cut] - perfect.deviation_mm[made[cut]]
        place = start + found.states.parameter * (end - start)
        return PartDeviation(
            made[cut][known], error[known], run.plan.move[piece][known], place[known]
        )

    return look


def _demand(shift: PathShift, now: PartDeviation, points: SurfacePoints) -> SurfaceDemand:
    """What the deviations under the present shift ask for."""
    normal = points.normal[now.row]
    present = np.einsum("ij,ij->i", shift.at(now.move, now.parameter), normal)
    return SurfaceDemand(now.row, now.move, now.parameter, normal, present - now.error_mm)


def _shifted(found: Solution, old: PathShift, new: PathShift) -> tuple[Plan, Target]:
    """The plan for another shift, and corrections to begin with.

    Blocks that stayed as they were are written where the shift moves them.
    """
    asked = np.abs(new.value_mm).max(axis=1) > _STAYS_MM
    moved = np.concatenate([asked, [False]])[new.knot].any(axis=1)
    stretches: dict[int, list[int]] = {}
    for stretch in np.flatnonzero(np.isin(new.move, new.move[moved])).tolist():
        stretches.setdefault(int(new.move[stretch]), []).append(stretch)
    pieces: list[Piece] = []
    origin: list[int] = []
    for k, piece in enumerate(found.plan.pieces):
        if piece.kept and piece.move in stretches:
            parts = stretches[piece.move]
            pieces += [
                Piece(piece.move, float(new.start[s]), float(new.end[s]), bool(new.is_arc[s]))
                for s in parts
            ]
            origin += [-1] * (len(parts) - 1) + [k]
        else:
            pieces.append(piece)
            origin.append(k)
    old_piece = np.array(origin)
    known = (old_piece >= 0)[:, None]

    def carried(values: np.ndarray) -> np.ndarray:
        return np.where(known, values[np.maximum(old_piece, 0)], 0.0)

    plan = Plan(pieces, carried(found.plan.aim_mm))

    def further(share: float) -> np.ndarray:
        place = plan.move, plan.parameter(share)
        return new.at(*place) - old.at(*place)

    target = found.target
    return plan, Target(
        pieces, carried(target.ends_mm) + further(1.0), carried(target.middles_mm) + further(0.5)
    )
