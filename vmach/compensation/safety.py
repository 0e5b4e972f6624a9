"""What a compensated program must not do: refused with the lines."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vmach.compensation.expanded_text import Expanded
from vmach.compensation.rewriting import Target
from vmach.compensation.written_run import WrittenRun
from vmach.errors import InputError
from vmach.preparation import Preparation
from vmach.units import um_from_mm

__all__ = ["check_corrections", "check_result", "lines_text"]

_MOST_LINES = 10


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
    rows = [target.pieces[k].move for k in beyond]
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

    The tool at feed is held against its nominal path everywhere, so that its swept volume is
    that of the nominal program within the residual. Rapids must not pass farther from their
    nominal path than the limit, unless the user's program does so itself.

    Raises
    ------
    InputError
        With the lines.
    """
    refused = {
        "the tool is still up to {:.2f} um off its path": run.residual(),
        "rapids pass up to {:.2f} um off their path": run.worse_rapids(limit_mm),
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


def lines_text(lines: np.ndarray | list[int] | Mapping[int, float]) -> str:
    """The first of the lines, for a message."""
    found = sorted({int(line) for line in lines})
    return ", ".join(map(str, found[:_MOST_LINES])) + (" ..." if len(found) > _MOST_LINES else "")
