"""CYCLE72: along a contour, which is a subprogram or lies between two labels.

Source: SINUMERIK ONE, NC Programming, Programming Manual 12/2019, 6FC5398-2EP40-0BA0, page 1053:
the first eleven arguments. RL (40, 41, 42), AS1 and AS2 (1 a straight approach, 2 a quadrant, 3 a
semicircle), LP1 and LP2 (its length or radius) and FF3 are from memory.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.cycles.modes import check_milling_modes
from gcode.errors import ProgramError
from gcode.geometry.arcs import Point
from gcode.language.contours import Contour, contour_of
from gcode.language.face_milling import layers
from gcode.language.translate import number, xy_words
from gcode.state.controller import Controller

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["mill_along"]

_ARGUMENTS = "RTP RFP SDIS DP MID FAL FALD FFP1 FFD VARI RL AS1 LP1 FF3 AS2 LP2"
_SIDES = {40: 0, 41: 1, 42: -1}
#: hundreds of VARI -> how the tool comes to the next level: RTP, clear, by SDIS, not at all
_RETRACTIONS = (0, 1, 2, 3)


def mill_along(reader: SinumerikReader, text: str) -> None:
    """Do the cycle; the tool ends on the retraction plane."""
    name, _, rest = text.partition(",")
    names, values = _ARGUMENTS.split(), reader.arguments(rest)
    check_milling_modes("CYCLE72", values[len(names) :], reader.cycle_plane)
    said = dict(zip(names, values, strict=False))
    said = {key: value for key, value in said.items() if value is not None}
    missing = [key for key in ("RTP", "DP", "FFP1", "VARI", "RL") if key not in said]
    if missing or not name.strip(' "'):
        raise ProgramError(f"CYCLE72 without {missing[0] if missing else 'a contour'}")
    c = reader.controller
    reader.controller.use("order of the arguments of CYCLE72 behind number 11")
    c.note("CYCLE72", "the way to the contour is the control's own")
    cycle = _Along(reader, _contour(reader, name.strip(' "'), said["RL"]), said)
    modal, absolute, c.absolute = c.motion, c.absolute, True
    reader.execute(*cycle.blocks())
    c.motion, c.absolute = modal, absolute


def _contour(reader: SinumerikReader, name: str, side: float) -> Contour:
    """Go along the contour with a controller of its own, without moving anything."""
    if side not in _SIDES:
        raise ProgramError(f"CYCLE72 with RL {side:g}", accepted="40, 41 or 42")
    outer = reader.controller
    controller = Controller(outer.tools, outer.tolerance, outer.machine_unit_mm)
    inner = reader.apart(controller)
    inner.execute("g20" if outer.unit_mm != 1.0 else "g21", "f1")
    first, _, last = name.partition(":")
    if last:
        inner.next, inner.stop = inner.flow.line_of(first), inner.flow.line_of(last) + 1
    else:
        inner.next = inner.stop
        inner.subprograms.call(name, [])
    try:
        inner.run()
    except ProgramError as error:
        raise ProgramError(f"contour {name}: {error.what}", accepted=error.accepted,
                           hint=error.hint) from None  # fmt: skip
    return contour_of(controller, f"contour {name}", _SIDES[int(side)])


class _Along:
    """One CYCLE72 with its arguments."""

    def __init__(self, reader: SinumerikReader, contour: Contour, said: dict[str, float]) -> None:
        self.contour, self.said = contour, said
        diameter = reader.tools.entry.offset_diameter_mm
        self.tool_radius = diameter / 2.0 / reader.controller.unit_mm
        self.kind, self.link, self.out, backward = (
            int(said["VARI"]) // 10**k % 10 for k in (0, 1, 2, 4)
        )
        if self.kind not in (1, 2) or self.link > 1 or self.out not in _RETRACTIONS or backward:
            raise ProgramError(
                f"CYCLE72 with VARI {said['VARI']:g}",
                accepted="1 or 2, tens 0 or 1, hundreds 0 to 3, forwards",
            )

    def a(self, name: str, default: float = 0.0) -> float:
        """An argument."""
        return self.said.get(name, default)

    def _away(self, place: Point, direction: Point, *, leaving: bool) -> tuple[Point, str]:
        """Where an approach begins or a retraction ends, and its G code with I and J or nothing."""
        kind = int(self.a("AS2", self.a("AS1", 1.0)) if leaving else self.a("AS1", 1.0)) % 10
        size = abs(self.a("LP2", self.a("LP1")) if leaving else self.a("LP1"))
        side, (u, v) = self.contour.side, direction
        back = 1.0 if leaving else -1.0
        if kind == 1:
            return (place[0] + back * size * u, place[1] + back * size * v), "g1"
        if kind not in (2, 3) or not side:
            raise ProgramError(f"CYCLE72 with AS1 or AS2 {kind}", accepted="1; beside it 2 and 3")
        centre = place[0] - v * side * size, place[1] + u * side * size
        if kind == 2:
            far = centre[0] + back * size * u, centre[1] + back * size * v
        else:
            far = 2.0 * centre[0] - place[0], 2.0 * centre[1] - place[1]
        begin = place if leaving else far
        middle = f"i{number(centre[0] - begin[0])}j{number(centre[1] - begin[1])}"
        return far, f"g{3 if side > 0 else 2}{middle}"

    def blocks(self) -> Iterator[str]:
        """The cycle as blocks of RS274/NGC."""
        surface = self.a("RFP")
        rough = self.kind == 1
        floor = self.a("DP") + (abs(self.a("FALD")) if rough else 0.0)
        distance = self.tool_radius + (abs(self.a("FAL")) if rough else 0.0)
        begin, end = self.contour.ends_beside(distance if self.contour.side else 0.0)
        first, lead_in = self._away(begin, self.contour.first_direction, leaving=False)
        last, lead_out = self._away(end, self.contour.last_direction, leaving=True)
        clear = surface + abs(self.a("SDIS"))
        feed, down = f"f{number(self.a('FFP1'))}", f"f{number(self.a('FFD', self.a('FFP1')))}"
        link = f"g1f{number(self.a('FF3', self.a('FFP1')))}" if self.link else "g0"
        yield f"g0z{number(max(self.a('RTP'), clear))}"
        yield f"g0{xy_words(*first)}"
        yield f"g0z{number(clear)}"
        for level in layers(surface, floor, abs(self.a("MID"))):
            yield f"{link}{xy_words(*first)}"
            yield f"g1z{number(level)}{down}"
            yield f"{lead_in}{xy_words(*begin)}{feed}"
            yield from self._wall(distance, end)
            yield f"{lead_out}{xy_words(*last)}"
            height = (self.a("RTP"), clear, level + abs(self.a("SDIS")), level)[self.out]
            yield f"g0z{number(height)}"
        yield f"g0z{number(self.a('RTP'))}"

    def _wall(self, distance: float, end: Point) -> Iterator[str]:
        """Along the contour: the compensated path begins and ends where the tool stands."""
        if not self.contour.side:
            yield from self.contour.blocks()
            return
        code = "g41.1" if self.contour.side > 0 else "g42.1"
        yield f"{code}d{number(2.0 * distance)}"
        yield f"g1{xy_words(*self.contour.start)}"
        yield from self.contour.blocks()
        yield "g40"
        yield f"g1{xy_words(*end)}"
