"""A slot along an arc with round ends, and its offsets.

Source: closed form derived here: offsets have the same middle line, and half the width less by the
distance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from gcode.geometry.arcs import Point
from gcode.geometry.outlines import Element

__all__ = ["CurvedSlot"]

_NOTHING = 1e-9


@dataclass(frozen=True)
class CurvedSlot:
    """A slot along an arc, program units.

    Attributes
    ----------
    centre : Point
        Of the arc.
    radius : float
        Of the middle line.
    start_deg, length_deg : float
        Angle of the first end's middle, and from there to the other, counter-clockwise.
    half_width : float
    """

    centre: Point
    radius: float
    start_deg: float
    length_deg: float
    half_width: float

    def grown(self, distance: float) -> CurvedSlot | None:
        """The outline that far outside (negative: inside); None where nothing is left."""
        width = self.half_width + distance
        return None if width < -_NOTHING else replace(self, half_width=max(width, 0.0))

    @property
    def is_point(self) -> bool:
        """Never: what is left is the middle line."""
        return False

    @property
    def half_length(self) -> float:
        """Half of what is across, for messages."""
        return self.half_width

    def _at(self, radius: float, angle_deg: float) -> Point:
        angle = math.radians(angle_deg)
        return (
            self.centre[0] + radius * math.cos(angle),
            self.centre[1] + radius * math.sin(angle),
        )

    @property
    def start(self) -> Point:
        """First end of the outer wall."""
        return self._at(self.radius + self.half_width, self.start_deg)

    def round(self, *, clockwise: bool) -> list[Element]:
        """The way round from `start` to `start`; elements against the sense are marked."""
        first, last = self.start_deg, self.start_deg + self.length_deg
        outer, inner = self.radius + self.half_width, self.radius - self.half_width
        ends = [Element(self._at(inner, last), self._at(self.radius, last)),
                Element(self.start, self._at(self.radius, first))]  # fmt: skip
        if self.half_width <= _NOTHING:
            there = Element(self._at(outer, last), self.centre, against=clockwise)
            return [there, Element(self.start, self.centre, against=not clockwise)]
        if not clockwise:
            back = Element(self._at(inner, first), self.centre, against=True)
            return [Element(self._at(outer, last), self.centre), ends[0], back, ends[1]]
        return [Element(self._at(inner, first), self._at(self.radius, first)),
                Element(self._at(inner, last), self.centre, against=True),
                Element(self._at(outer, last), self._at(self.radius, last)),
                Element(self.start, self.centre)]  # fmt: skip
