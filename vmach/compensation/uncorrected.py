"""What a compensated program leaves before rounding, by the user's lines, and why.

And what it answers that need not happen again.

Source: closed form derived here: distances of `vmach.compensation.residual`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gcode import MoveKind
from vmach.base.note import Kind, Note
from vmach.compensation.iteration import Iteration, Solution
from vmach.effects import EffectInstance
from vmach.prediction import ActingEffect

__all__ = ["answered_once", "uncorrected"]

_UNKNOWN_START = "the program does not state where it begins: only its end is corrected"
#: places along such a line
_PLACES = 33
_TOO_FAST = "the error changes faster than the block is long, as while lost motion is taken up"


def uncorrected(
    iteration: Iteration, found: Solution, tolerance_mm: float
) -> dict[int, tuple[float, str]]:
    """Lines that keep more than the tolerance before rounding: how much, mm, and why."""
    moves = iteration.preparation.path.nodes.moves
    user_line = iteration.expansion.user_line
    reasons = {}
    for move in np.flatnonzero(iteration.stuck.any(axis=1)).tolist():
        axes = ", ".join(np.array(list("XYZ"))[iteration.stuck[move]])
        reason = f"the program does not state the position of {axes}"
        reasons[int(user_line(moves.line[move]))] = reason
    far = found.residual.told_in(iteration.expansion).lines_beyond(tolerance_mm)
    left = {line: (size, reasons.get(line, _TOO_FAST)) for line, size in far.items()}
    return left | _of_unknown_start(iteration)


def answered_once(effects: Sequence[ActingEffect]) -> tuple[Note, ...]:
    """Notes of effects that began at one moment of the part that was measured."""
    said = (
        "{} began at {:.0f} s of the part that was measured; the program answers it as if it began "
        "there in every part: take it out of the job where it was an accident"
    )
    return tuple(
        Note.plain(
            Kind.ONCE,
            said.format(one.label, one.parameters["time_s"]),
            one.parameters["time_s"],
            "s",
            place=one.label,
        )
        for one in effects
        if isinstance(one, EffectInstance) and one.effect.is_sudden
    )


def _of_unknown_start(iteration: Iteration) -> dict[int, tuple[float, str]]:
    """Lines that are corrected at their end alone, with the error along them."""
    preparation, moves = iteration.preparation, iteration.preparation.path.nodes.moves
    blind = iteration.rewriter.unknown_start & (moves.kind != MoveKind.RAPID)
    found = {}
    for move in np.flatnonzero(blind & (moves.kind != MoveKind.DWELL)).tolist():
        share = np.linspace(0.0, 1.0, _PLACES)
        error = iteration.model.error_at(preparation, np.full(_PLACES, move), share)
        line = int(iteration.expansion.user_line(moves.line[move]))
        found[line] = float(np.linalg.norm(error, axis=1).max()), _UNKNOWN_START
    return found
