"""Klartext cycles 230 to 233: faces and ruled surfaces in lines.

Source: HEIDENHAIN TNC 640 (34059x-01), User's Manual Cycle Programming, section 10.4 "Face
milling": Q389 = 0 ends its lines outside the face, 1 inside, 2 outside and all in one sense. Cycle
233 adds a line in one sense that ends inside (3), Q350 along the second axis, and Q367, which says
what of the face the tool stands at. 230 and 231 make Q240 lines and no infeeds; 231 goes from the
line between its first two points to that between its last two.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.cycles.parameter import cycle_parameter
from gcode.dialects.heidenhain.tool_call import tool_of_spindle
from gcode.errors import ProgramError
from gcode.language.face_milling import Face, layers, mill_face
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["FACES", "mill"]

FACES = frozenset((230, 231, 232, 233))
_MOST_LINES = 10_000
#: Q367 of cycle 233 -> where the tool stands, in lengths and widths from the face's first corner
_STANDS = {0: (0.5, 0.5), 1: (0.0, 0.0), 2: (1.0, 0.0), 3: (1.0, 1.0), 4: (0.0, 1.0)}
#: Q389 of cycle 233 -> in one sense, ends inside
_WAYS = {0: (False, False), 1: (False, True), 2: (True, False), 3: (True, True)}

Parameter = Callable[..., float]


def mill(reader: KlartextReader, cycle: int, data: Mapping[str, float]) -> None:
    """Do the cycle; the tool ends at the second set-up clearance."""
    q: Parameter = partial(cycle_parameter, data, cycle)

    reader.controller.note(
        f"CYCL DEF {cycle}",
        "where its lines lie is the control's own; they are spaced evenly here",
    )
    radius = tool_of_spindle(reader).offset_diameter_mm / 2.0 / reader.controller.unit_mm
    if not radius > 0.0:
        raise ProgramError(f"cycle {cycle} needs a tool with a diameter")
    if cycle in (230, 231):
        count = int(q(240))
        if not 2 <= count <= _MOST_LINES:
            raise ProgramError(f"Q240={count}", accepted=f"2 to {_MOST_LINES}")
        how = _passes if cycle == 230 else _ruled
        reader.execute(*how(q, count, radius))
        return
    top = q(227)
    out = top + max(q(204, 0.0), q(200))
    face = _face(reader, q, cycle, radius)
    reader.execute(
        f"g0z{number(max(out, reader.here()[2]))}", *mill_face(face), f"g0z{number(out)}"
    )


def _levels(q: Parameter, cycle: int, feed: float) -> tuple[tuple[float, float], ...]:
    """Level and feed of roughing and finishing, as Q215 of cycle 233 asks."""
    top, floor, left = q(227), q(386), q(369, 0.0)
    kind = int(q(215, 0.0)) if cycle == 233 else 0
    found = [] if kind == 2 else [(z, feed) for z in layers(top, floor + left, abs(q(202)))]
    if (left and kind == 0) or kind == 2:
        found.append((floor, q(385, feed)))
    return tuple(found)


def _face(reader: KlartextReader, q: Parameter, cycle: int, radius: float) -> Face:
    feed = q(207, reader.motion.tool_feed)
    strategy, length, width = int(q(389)), q(218), q(219)
    allowed = _WAYS if cycle == 233 else {0: (False, False), 1: (False, True), 2: (True, False)}
    if strategy not in allowed:
        raise ProgramError(f"Q389={strategy} of cycle {cycle}", accepted=f"0 to {len(allowed) - 1}")
    one_way, inside = allowed[strategy]
    angle = 0.0
    if cycle == 232:
        corner = q(225), q(226)
    else:
        corner = _corner(reader, q)
        if int(q(350, 1.0)) == 2:  # along the second axis: the same, a quarter further
            length, width, angle = width, -length, 90.0
    outside = radius + abs(q(357, 0.0))
    beyond = -radius if inside else outside
    return Face(
        corner=corner, length=length, width=width, angle_deg=angle,
        step_over=min(max(q(370, 1.0), 0.1), 1.99) * radius,
        start=outside, before=beyond, behind=beyond, one_way=one_way,
        levels=_levels(q, cycle, feed), clear=q(227) + q(200), lift=q(200),
        plunge_feed=q(253, feed), link_feed=q(253, feed),
    )  # fmt: skip


def _corner(reader: KlartextReader, q: Parameter) -> tuple[float, float]:
    """Cycle 233: the first corner of the face, from where the tool stands; without walls."""
    walls = [key for key in (347, 348, 349) if q(key, 0.0)]
    stands = _STANDS.get(int(q(367, 0.0)))
    if walls or stands is None:
        key = walls[0] if walls else 367
        raise ProgramError(f"Q{key}={q(key):g} of cycle 233", accepted="no walls; Q367 0 to 4")
    x, y = reader.here()[:2]
    return x - stands[0] * q(218), y - stands[1] * q(219)


def _passes(q: Parameter, count: int, radius: float) -> Iterator[str]:
    """Cycle 230: lines to and fro at one level, the tool's radius beyond either end."""
    left, level = math.copysign(radius, q(218)), q(227)
    ends = q(225) - left, q(225) + q(218) + left
    clear = f"g0z{number(level + q(200))}"
    yield f"g0{xy_words(ends[0], q(226))}"
    yield clear
    yield f"g1z{number(level)}f{number(q(206))}"
    for k in range(count):
        across = q(226) + q(219) * k / (count - 1)
        if k:
            yield f"g1{xy_words(ends[k % 2], across)}f{number(q(209))}"
        yield f"g1{xy_words(ends[1 - k % 2], across)}f{number(q(207))}"
    yield clear


def _ruled(q: Parameter, count: int, radius: float) -> Iterator[str]:
    """Cycle 231: lines from points 1 and 2 to points 4 and 3, up by the diameter between them."""
    first, second, third, fourth = ([q(225 + 3 * k + a) for a in range(3)] for k in range(4))
    feed = f"f{number(q(207))}"
    top = max(p[2] for p in (first, second, third, fourth)) + 2.0 * radius
    yield f"g0{xy_words(*first[:2])}z{number(first[2] + 2.0 * radius)}"
    for k in range(count):
        share = k / (count - 1)
        begin, end = (
            [a + (b - a) * share for a, b in zip(p, r, strict=True)]
            for p, r in ((first, fourth), (second, third))
        )
        yield f"g1{xy_words(*begin[:2])}z{number(begin[2])}{feed}"
        yield f"g1{xy_words(*end[:2])}z{number(end[2])}{feed}"
        up = max(end[2], begin[2]) + 2.0 * radius
        yield f"g0z{number(up if k + 1 < count else top)}"
        if k + 1 < count:
            yield f"g0{xy_words(*begin[:2])}"
