"""APPR and DEP: how a contour is approached and left.

Source: HEIDENHAIN TNC 640, User's Manual for Klartext Programming, "Contour approach and
departure": LT is a line of LEN on the contour's tangent, LN one square to it. CT is an arc of
radius R and angle CCA that ends on the tangent, LCT such an arc with a line on its other tangent. R
is taken for the path of the tool's axis here; the contour begins in the same place either way. With
P in front (PLT, PLN, PCT, PLCT) the contour's point is polar, and so is the end of DEP PLCT.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.m_functions import BEFORE_MOTION, m_code
from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.dialects.heidenhain.tool_call import tool_of_spindle
from gcode.errors import ProgramError
from gcode.geometry.arcs import Point
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["approach", "depart"]

_KIND = re.compile(r"(?:APPR|DEP)\s+(P?)(LT|LN|CT|LCT)\b")
_SIZE = re.compile(rf"\b(LEN|CCA)\s*({NUMBER})")
_RADIUS = re.compile(rf"(?<![A-Z])R\s*({NUMBER})")
_MOTION = re.compile(r"(LP?|CP?|CC|CR)\b")


class _Words:
    """Kind, sizes and remaining words of a block."""

    def __init__(self, reader: KlartextReader, content: str) -> None:
        kind = _KIND.match(content)
        if kind is None:
            raise ProgramError(
                f"cannot read '{content}'", accepted="APPR LT LN CT LCT PLT PLN PCT PLCT; DEP"
            )
        self.kind, rest = kind[2], content[kind.end() :]
        self.sizes = {k: reader.parameters.number(v) for k, v in _SIZE.findall(rest)}
        rest = _SIZE.sub(" ", rest)
        found = _RADIUS.search(rest)
        if found is not None:
            self.sizes["R"] = reader.parameters.number(found[1])
            rest = rest[: found.start()] + " " + rest[found.end() :]
        for name in self.sizes.keys() & {"LEN", "R"}:
            self.sizes[name] *= reader.frames.scaling.of_radii
        self.words, codes = reader.words(rest)
        self.before = [m_code(reader, code) for code in codes if code in BEFORE_MOTION]
        self.after = [m_code(reader, code) for code in codes if code not in BEFORE_MOTION]
        target = reader.motion.polar_target if kind[1] else reader.motion.target
        self.end = target(self.words)

    def size(self, name: str) -> float:
        """LEN, CCA or R."""
        if name not in self.sizes:
            raise ProgramError(f"{self.kind} without {name}")
        return self.sizes[name]


def _square(direction: Point, side: float) -> Point:
    """Unit vector square to a direction, to the left for side +1."""
    return -direction[1] * side, direction[0] * side


def _add(point: Point, direction: Point, length: float) -> Point:
    return point[0] + direction[0] * length, point[1] + direction[1] * length


def _direction(start: Point, end: Point) -> Point:
    size = math.dist(start, end)
    if size == 0.0:
        raise ProgramError("the contour's first element has no length")
    return (end[0] - start[0]) / size, (end[1] - start[1]) / size


def _first_direction(reader: KlartextReader, start: Point) -> Point:
    """Direction of the contour where it begins, from the lines that follow."""
    pole = reader.motion.pole
    for index in range(reader.next, len(reader.lines)):
        content = reader.content(index)
        match = _MOTION.match(content)
        if not content or content.startswith((";", "*")):
            continue
        if match is None:
            break
        words, _ = reader.words(content[match.end() :])
        target = tuple(
            words.get(a, p + words.get("I" + a, 0.0)) for a, p in zip("XY", start, strict=True)
        )
        if match[1] == "LP":
            target = reader.motion.polar_target(words, [*start, *reader.here()[2:]])[:2]
        if match[1] == "CC":
            pole = target
        elif match[1] in ("L", "LP"):
            if target != start:
                return _direction(start, target)
        elif match[1] in ("C", "CP") and pole is not None:
            return _square(_direction(pole, start), 1.0 if words.get("DR") == "+" else -1.0)
        else:
            break
    raise ProgramError("APPR needs a line L or an arc C behind it")


def approach(reader: KlartextReader, content: str) -> None:
    """Go to the contour's first point, with the tool's radius from there on."""
    said = _Words(reader, content)
    start, end = reader.here(), said.end
    direction = _first_direction(reader, end[:2])
    side, offset = _side(reader, said.words)
    contact = _add(end[:2], _square(direction, side or 1.0), offset)
    path = _tail(said, contact, direction, side or 1.0, start[:2])
    first, code, centre = path
    if "F" in said.words:
        reader.motion.feed = said.words["F"]
    level = "" if end[2] == start[2] else f"z{number(end[2])}"
    rapid = "FMAX" in said.words
    reader.execute(
        *said.before,
        f"{'g0' if rapid else 'g1'}{xy_words(first[0], first[1])}{level}"
        f"{reader.motion.feed_word(rapid)}",
    )
    reader.execute(_piece(code, contact, centre, first))
    if side:
        tool = reader.controller.tool
        reader.execute(f"g{41 if side > 0 else 42}d{tool}", f"g1{xy_words(end[0], end[1])}")
    reader.execute(*said.after)


def _tail(
    said: _Words, contact: Point, direction: Point, side: float, away: Point
) -> tuple[Point, int, Point | None]:
    """Point P_H, and line (1) or arc (2, 3) with its centre from there to the contour."""
    if said.kind == "LT":
        return _add(contact, direction, -said.size("LEN")), 1, None
    if said.kind == "LN":
        return _add(contact, _square(direction, side), said.size("LEN")), 1, None
    radius = said.size("R")
    turn = math.copysign(1.0, radius) * side
    centre = _add(contact, _square(direction, turn), abs(radius))
    if said.kind == "CT":
        angle = -turn * math.radians(said.size("CCA"))
        out = contact[0] - centre[0], contact[1] - centre[1]
        first = (
            centre[0] + out[0] * math.cos(angle) - out[1] * math.sin(angle),
            centre[1] + out[0] * math.sin(angle) + out[1] * math.cos(angle),
        )
    else:
        first = _touch(away, centre, abs(radius), turn)
    return first, 3 if turn > 0.0 else 2, centre


def _touch(away: Point, centre: Point, radius: float, turn: float) -> Point:
    """Where the tangent from a point meets a circle that is then run along, ccw for turn +1."""
    out = away[0] - centre[0], away[1] - centre[1]
    distance = math.hypot(*out)
    if distance <= radius:
        raise ProgramError(f"LCT with R{radius:g} from a point within its arc")
    angle = math.atan2(out[1], out[0]) + turn * math.acos(radius / distance)
    return centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)


def _piece(code: int, end: Point, centre: Point | None, start: Point) -> str:
    text = f"g{code}{xy_words(end[0], end[1])}"
    if centre is None:
        return text
    return text + f"i{number(centre[0] - start[0])}j{number(centre[1] - start[1])}"


def _side(reader: KlartextReader, words: Mapping[str, object]) -> tuple[float, float]:
    """1 for RL, -1 for RR, 0 without; and the tool's radius, program units."""
    side = 1.0 if "RL" in words else -1.0 if "RR" in words else 0.0
    radius = tool_of_spindle(reader).offset_diameter_mm / 2.0 / reader.controller.unit_mm
    return side, radius if side else 0.0


def depart(reader: KlartextReader, content: str) -> None:
    """Leave the contour at its last point; the tool's radius ends there."""
    said = _Words(reader, content)
    c = reader.controller
    side, here = float(c.side), reader.here()
    direction = reader.motion.last_direction(here[:2], "DEP")
    radius = tool_of_spindle(reader).offset_diameter_mm / 2.0 / c.unit_mm if side else 0.0
    contact = _add(here[:2], _square(direction, side or 1.0), radius)
    back = (-direction[0], -direction[1])
    end = said.end
    first, code, centre = _tail(said, contact, back, -(side or 1.0), end[:2])
    code = {2: 3, 3: 2}.get(code, 1)
    if "F" in said.words:
        reader.motion.feed = said.words["F"]
    reader.execute(*said.before)
    if side:
        reader.execute("g40", f"g1{xy_words(contact[0], contact[1])}")
    reader.execute(_piece(code, first, centre, contact) + reader.motion.feed_word(False))
    if said.kind == "LCT":
        reader.execute(f"g1{xy_words(end[0], end[1])}z{number(end[2])}")
    elif end[2] != here[2]:
        reader.execute(f"g1z{number(end[2])}")
    reader.execute(*said.after)
