"""Rounded rectangles: the outlines of pockets, slots and studs, and their offsets.

Source: closed form derived here. An offset of a rectangle with rounded corners is one again, with
half sides and corner radius less by the distance. A circle is one whose corners meet, a slot one
whose ends do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from gcode.geometry.arcs import Point

__all__ = ["Element", "Outline"]

_NOTHING = 1e-9


@dataclass(frozen=True)
class Element:
    """A line, or an arc about `centre`, to `end`; arcs turn as the outline is gone round."""

    end: Point
    centre: Point | None = None
    against: bool = False  #: the arc turns the other way


@dataclass(frozen=True)
class Outline:
    """A rectangle with rounded corners, program units.

    Attributes
    ----------
    centre : Point
    half_length, half_width : float
        Along and across `angle_deg`.
    corner : float
        Radius of the corners.
    angle_deg : float
        From the first axis of the plane to the length.
    """

    centre: Point
    half_length: float
    half_width: float
    corner: float
    angle_deg: float = 0.0

    @classmethod
    def circle(cls, centre: Point, radius: float) -> Outline:
        """A circle."""
        return cls(centre, radius, radius, radius)

    @classmethod
    def slot(cls, centre: Point, length: float, width: float, angle_deg: float) -> Outline:
        """A slot whose ends are semicircles; `length` over all."""
        return cls(centre, length / 2.0, width / 2.0, width / 2.0, angle_deg)

    def grown(self, distance: float) -> Outline | None:
        """The outline that far outside (negative: inside); None where nothing is left."""
        length, width = self.half_length + distance, self.half_width + distance
        if min(length, width) < -_NOTHING:
            return None
        corner = self.corner + distance
        if distance > 0.0 and self.corner == 0.0:
            corner = distance  # a mill goes round a sharp corner
        length, width = max(length, 0.0), max(width, 0.0)
        return replace(
            self, half_length=length, half_width=width, corner=min(max(corner, 0.0), length, width)
        )

    @property
    def is_point(self) -> bool:
        """Nothing but its centre."""
        return max(self.half_length, self.half_width) <= _NOTHING

    def place(self, along: float, across: float) -> Point:
        """A point given along and across."""
        angle = math.radians(self.angle_deg)
        cosine, sine = math.cos(angle), math.sin(angle)
        return (
            self.centre[0] + along * cosine - across * sine,
            self.centre[1] + along * sine + across * cosine,
        )

    @property
    def start(self) -> Point:
        """Middle of the side at positive `across`, where the way round begins and ends."""
        return self.place(0.0, self.half_width)

    def round(self, *, clockwise: bool) -> list[Element]:
        """The way round from `start` to `start`."""
        sign = 1.0 if clockwise else -1.0  # first along + for clockwise
        straight, across = self.half_length - self.corner, self.half_width - self.corner
        corners = ((sign, 1.0), (sign, -1.0), (-sign, -1.0), (-sign, 1.0))
        here, found = (0.0, self.half_width), []

        def go(along: float, up: float, centre: Point | None = None) -> None:
            nonlocal here
            if math.dist(here, (along, up)) > _NOTHING:
                found.append(Element(self.place(along, up), centre))
                here = (along, up)

        for index, (a, b) in enumerate(corners):
            middle = a * straight, b * across
            on_side = (middle[0], b * self.half_width)
            on_end = (a * self.half_length, middle[1])
            first, second = (on_side, on_end) if index % 2 == 0 else (on_end, on_side)
            go(*first)
            go(*second, self.place(*middle) if self.corner > _NOTHING else None)
        go(0.0, self.half_width)
        return found
