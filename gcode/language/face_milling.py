"""Faces of the controls' milling cycles as lines of RS274/NGC.

What a cycle leaves is in the manuals: a level, over a rectangle. Where its lines lie is the
control's own; here they are spaced evenly, half a space from either side.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from gcode.errors import ProgramError
from gcode.geometry.arcs import Point
from gcode.language.area_milling import check_rounds
from gcode.language.translate import number

__all__ = ["Face", "layers", "mill_face"]

_MOST = 10_000  #: more lines or levels than this are a mistake


@dataclass(frozen=True)
class Face:
    """What a face milling cycle is told, program units; levels are absolute.

    Attributes
    ----------
    corner : Point
        From which length and width count.
    length, width : float
        Along the lines and across; either sign.
    angle_deg : float
        From the first axis of the plane to the lines.
    step_over : float
        Most between two lines.
    start, before, behind : float
        By which the tool's axis is outside the rectangle where the first line begins, and where
        the others begin and end; below zero: inside.
    one_way : bool
        Every line in the same sense, with the tool above the face between them.
    levels : tuple of (float, float)
        Level and feed of each layer.
    clear, lift : float
        Level where rapids are allowed, and by which the tool rises between lines of one sense.
    plunge_feed, link_feed : float
        Down, and from line to line.
    """

    corner: Point
    length: float
    width: float
    angle_deg: float
    step_over: float
    start: float
    before: float
    behind: float
    one_way: bool
    levels: tuple[tuple[float, float], ...]
    clear: float
    lift: float
    plunge_feed: float
    link_feed: float

    def __post_init__(self) -> None:
        if not self.step_over > 0.0 or abs(self.width) / self.step_over > _MOST:
            raise ProgramError(f"lines of a face {self.step_over:g} apart", accepted="above 0")
        if abs(self.length) + self.before + self.behind <= 0.0 or len(self.levels) > _MOST:
            raise ProgramError(f"a face of {self.length:g} by {self.width:g}",
                               hint="the tool has to fit into it")  # fmt: skip

    def _place(self, along: float, across: float) -> str:
        angle = math.radians(self.angle_deg)
        cosine, sine = math.cos(angle), math.sin(angle)
        x = self.corner[0] + along * cosine - across * sine
        y = self.corner[1] + along * sine + across * cosine
        return f"x{number(x)}y{number(y)}"

    def lines(self) -> list[tuple[str, str]]:
        """Begin and end of every line, one behind the other."""
        count = max(math.ceil(abs(self.width) / self.step_over - 1e-9), 1)
        sense = math.copysign(1.0, self.length)
        end = self.length + sense * self.behind
        found = []
        for k in range(count):
            across = self.width * (k + 0.5) / count
            begin = -sense * (self.before if k else self.start)
            ends = self._place(begin, across), self._place(end, across)
            found.append(ends if self.one_way or k % 2 == 0 else ends[::-1])
        return found


def mill_face(face: Face) -> Iterator[str]:
    """Blocks of a face, layer after layer."""
    lines = face.lines()
    check_rounds(len(lines), len(face.levels))
    yield f"g0{lines[0][0]}"
    yield f"g0z{number(face.clear)}"
    for layer, (level, feed) in enumerate(face.levels):
        turned = layer % 2 == 1 and not face.one_way
        way = [line[::-1] for line in lines[::-1]] if turned else lines
        for k, (begin, end) in enumerate(way):
            if k == 0 or face.one_way:
                yield f"g1z{number(level)}f{number(face.plunge_feed)}"
            else:
                yield f"g1{begin}f{number(face.link_feed)}"
            yield f"g1{end}f{number(feed)}"
            if face.one_way:
                yield f"g0z{number(level + face.lift)}"
                following = way[k + 1][0] if k + 1 < len(way) else way[0][0]
                yield f"g1{following}f{number(face.link_feed)}"
    yield f"g0z{number(face.clear)}"


def layers(top: float, floor: float, most: float) -> list[float]:
    """Levels of even infeeds of at most `most` from the top down to a floor."""
    depth = top - floor
    if not depth > 0.0:
        raise ProgramError(f"depth {floor:g} is not below the surface {top:g}")
    count = math.ceil(depth / most - 1e-9) if most > 0.0 else 1
    if count > _MOST:
        raise ProgramError(f"infeeds of {most:g} make {count} levels")
    return [top - depth * (k + 1) / count for k in range(count)]
