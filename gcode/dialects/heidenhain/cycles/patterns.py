"""Klartext cycles 220 and 221 and PATTERN DEF: places at which a cycle is called.

HEIDENHAIN TNC 640, User's Manual Cycle Programming, "Pattern definition" and "Point patterns".
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping

from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.errors import ProgramError
from gcode.geometry.arcs import Point

__all__ = ["PATTERNS", "Pattern", "pattern_definition", "pattern_places"]

PATTERNS = frozenset((220, 221))
#: X, Y, and by how much the pattern raises the surface of the cycle
Pattern = tuple[float, float, float]
_MOST = 10_000
_PIECE = re.compile(r"(POS|ROW|PAT|FRAME|CIRC|PITCHCIRC)\s*\d+\s*\(([^)]*)\)")


def _count(value: float, what: str) -> int:
    if value != int(value) or not 1 <= value <= _MOST:
        raise ProgramError(f"{what} {value:g}", accepted=f"1 to {_MOST}")
    return int(value)


def pattern_places(number: int, q: Mapping[str, float]) -> Iterator[Point]:
    """Places of cycle 220 (circle) or 221 (lines, there and back)."""
    try:
        if number == 220:
            count = _count(q["241"], "Q241")
            yield from _circle(
                (q["216"], q["217"]),
                q["244"],
                q["245"],
                count,
                step_deg=q.get("247", 0.0),
                stop_deg=q.get("246", 360.0),
            )
            return
        columns, lines = _count(q["242"], "Q242"), _count(q["243"], "Q243")
        yield from _grid(
            (q["225"], q["226"]), (columns, lines), (q["237"], q["238"]), q.get("224", 0.0)
        )
    except KeyError as missing:
        raise ProgramError(f"Q{missing.args[0]} of cycle {number} is missing") from None


def _circle(
    centre: Point,
    diameter: float,
    start_deg: float,
    count: int,
    *,
    step_deg: float,
    stop_deg: float,
) -> Iterator[Point]:
    if step_deg == 0.0:
        opening = stop_deg - start_deg
        whole = math.isclose(abs(opening), 360.0)
        step_deg = opening / (count if whole else max(count - 1, 1))
    for k in range(count):
        angle = math.radians(start_deg + k * step_deg)
        yield (
            centre[0] + diameter / 2.0 * math.cos(angle),
            centre[1] + diameter / 2.0 * math.sin(angle),
        )


def _grid(
    start: Point, counts: tuple[int, int], spacing: Point, angle_deg: float
) -> Iterator[Point]:
    cosine, sine = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    for line in range(counts[1]):
        columns = range(counts[0]) if line % 2 == 0 else range(counts[0] - 1, -1, -1)
        for column in columns:
            along, across = column * spacing[0], line * spacing[1]
            yield (
                start[0] + along * cosine - across * sine,
                start[1] + along * sine + across * cosine,
            )


def pattern_definition(text: str, value: Callable[[str], float]) -> list[Pattern]:
    """Places of ``PATTERN DEF POS1 (X+25 Y+33 Z+0) ROW1 (X+25 Y+33 D+8 NUM5 ROT+0 Z+0)``."""
    places: list[Pattern] = []
    if _PIECE.sub("", text).strip():
        raise ProgramError(
            f"cannot read 'PATTERN DEF {text}'", accepted="POS ROW PAT CIRC PITCHCIRC"
        )
    for kind, body in _PIECE.findall(text):
        words = {
            name: value(number) for name, number in re.findall(rf"([A-Z]+)\s*({NUMBER})", body)
        }
        try:
            found = _places_of(kind, words)
        except KeyError as missing:
            raise ProgramError(f"{kind} without {missing.args[0]}") from None
        places += [(x, y, words.get("Z", 0.0)) for x, y in found]
    return places


def _places_of(kind: str, w: Mapping[str, float]) -> list[Point]:
    start = w["X"], w["Y"]
    if kind == "POS":
        return [start]
    if kind == "ROW":
        return list(_grid(start, (_count(w["NUM"], "NUM"), 1), (w["D"], 0.0), w.get("ROT", 0.0)))
    if kind == "PAT":
        counts = _count(w["NUMX"], "NUMX"), _count(w["NUMY"], "NUMY")
        if w.get("ROTX", 0.0) or w.get("ROTY", 0.0):
            raise ProgramError("PAT with ROTX or ROTY is not read", accepted="ROT")
        return list(_grid(start, counts, (w["DX"], w["DY"]), w.get("ROT", 0.0)))
    if kind in ("CIRC", "PITCHCIRC"):
        count = _count(w["NUM"], "NUM")
        step = w["STEP"] if kind == "PITCHCIRC" else 0.0
        return list(
            _circle(start, w["D"], w["START"], count, step_deg=step, stop_deg=w["START"] + 360.0)
        )
    raise ProgramError(f"PATTERN DEF {kind} is not read", accepted="POS ROW PAT CIRC PITCHCIRC")
