"""A contour in a subprogram of Klartext."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gcode.errors import ProgramError
from gcode.language.contours import Contour, contour_of
from gcode.state.controller import Controller

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["read_contour"]


def read_contour(reader: KlartextReader, label: str) -> Contour:
    """Read the lines from LBL to LBL 0 apart from the program, without moving anything.

    Raises
    ------
    ProgramError
        There is no such label, or nothing of a contour in it.
    """
    outer = reader.controller
    controller = Controller(outer.tools, outer.tolerance, outer.machine_unit_mm)
    inner = reader.apart(controller)
    inner.parameters, inner.budget, inner.contents = (
        reader.parameters, reader.budget, reader.contents,
    )  # fmt: skip
    inner.motion.sides = sides = []
    inner.motion.feed = inner.motion.tool_feed = 1.0
    inner.execute("g20" if outer.unit_mm != 1.0 else "g21", "g17g90g40g80")
    target = reader.flow.find(label)
    inner.flow.calls.append((target, inner.stop, -1, 0))
    inner.next = target + 1
    try:
        inner.run()
    except ProgramError as error:
        raise ProgramError(f"contour LBL {label}: {error.what}", accepted=error.accepted,
                           hint=error.hint) from None  # fmt: skip
    if any(side != sides[0] for side in sides):
        raise ProgramError(f"LBL {label} has RL and RR", accepted="one of them")
    return contour_of(controller, f"LBL {label}", sides[0] if sides else 0)
