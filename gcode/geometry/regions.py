"""Regions of a plane bounded by lines and arcs: united, cut out of each other, and shrunk.

Arcs become chords that leave them by `CHORD_MM` at most; the library manifold3d does the rest.

Source: closed form derived here: a chord leaves an arc of radius r and angle a by
r (1 - cos(a / 2)).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from gcode.errors import ProgramError
from gcode.geometry.arcs import Point

__all__ = ["CHORD_MM", "Region", "Stretch", "closed_area", "polyline"]

#: half of what controls resolve
CHORD_MM = 5e-4
#: vertices closer to a line than this are left out
_STRAIGHT = 1e-9
_MOST_CHORDS = 1_000_000  #: of an arc: a circle of a radius of 100 km


@dataclass(frozen=True)
class Stretch:
    """A line to `end`, or an arc about `centre` that turns by `sweep_rad`, positive ccw."""

    end: Point
    centre: Point | None = None
    sweep_rad: float = 0.0


def _steps(radius: float, sweep_rad: float, chord: float) -> int:
    """Chords of an arc; raises ProgramError where they are too many for any part."""
    # 1 - cos(a / 2) = 2 sin^2(a / 4), which a large radius does not round away
    angle = 4.0 * math.asin(math.sqrt(chord / (2.0 * radius))) if radius > chord else math.pi / 2.0
    steps = abs(sweep_rad) / angle if angle > 0.0 else math.inf
    if steps > _MOST_CHORDS:
        raise ProgramError(f"an arc of radius {radius:g} in a contour", 
                           hint="is its decimal point right?")  # fmt: skip
    return max(math.ceil(steps), 1)


def polyline(start: Point, way: Sequence[Stretch], chord: float) -> list[Point]:
    """Vertices of a way, its start first; chords leave its arcs by `chord` at most."""
    places = [start]
    for stretch in way:
        if stretch.centre is not None:
            x, y = places[-1][0] - stretch.centre[0], places[-1][1] - stretch.centre[1]
            steps = _steps(math.hypot(x, y), stretch.sweep_rad, chord)
            for k in range(1, steps):
                angle = stretch.sweep_rad * k / steps
                cosine, sine = math.cos(angle), math.sin(angle)
                places.append((stretch.centre[0] + x * cosine - y * sine,
                               stretch.centre[1] + x * sine + y * cosine))  # fmt: skip
        places.append(stretch.end)
    return places


def closed_area(places: Sequence[Point]) -> float:
    """Area within a polygon, positive where it is gone round counter-clockwise."""
    return 0.5 * sum(
        a[0] * b[1] - b[0] * a[1] for a, b in zip(places, (*places[1:], places[0]), strict=True)
    )


class Region:
    """A part of the plane.

    Parameters
    ----------
    polygons : sequence of sequence of Point
        Whose insides are united, in any sense.
    """

    def __init__(self, polygons: Sequence[Sequence[Point]]) -> None:
        from manifold3d import CrossSection, FillRule

        self._section = CrossSection()
        for polygon in polygons:
            self._section = self._section + CrossSection([list(polygon)], FillRule.NonZero)

    def without(self, other: Region) -> Region:
        """What of it lies outside another."""
        return self._of(self._section - other._section)

    def shrunk(self, distance: float, chord: float) -> Region:
        """Points that are so far from the outside."""
        from manifold3d import JoinType

        corners = _steps(max(abs(distance), chord), math.tau, chord)
        return self._of(self._section.offset(-distance, JoinType.Round, 2.0, corners))

    @staticmethod
    def _of(section: object) -> Region:
        region = Region(())
        region._section = section
        return region

    def rings(self, leaving: float = _STRAIGHT) -> list[list[Point]]:
        """Its boundaries, left by `leaving` at most: outer ones ccw, holes clockwise."""
        section = self._section.simplify(leaving)
        return [[(float(x), float(y)) for x, y in ring] for ring in section.to_polygons()]
