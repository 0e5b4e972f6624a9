"""Soft approach and retraction: G147, G247, G347 to a contour, G148, G248, G348 away from it.

Sources: SINUMERIK ONE, NC Programming 12/2019, 6FC5398-2EP40-0BA0, pages 271 to 273; Function
Manual Basic Functions 01/2015, 6FC5397-0BP40-5BA2, pages 1410 and 1412; SINUMERIK 808D, Programming
and Operating Manual (Milling) 01/2014, 6FC5398-4DP10-0BA1, page 121. P0 to P4 are the points named
there. The tool's centre comes along the contour's tangent, from the side on which it will run: on a
line as long as DISR and its radius, or on a quarter or half circle of radius DISR.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gcode.errors import ProgramError
from gcode.geometry.arcs import Point
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.block_words import Words
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["SoftApproach"]

#: code -> quarters of a circle, 0 a line
_TO = {147.0: 0, 247.0: 1, 347.0: 2}
_AWAY = {148.0: 0, 248.0: 1, 348.0: 2}
_KINDS = frozenset((*_TO, *_AWAY))
_OWN = ("DISR", "DISCL", "FAD")
_SIDES = {41.0: 1, 42.0: -1}
#: codes of such a block that are obeyed with it
_NOT_BESIDE = (2.0, 3.0, 18.0, 19.0)
_DONE = {*_TO, *_AWAY, 0.0, 1.0, 40.0, 41.0, 42.0}


@dataclass(frozen=True)
class _Approach:
    """What a block with G147, G247 or G347 says; it waits for the contour behind it.

    Attributes
    ----------
    quarters : int
    side : int
        1 left of the contour, -1 right of it, 0 on it.
    row : int
        Offset whose radius counts.
    start, end : tuple
        P0 and P4: X, Y and Z.
    said : dict
        DISR, DISCL, FAD, F.
    motion : str
        G code of straight moves before the block.
    """

    quarters: int
    side: int
    row: int
    start: tuple[float, ...]
    end: tuple[float, ...]
    said: dict[str, float]
    motion: str


class SoftApproach:
    """Soft approaches of a program.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader = reader
        self.in_plane = False  #: G341: the circle lies in the plane of the contour
        self.from_side = 140.0  #: G140 to G143
        self.waiting: _Approach | None = None
        self._last: tuple[Words, list[float], tuple[float, ...], tuple[float, ...]] | None = None

    def obey(self, words: Words, g_codes: list[float]) -> bool:
        """Obey a block that approaches or leaves softly; tells whether it was one."""
        if self.waiting is not None:
            self._go_to(words, g_codes)
        kinds = _KINDS.intersection(g_codes)
        for code in g_codes:
            self.in_plane = code == 341.0 if code in (340.0, 341.0) else self.in_plane
            self.from_side = code if 140.0 <= code <= 143.0 else self.from_side
        if kinds:
            self._check(words, next(iter(kinds)))
            (self._wait if kinds & _TO.keys() else self._leave)(words, g_codes)
            return True
        if any(letter in _OWN for letter, _ in words):
            raise ProgramError("DISR, DISCL and FAD without a soft approach",
                               accepted="G147 G148 G247 G248 G347 G348")  # fmt: skip
        if self.reader.controller.side and any(letter in "XY" for letter, _ in words):
            start = tuple(self.reader.here()[:3])
            self._last = list(words), g_codes, start, self.reader.motion.end(words, g_codes)
        return False

    def finish(self) -> None:
        """Refuse what comes between an approach and its contour."""
        if self.waiting is not None:
            raise ProgramError("a soft approach without a line or arc at feed behind it",
                               accepted="G1, G2 or G3 in the next block")  # fmt: skip

    def _check(self, words: Words, code: float) -> None:
        values, name = dict(words), f"G{code:g}"
        self.reader.only_in_xy(name)
        self.reader.corners.finish()
        beside = [value for letter, value in words if letter == "G" and value in _NOT_BESIDE]
        if beside:
            raise ProgramError(f"{name} beside G{beside[0]:g}", accepted="G0 or G1, in G17")
        if not values.get("DISR", 0.0) > 0.0:
            raise ProgramError(f"{name} without DISR", accepted="DISR above 0")
        if "FAD" in values and not self.in_plane:
            raise ProgramError(f"{name} with FAD and G340 is not read", accepted="G341 before it")
        if self.from_side != 140.0:
            raise ProgramError(f"{name} with G{self.from_side:g} is not read", accepted="G140")

    def _wait(self, words: Words, g_codes: list[float]) -> None:
        reader, values = self.reader, dict(words)
        c = reader.controller
        side = next((_SIDES[code] for code in g_codes if code in _SIDES), 0)
        quarters = next(_TO[code] for code in g_codes if code in _TO)
        if c.side or (quarters and not side):
            raise ProgramError("a soft approach within cutter compensation, or a circle without it",
                               accepted="G41 or G42 in its block")  # fmt: skip
        start, end = tuple(reader.here()[:3]), reader.motion.end(words, g_codes)
        said = {k: values[k] for k in (*_OWN, "F") if k in values}
        row = reader.tools.offset if side else 0
        self._others(words, g_codes)
        self.waiting = _Approach(quarters, side, row, start, end, said, _straight(c.motion))

    def _others(self, words: Words, g_codes: list[float]) -> None:
        """The words of the block that do not say the approach itself."""
        kept = [w for w in words if (w[0] == "G" and w[1] not in _DONE) or w[0] in "SM"]
        self.reader.execute(self.reader.words.text(kept))
        motion = next((code for code in g_codes if code in (0.0, 1.0)), None)
        if motion is not None:
            self.reader.controller.motion = f"G{motion:g}"

    def _go_to(self, words: Words, g_codes: list[float]) -> None:
        """From P0 to P4, now that the contour's direction is known."""
        reader, approach = self.reader, self.waiting
        c = reader.controller
        piece = reader.corners.piece(words, g_codes)
        if piece is None:
            self.finish()
        self.waiting = None
        modal, absolute = c.motion, c.absolute
        c.absolute = True
        reader.execute(*self._way_to(approach, piece.heading(piece.start)))
        if approach.side:
            reader.execute(f"g{41 if approach.side > 0 else 42}d{approach.row}")
        reader.execute(f"g1{xy_words(*approach.end[:2])}")
        c.motion, c.absolute = modal, absolute

    def _way_to(self, approach: _Approach, along: Point) -> Iterator[str]:
        said, (_, _, level) = approach.said, approach.end
        radius = self._radius if approach.side else 0.0
        end = _beside(approach.end[:2], along, approach.side * radius)
        begin, middle = _far(end, along, approach, said["DISR"], radius, back=-1.0)
        above = level + abs(said.get("DISCL", 0.0))
        if above > approach.start[2] + 1e-9:
            raise ProgramError(f"a soft approach begins at Z{approach.start[2]:g}, below its DISCL",
                               accepted=f"a start at Z{above:g} or higher")  # fmt: skip
        feed = f"f{number(said['F'])}" if "F" in said else ""
        yield f"{approach.motion}{xy_words(*begin)}"
        yield f"z{number(above)}"
        if self.in_plane and above > level:
            yield f"g1z{number(level)}" + (f"f{number(said['FAD'])}" if "FAD" in said else feed)
        code = "g1" if middle is None else f"g{3 if approach.side > 0 else 2}"
        yield f"{code}{xy_words(*end)}z{number(level)}{_centre(begin, middle)}{feed}"

    @property
    def _radius(self) -> float:
        return self.reader.tools.entry.offset_diameter_mm / 2.0 / self.reader.controller.unit_mm

    def _leave(self, words: Words, g_codes: list[float]) -> None:
        """From P4, the end of the contour, to P0."""
        reader, values = self.reader, dict(words)
        c, side = reader.controller, self.reader.controller.side
        if (
            self._last is None
            or not side
            or 40.0 not in g_codes
            or not {"X", "Y", "Z"} <= set(values)
        ):
            raise ProgramError("a soft retraction is read where it ends cutter compensation",
                               accepted="G40, X, Y and Z in its block")  # fmt: skip
        last, codes, start, end = self._last
        piece = reader.corners.piece(last, codes, start, end)
        if piece is None:
            raise ProgramError("a soft retraction without a line or arc before it",
                               accepted="G1, G2 or G3")  # fmt: skip
        quarters = next(_AWAY[code] for code in g_codes if code in _AWAY)
        said = {k: values[k] for k in (*_OWN, "F") if k in values}
        approach = _Approach(quarters, side, 0, end, reader.motion.end(words, g_codes), said, "")
        self._others(words, g_codes)
        modal, absolute, self._last = c.motion, c.absolute, None
        c.absolute = True
        reader.execute("g40", *self._way_from(approach, piece.heading(piece.end), _straight(modal)))
        c.motion, c.absolute = modal, absolute

    def _way_from(self, approach: _Approach, along: Point, motion: str) -> Iterator[str]:
        said, level, radius = approach.said, approach.start[2], self._radius
        begin = _beside(approach.start[:2], along, approach.side * radius)
        end, middle = _far(begin, along, approach, said["DISR"], radius, back=1.0)
        above = level + abs(said.get("DISCL", 0.0))
        if above > approach.end[2] + 1e-9:
            raise ProgramError(f"a soft retraction ends at Z{approach.end[2]:g}, below its DISCL",
                               accepted=f"an end at Z{above:g} or higher")  # fmt: skip
        height = level if self.in_plane else above
        code = "g1" if middle is None else f"g{3 if approach.side > 0 else 2}"
        yield f"g1{xy_words(*begin)}"
        yield f"{code}{xy_words(*end)}z{number(height)}{_centre(begin, middle)}"
        feed = f"f{number(said['F'])}" if "F" in said else ""
        if above > height:
            yield f"g1z{number(above)}" + (f"f{number(said['FAD'])}" if "FAD" in said else feed)
        yield f"{motion}z{number(approach.end[2])}{feed}"
        yield xy_words(*approach.end[:2])


def _straight(motion: str | None) -> str:
    """How a straight move goes in a mode of motion: rapid, or at feed."""
    return "g0" if motion == "G0" else "g1"


def _beside(place: Point, along: Point, distance: float) -> Point:
    """A place at a distance to the left of a direction."""
    return place[0] - along[1] * distance, place[1] + along[0] * distance


def _far(
    near: Point, along: Point, approach: _Approach, size: float, radius: float, *, back: float
) -> tuple[Point, Point | None]:
    """The far end of the line or circle that touches the path at `near`, and its centre."""
    if not approach.quarters:
        reach = back * (size + radius)
        return (near[0] + reach * along[0], near[1] + reach * along[1]), None
    middle = _beside(near, along, approach.side * size)
    if approach.quarters == 1:
        return (middle[0] + back * size * along[0], middle[1] + back * size * along[1]), middle
    return (2.0 * middle[0] - near[0], 2.0 * middle[1] - near[1]), middle


def _centre(begin: Point, middle: Point | None) -> str:
    if middle is None:
        return ""
    return f"i{number(middle[0] - begin[0])}j{number(middle[1] - begin[1])}"
