"""Look-ahead of cutter compensation: moves wait here until the next one has fixed their end."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from gcode.errors import ProgramError
from gcode.geometry.arcs import arc_angle

__all__ = ["CompensationQueue", "WaitingMove"]

_GOUGE = "in concave corner cannot be reached by the tool without gouging"


@dataclass
class WaitingMove:
    """A compensated move whose end may still be moved; coordinates in the plane's order.

    Attributes
    ----------
    name : str
        ``Straight feed``, ``Straight traverse`` or ``Arc move``.
    end : tuple of float
        First and second coordinate of the end.
    direction : tuple of float
        Programmed direction of a straight move.
    centre : tuple of float
        Of an arc.
    turns : int
        Of an arc, 0 for a straight move.
    programmed_angle_rad : float
        Swept by the programmed arc; 0 for the arc about a convex corner.
    issue : callable
        Says the move to the machine with the final end.
    """

    name: str
    end: tuple[float, float]
    issue: Callable[[tuple[float, float]], None]
    direction: tuple[float, float] = (0.0, 0.0)
    centre: tuple[float, float] = (0.0, 0.0)
    turns: int = 0
    programmed_angle_rad: float = 0.0


@dataclass
class CompensationQueue:
    """Waiting moves and whatever was said between them.

    Attributes
    ----------
    items : list
        `WaitingMove`, or a callable to run in its turn.
    start : tuple of float or None
        Where the first waiting move starts, if that is settled.
    """

    items: list[WaitingMove | Callable[[], None]] = field(default_factory=list)
    start: tuple[float, float] | None = None

    def say(self, action: Callable[[], None]) -> None:
        """Run `action` after the waiting moves, at once where none waits."""
        if self.items:
            self.items.append(action)
        else:
            action()

    @property
    def first(self) -> WaitingMove | None:
        """The oldest waiting item if it is a move."""
        return self.items[0] if self.items and isinstance(self.items[0], WaitingMove) else None

    def release(self) -> None:
        """Say everything that waits."""
        self.start = None
        items, self.items = self.items, []
        for item in items:
            if isinstance(item, WaitingMove):
                item.issue(item.end)
            else:
                item()

    def release_to(self, point: tuple[float, float], *, unit_mm: float) -> None:
        """Move the end of the waiting moves to `point` and say them.

        Raises
        ------
        ProgramError
            Where a move would have to run backwards or further than programmed: gouging.
        """
        if not self.items:
            return
        for item in self.items:
            if isinstance(item, WaitingMove):
                self._check(item, point, unit_mm)
                item.end = point
        self.release()
        self.start = point

    def _check(self, move: WaitingMove, point: tuple[float, float], unit_mm: float) -> None:
        if not move.turns:
            if self.start is None:
                return
            along = (point[0] - self.start[0], point[1] - self.start[1])
            if move.direction[0] * along[0] + move.direction[1] * along[1] < 0.0:
                raise ProgramError(f"{move.name} {_GOUGE}", hint="use a smaller tool")
            return
        radius = math.hypot(move.end[0] - move.centre[0], move.end[1] - move.centre[1])
        moved = math.hypot(point[0] - move.centre[0], point[1] - move.centre[1])
        if abs(radius - moved) > 0.01:
            raise ProgramError(
                f"cutter compensation cannot keep the arc's radius: {radius:g} becomes {moved:g}"
            )
        if move.programmed_angle_rad != 0.0 and self.start is not None:
            angle = arc_angle(self.start, point, move.centre, move.turns)
            slack = 0.0254 if unit_mm == 1.0 else 0.001
            if abs(angle) > abs(move.programmed_angle_rad) + slack:
                raise ProgramError(f"{move.name} {_GOUGE}", hint="use a smaller tool")

    def scale(self, factor: float) -> None:
        """Change the unit of everything that waits."""
        for item in self.items:
            if isinstance(item, WaitingMove):
                item.end = (item.end[0] * factor, item.end[1] * factor)
                item.centre = (item.centre[0] * factor, item.centre[1] * factor)
        if self.start is not None and self.items:
            self.start = (self.start[0] * factor, self.start[1] * factor)
