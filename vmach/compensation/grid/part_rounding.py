"""Rounding that serves the part: what is left on its surface decides on the grid points.

Source: closed form derived here: to first order an end that is off by s changes the deviation by
its share times n . s.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.base.memory import give_back_free_memory
from vmach.compensation.aim.part_view import PartDeviation, PartView
from vmach.compensation.aim.probes import ProbeSets, near_surface, path_probes, surface_probes
from vmach.compensation.aim.surface_demand import made_by
from vmach.compensation.grid.rounding import Rounding
from vmach.compensation.iteration import Iteration, Solution
from vmach.compensation.written_run import WrittenRun
from vmach.path.geometry import move_length_mm
from vmach.program_text import Written

__all__ = ["RoundedProgram", "round_program"]

#: so often the part of the rounded program is predicted
_ROUNDS = 4


@dataclass(frozen=True)
class RoundedProgram:
    """The text at the control's resolution, read back.

    Attributes
    ----------
    written : Written
    run : WrittenRun
    part : PartDeviation, optional
        What it leaves on the surface that it was rounded for.
    """

    written: Written
    run: WrittenRun
    part: PartDeviation | None = None


def round_program(
    iteration: Iteration, found: Solution, resolution_mm: float, view: PartView | None
) -> RoundedProgram:
    """Write a solution on the control's grid.

    Rounded ends change which of several moves goes deepest at a point, as where the passes of a
    floor overlap. So the part is predicted, the moves that came to make points are held as well,
    and all is rounded again; what leaves least is kept.

    Parameters
    ----------
    iteration : Iteration
    found : Solution
    resolution_mm : float
    view : PartView or None
        Of the surface to round for; without it the distance across the path counts.
    """
    rounding = Rounding(iteration.rewriter, found.plan, found.target, resolution_mm)

    def program(probes: ProbeSets) -> RoundedProgram:
        plan, target = rounding.rounded(probes)
        give_back_free_memory()  # what its threads took
        written = iteration.write(target, resolution_mm)
        run = iteration.run(plan, written)
        part = None if view is None else view.deviation(run)
        return RoundedProgram(written, run, part)

    if view is None:
        return program(ProbeSets.of(path_probes(found.run)))
    makers, best = _Makers(found.run, view), None
    for number in range(1, _ROUNDS + 1):
        now = program(makers.probes)
        is_better = best is None or now.part.norm_mm < best.part.norm_mm
        best = now if is_better else best
        if number == _ROUNDS or not makers.learnt_from(now):
            break
    return best


class _Makers:
    """The moves that make the points of a surface, by the probes that stand for them.

    Parameters
    ----------
    exact : WrittenRun
        Before rounding.
    view : PartView
    """

    def __init__(self, exact: WrittenRun, view: PartView) -> None:
        self.exact, self.normal = exact, view.points.normal
        part, path = view.deviation(exact), path_probes(exact)
        exact.set_aside()
        self.path_length_mm = 0.5 * path.path_length_mm.sum() / max(len(part.row), 1)
        self.known = made_by(part.row, part.move)
        surface = surface_probes(
            part, self.normal[part.row], left_mm=part.error_mm, path_length_mm=self.path_length_mm
        )
        length_mm = move_length_mm(exact.original.path.nodes.moves)
        self.probes = ProbeSets.of(surface, near_surface(path, surface, length_mm))

    def learnt_from(self, now: RoundedProgram) -> bool:
        """Whether moves have come to make points; they are held from here on."""
        new = ~np.isin(made_by(now.part.row, now.part.move), self.known)
        if not new.any():
            return False
        part = now.part.taken(new)
        self.known = np.concatenate([self.known, made_by(part.row, part.move)])
        place, normal = (part.move, part.parameter), self.normal[part.row]
        moved = now.run.miss_at(*place)
        now.run.set_aside()
        moved -= self.exact.miss_at(*place)
        self.exact.set_aside()
        left = part.error_mm - np.einsum("pi,pi->p", normal, moved)
        self.probes = self.probes.beside(
            surface_probes(
                part, normal, left_mm=left, path_length_mm=self.path_length_mm, only_below=True
            )
        )
        return True
