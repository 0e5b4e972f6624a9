"""What a compensated program must not do: refused with the lines.

Source: closed form derived here: a tool within r of its nominal path sweeps the nominal volume
within r.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vmach.base.units import um_from_mm
from vmach.compensation.aim.part_aim import PartAim
from vmach.compensation.aim.part_view import PartDeviation
from vmach.compensation.written_run import WrittenRun
from vmach.errors import InputError
from vmach.path.preparation import Preparation
from vmach.program_text import Expanded, Target

__all__ = ["check_corrections", "check_part", "check_result", "lines_text"]

_MOST_LINES = 10
#: a shift of the path is no larger than this many times the deviations that it answers
_MOST_SHIFT = 3.0


def check_corrections(
    preparation: Preparation, target: Target, limit_mm: float, expansion: Expanded
) -> None:
    """Refuse corrections beyond a limit.

    Raises
    ------
    InputError
        With the lines.
    """
    size = np.linalg.norm(target.ends_mm, axis=1)
    beyond = np.flatnonzero(size > limit_mm)
    if not beyond.size:
        return
    rows = target.pieces.move[beyond]
    lines = expansion.user_line(preparation.path.nodes.moves.line[rows])
    raise InputError(
        f"corrections up to {um_from_mm(size.max()):.1f} um (lines {lines_text(lines)})",
        file=preparation.program.path,
        line=int(lines.min()),
        accepted=f"at most {um_from_mm(limit_mm):g} um",
        hint="--limit-um sets the limit",
    )


def check_result(
    preparation: Preparation, run: WrittenRun, limit_mm: float, expansion: Expanded
) -> None:
    """Refuse a written program that cuts where the nominal one does not, or passes there.

    The tool at feed is compared everywhere with the path that it is asked to take. So its swept
    volume is that of the nominal program within the residual. Where the path is shifted
    (`check_part`), it is within residual and shift. Rapids, and moves that begin where the
    program does not state, must not pass farther from their nominal path than the limit, unless
    the user's program does so itself.

    Raises
    ------
    InputError
        With the lines.
    """
    refused = {
        "the tool is still up to {:.2f} um off its path": run.residual,
        "moves without points pass up to {:.2f} um off their path": run.worse_moves(limit_mm),
    }
    for what, residual in refused.items():
        far = residual.told_in(expansion).lines_beyond(limit_mm)
        if far:
            raise InputError(
                f"{what.format(um_from_mm(max(far.values())))} (lines {lines_text(far)})",
                file=preparation.program.path,
                line=min(far),
                accepted=f"at most {um_from_mm(limit_mm):g} um",
                hint="--residual-limit-um sets the limit",
            )


def check_part(
    preparation: Preparation, aim: PartAim, written: PartDeviation, limit_mm: float,
    expansion: Expanded,
) -> None:  # fmt: skip
    """Refuse a shift of the path that spoils the part, or has nothing to answer.

    Where a move makes several points, it may make one worse for the sake of another. It must
    leave none farther off, beyond a limit, than the worst of them was with the tool on its
    nominal path.
    The swept volume differs from that of the nominal program by no more than the shift, which is
    no larger than a few times the deviations that it answers.

    Parameters
    ----------
    preparation : Preparation
    aim : PartAim
    written : PartDeviation
        Of the program as it is written.
    limit_mm : float
    expansion : Expanded

    Raises
    ------
    InputError
        With the lines.
    """
    tool, line = aim.tool, preparation.path.nodes.moves.line
    count = int(max(tool.row.max(initial=0), written.row.max(initial=0))) + 1
    worst, maker = np.zeros(len(line) + 1), np.full(count, len(line))
    np.maximum.at(worst, tool.move, np.abs(tool.error_mm))
    maker[tool.row] = tool.move
    allowed = np.maximum(worst[written.move], worst[maker[written.row]]) + limit_mm
    size = np.abs(written.error_mm)
    shift, most = aim.shift_of_moves(), _MOST_SHIFT * np.abs(tool.tip_right_mm).max(initial=0.0)
    refused = {
        "with --aim part, {:.2f} um are left on the part": (size > allowed, size, written.move),
        "with --aim part, the path is shifted by {:.2f} um": (
            shift > most + limit_mm, shift, np.arange(len(line))),
    }  # fmt: skip
    for what, (wrong, size, move) in refused.items():
        if wrong.any():
            lines = expansion.user_line(line[move[wrong]])
            raise InputError(
                f"{what.format(um_from_mm(size[wrong].max()))} (lines {lines_text(lines)})",
                file=preparation.program.path,
                line=int(lines.min()),
                accepted="no worse than with the tool on its nominal path, by "
                f"{um_from_mm(limit_mm):g} um",
                hint="--aim tool keeps it there; --residual-limit-um sets the limit",
            )


def lines_text(lines: np.ndarray | list[int] | Mapping[int, float]) -> str:
    """The first of the lines, (L,), for a message."""
    found = sorted({int(line) for line in lines})
    return ", ".join(map(str, found[:_MOST_LINES])) + (" ..." if len(found) > _MOST_LINES else "")
