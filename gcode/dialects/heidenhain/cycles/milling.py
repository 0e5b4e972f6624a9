"""Klartext cycles 208, 251 to 254 and 256 to 258: pockets, slots, studs and bores.

HEIDENHAIN TNC 640, User's Manual Cycle Programming, "Fixed cycles: pocket milling / stud milling /
slot milling" and "Bore milling".
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.cycles.parameter import cycle_parameter
from gcode.dialects.heidenhain.tool_call import tool_of_spindle
from gcode.errors import ProgramError
from gcode.geometry.arcs import Point
from gcode.geometry.curved_slot import CurvedSlot
from gcode.geometry.outlines import Outline
from gcode.geometry.polygons import Polygon
from gcode.language.area_milling import Area, mill_bore, mill_pocket, mill_stud
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["MILLING", "mill"]

MILLING = frozenset((208, 251, 252, 253, 254, 256, 257, 258))
_STUDS = frozenset((256, 257, 258))
#: Q370 where it is not said: TNC 640, cycle 251
_OVERLAP = 1.0
#: Q367 -> where the tool stands, in half lengths and half widths from the centre
_CORNERS = {0: (0, 0), 1: (-1, -1), 2: (1, -1), 3: (1, 1), 4: (-1, 1)}


class _Data:
    """Q parameters of a cycle at the present place."""

    def __init__(self, reader: KlartextReader, number: int, data: Mapping[str, float]) -> None:
        self.reader, self.number, self.data = reader, number, data
        self.turned_deg = 0.0  #: of a repetition of cycle 254
        self.here = tuple(reader.here()[:2])
        unit = reader.controller.unit_mm
        self.tool_radius = tool_of_spindle(reader).offset_diameter_mm / 2.0 / unit

    def q(self, number: int, default: float | None = None) -> float:
        """A parameter."""
        return cycle_parameter(self.data, self.number, number, default)

    def reference(self, half_length: float, half_width: float, angle_deg: float) -> Point:
        """Centre of a pocket whose place Q367 the tool stands at."""
        place = int(self.q(367, 0.0))
        if self.number == 253:
            inner = half_length - half_width
            aside = {0: 0.0, 1: -half_length, 2: -inner, 3: inner, 4: half_length}.get(place)
            aside = None if aside is None else (aside, 0.0)
        else:
            sides = _CORNERS.get(place)
            aside = None if sides is None else (sides[0] * half_length, sides[1] * half_width)
        if aside is None:
            raise ProgramError(f"Q367={self.q(367):g}", accepted="0 to 4")
        shape = Outline(self.here, half_length, half_width, 0.0, angle_deg)
        return shape.place(-aside[0], -aside[1])

    def curved_slot(self) -> CurvedSlot:
        """Cycle 254: round Q216, Q217, or through where the tool stands (Q367 = 1, 2, 3)."""
        radius, first, length = self.q(375) / 2.0, self.q(376), self.q(248)
        place = int(self.q(367, 0.0))
        if place not in (0, 1, 2, 3):
            raise ProgramError(f"Q367={place}", accepted="0 to 3")
        centre = self.q(216, 0.0), self.q(217, 0.0)
        if place:
            at = first + {1: 0.0, 2: length / 2.0, 3: length}[place]
            out = math.radians(at)
            centre = (self.here[0] - radius * math.cos(out), self.here[1] - radius * math.sin(out))
        if length < 0.0:
            first, length = first + length, -length
        return CurvedSlot(centre, radius, first + self.turned_deg, length, self.q(219) / 2.0)

    def polygon(self) -> Polygon:
        """Cycle 258: Q571 is the inscribed circle, with Q573 = 1 the circumscribed one."""
        count, corner = int(self.q(572)), self.q(220, 0.0)
        if not 3 <= count <= 30 or corner < 0.0:
            raise ProgramError(f"Q572={count} with Q220={corner:g}",
                               accepted="3 to 30 corners that are sharp or round")  # fmt: skip
        circle = self.q(571) / 2.0
        inner = circle * math.cos(math.pi / count) if self.q(573, 0.0) else circle
        return Polygon(self.here, inner, count, corner, self.q(224, 0.0))

    def outline(self) -> Outline | CurvedSlot | Polygon:
        """The finished wall."""
        if self.number == 258:
            return self.polygon()
        if self.number == 254:
            return self.curved_slot()
        if self.number == 252:
            return Outline.circle(self.here, self.q(223) / 2.0)
        if self.number == 257:
            return Outline.circle(self.here, self.q(223) / 2.0)
        if self.number == 208:
            return Outline.circle(self.here, self.q(335) / 2.0)
        angle = self.q(374, 0.0) if self.number == 253 else self.q(224, 0.0)
        length, width = self.q(218) / 2.0, self.q(219) / 2.0
        centre = self.reference(length, width, angle)
        if self.number == 253:
            return Outline.slot(centre, 2.0 * length, 2.0 * width, angle)
        corner = self.q(220, 0.0)
        if self.number == 251:
            corner = max(corner, self.tool_radius)
        return Outline(centre, length, width, corner, angle)

    def blank(self, outline: Outline | CurvedSlot | Polygon) -> Outline | None:
        """What stands round a stud."""
        if self.number in (257, 258):
            return Outline.circle(self.here, self.q(222) / 2.0)
        if self.number == 256:
            return Outline(
                outline.centre, self.q(424) / 2.0, self.q(425) / 2.0, 0.0, outline.angle_deg
            )
        return None

    def area(self) -> Area:
        """What is to be milled."""
        outline, surface = self.outline(), self.q(203, 0.0)
        operation, feed = int(self.q(215, 0.0)), self._feed(207)
        if operation not in (0, 1, 2):
            raise ProgramError(f"Q215={operation}", accepted="0 to 2")
        climb = self.q(351, 1.0) >= 0.0
        stands = self.number in _STUDS
        return Area(
            outline=outline,
            tool_radius=self.tool_radius,
            surface=surface,
            bottom=surface + self.q(201),
            clear=surface + self.q(200),
            step_down=abs(self.q(202, 0.0)),
            step_over=min(max(self.q(370, _OVERLAP), 0.1), 1.9) * self.tool_radius,
            feed=feed,
            plunge_feed=self._feed(206, feed),
            finish_feed=self._feed(385, feed),
            side_allowance=self.q(368, 0.0),
            floor_allowance=self.q(369, 0.0),
            rough=operation in (0, 1),
            finish=operation in (0, 2),
            clockwise=climb if stands else not climb,
            blank=self.blank(outline),
        )

    def _feed(self, number: int, default: float | None = None) -> float:
        feed = self.data.get(str(number), default)
        if feed is None:
            feed = self.reader.motion.tool_feed
        if not feed or not math.isfinite(feed):
            raise ProgramError(f"Q{number} of cycle {self.number} is missing")
        return feed

    def blocks(self) -> Iterator[str]:
        """The cycle as blocks of RS274/NGC."""
        if self.number == 208:
            self.data = {"202": 0.0, "207": self.q(206), **self.data}
            return mill_bore(self.area(), self.q(334))
        if self.number in _STUDS:
            return mill_stud(self.area())
        return mill_pocket(self.area())


def mill(reader: KlartextReader, kind: int, data: Mapping[str, float]) -> None:
    """Do a cycle at the present place; the tool ends above it."""
    cycle = _Data(reader, kind, data)
    clear = cycle.q(203, 0.0) + cycle.q(200)
    out = max(clear, cycle.q(203, 0.0) + cycle.q(204, 0.0))
    reader.controller.note(
        f"CYCL DEF {kind}",
        "the way through the material is the control's "
        "own; rings are taken here, walls and floor are those of the cycle",
    )
    rounds = max(int(cycle.q(377, 1.0)), 1) if kind == 254 else 1
    for turn in range(rounds):
        cycle.turned_deg = turn * cycle.q(378, 0.0)
        reader.execute(
            f"g0z{number(max(out, reader.here()[2]))}", *cycle.blocks(), f"g0z{number(out)}"
        )
    reader.execute(f"g0{xy_words(cycle.here[0], cycle.here[1])}")
