"""The program aimed at the part: its path shifted so that the surface is centred.

Source: closed form derived here: shifts that centre the deviations; the fit is in `shift_fit`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.compensation.aim.part_view import PartDeviation, PartView
from vmach.compensation.aim.path_shift import PathShift, no_shift
from vmach.compensation.aim.shift_fit import centred
from vmach.compensation.aim.surface_demand import SurfaceDemand
from vmach.compensation.iteration import Iteration, Solution
from vmach.compensation.pieces.plan import Plan
from vmach.program_text import Pieces, Target

__all__ = ["PartAim", "aim_at_part"]

#: so often the part is predicted and the path shifted
_ROUNDS = 4
#: a round that leaves more than this share of what the best one left is the last
_BETTER = 0.99
#: nor is one kept that leaves a largest deviation of more than this times that without a shift
_WORSE = 1.2
#: what asks for smaller shifts asks for none
_NOTHING_MM = 1e-9
#: pieces that are shifted by less stay as they are
_STAYS_MM = 1e-7


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
        """Largest shift of the path."""
        return float(self.shift_of_moves().max(initial=0.0))

    def shift_of_moves(self) -> np.ndarray:
        """Largest shift at the knots of every nominal move, (M,) mm."""
        found, shift = np.zeros(len(self.shift.moves)), self.shift
        size = np.linalg.norm(shift.value_mm, axis=1)
        np.maximum.at(found, shift.move, size[shift.knot[:, [0, 2]]].max(axis=1))
        return found


def aim_at_part(
    iteration: Iteration, found: Solution, view: PartView, *, tolerance_mm: float
) -> tuple[Solution, PartAim]:
    """Shift the path so that the predicted part is centred on the nominal one.

    The shift answers what is left with the tip in place, and nothing else: without tilt and
    effects at the cutting edge there is none. As it changes which move makes a point last, part
    and shift are found in turns; what leaves least on the part is kept.

    Parameters
    ----------
    iteration : Iteration
        Left with the shift that is found.
    found : Solution
        With the tool on its nominal path.
    view : PartView
        Of the surface that is aimed at.
    tolerance_mm : float
        Of the tool, from where it shall be.
    """
    moves = iteration.preparation.path.nodes.moves
    shift = no_shift(moves, found.plan, iteration.rewriter.programmed & ~iteration.stuck)
    before = now = best = view.deviation(found.run)
    kept, rounds, demand = (found, shift), 0, None
    for number in range(1, _ROUNDS + 1):
        if np.abs(now.tip_right_mm).max(initial=0.0) < _NOTHING_MM:
            break
        demand = SurfaceDemand(
            now.row, now.move, now.parameter, view.points.normal[now.row], -now.tip_right_mm
        ).beside(demand)
        old, shift = shift, centred(shift, demand)
        iteration.shift = shift
        found = iteration.solve_again(*_shifted(found, old, shift), tolerance_mm)
        now = view.deviation(found.run)
        if now.norm_mm > _BETTER * best.norm_mm:
            break
        if now.largest_mm <= _WORSE * before.largest_mm:
            best, kept, rounds = now, (found, shift), number
    found, iteration.shift = kept
    return found, PartAim(kept[1], before, best, rounds)


def _shifted(found: Solution, old: PathShift, new: PathShift) -> tuple[Plan, Target]:
    """The plan for another shift, and corrections to begin with.

    Blocks that stayed as they were are written where the shift moves them.
    """
    asked = np.abs(new.value_mm).max(axis=1) > _STAYS_MM
    moved = np.concatenate([asked, [False]])[new.knot].any(axis=1)
    stretches: dict[int, list[int]] = {}
    for stretch in np.flatnonzero(np.isin(new.move, new.move[moved])).tolist():
        stretches.setdefault(int(new.move[stretch]), []).append(stretch)
    old_pieces = found.plan.pieces
    written = np.flatnonzero(old_pieces.kept & np.isin(old_pieces.move, list(stretches)))
    parts, origin, done = [], [], 0
    for k in written.tolist():  # their blocks stayed, and are written now
        s = np.array(stretches[int(old_pieces.move[k])])
        nothing = np.zeros(len(s), bool)
        parts += [old_pieces.taken(slice(done, k)),
                  Pieces(np.full(len(s), old_pieces.move[k]), new.start[s], new.end[s],
                         new.is_arc[s], nothing, np.zeros(len(s)))]  # fmt: skip
        origin += [np.arange(done, k), np.append(np.full(len(s) - 1, -1), k)]
        done = k + 1
    pieces = Pieces.joined([*parts, old_pieces.taken(slice(done, None))])
    old_piece = np.concatenate([*origin, np.arange(done, len(old_pieces))])
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
