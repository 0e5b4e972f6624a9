"""Klartext cycle 232: a face in lines.

Source: HEIDENHAIN TNC 640 (34059x-01), User's Manual Cycle Programming, section 10.4 "Face
milling": Q389 = 0 ends its lines outside the face, 1 inside, 2 outside and all in one sense.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.tool_call import tool_of_spindle
from gcode.errors import ProgramError
from gcode.language.face_milling import Face, layers, mill_face

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["FACES", "mill"]

FACES = frozenset((232,))


def mill(reader: KlartextReader, number: int, data: Mapping[str, float]) -> None:
    """Do the cycle; the tool ends at the second set-up clearance."""

    def q(key: int, default: float | None = None) -> float:
        value = data.get(str(key), default)
        if value is None:
            raise ProgramError(f"Q{key} of cycle {number} is missing")
        return value

    reader.controller.note(
        f"CYCL DEF {number}",
        "where its lines lie is the control's own; they are spaced evenly here",
    )
    radius = tool_of_spindle(reader).offset_diameter_mm / 2.0 / reader.controller.unit_mm
    strategy, feed = int(q(389)), q(207, reader.motion.tool_feed)
    if strategy not in (0, 1, 2) or not radius > 0.0:
        raise ProgramError(f"Q389={strategy} with a tool of radius {radius:g}", accepted="0 to 2")
    top, floor, left = q(227), q(386), q(369, 0.0)
    levels = [(level, feed) for level in layers(top, floor + left, abs(q(202)))]
    levels += [(floor, q(385, feed))] if left else []
    outside = radius + abs(q(357, 0.0))
    face = Face(
        corner=(q(225), q(226)),
        length=q(218),
        width=q(219),
        angle_deg=0.0,
        step_over=min(max(q(370, 1.0), 0.1), 1.99) * radius,
        start=outside,
        before=-radius if strategy == 1 else outside,
        behind=-radius if strategy == 1 else outside,
        one_way=strategy == 2,
        levels=tuple(levels),
        clear=top + q(200),
        lift=q(200),
        plunge_feed=q(253, feed),
        link_feed=q(253, feed),
    )
    out = top + max(q(204, 0.0), q(200))
    reader.execute(f"g0z{max(out, reader.here()[2])!r}", *mill_face(face), f"g0z{out!r}")
