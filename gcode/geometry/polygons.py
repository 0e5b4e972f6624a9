"""Regular polygons with rounded corners: the outline of a polygon stud, and its offsets.

Source: closed form derived here: an offset of a regular polygon is one again, its inscribed circle
and its corners larger by the distance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from gcode.geometry.arcs import Point
from gcode.geometry.outlines import Element

__all__ = ["Polygon"]

_NOTHING = 1e-9


@dataclass(frozen=True)
class Polygon:
    """A regular polygon, program units.

    Attributes
    ----------
    centre : Point
    inner_radius : float
        Of the inscribed circle.
    count : int
        Corners.
    corner : float
        Radius of the corners.
    angle_deg : float
        From the first axis of the plane to a corner.
    """

    centre: Point
    inner_radius: float
    count: int
    corner: float
    angle_deg: float = 0.0

    @property
    def half_length(self) -> float:
        """Half across flats."""
        return self.inner_radius

    half_width = half_length

    def grown(self, distance: float) -> Polygon:
        """The polygon that far outside."""
        return replace(
            self, inner_radius=self.inner_radius + distance, corner=max(self.corner + distance, 0.0)
        )

    def _at(self, radius: float, angle: float) -> Point:
        return (self.centre[0] + radius * math.cos(angle),
                self.centre[1] + radius * math.sin(angle))  # fmt: skip

    @property
    def start(self) -> Point:
        """Middle of the side behind the first corner, where the way round begins and ends."""
        return self._at(self.inner_radius, math.radians(self.angle_deg) + math.pi / self.count)

    def round(self, *, clockwise: bool) -> list[Element]:
        """The way round from `start` to `start`."""
        half = math.pi / self.count
        out = (self.inner_radius - self.corner) / math.cos(half)
        first, sense, found = math.radians(self.angle_deg), -1.0 if clockwise else 1.0, []
        order = range(1, self.count + 1) if not clockwise else range(0, -self.count, -1)
        for k in order:
            middle = self._at(out, first + 2.0 * half * k)
            normals = [first + half * (2 * k - sense), first + half * (2 * k + sense)]
            ends = [(middle[0] + self.corner * math.cos(a), middle[1] + self.corner * math.sin(a))
                    for a in normals]  # fmt: skip
            found.append(Element(ends[0]))
            if self.corner > _NOTHING:
                found.append(Element(ends[1], middle))
        return [*found, Element(self.start)]
