"""What a dialect says of its lines so that some of them can be written out as plain ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gcode.text.source import Source

__all__ = ["PlainArc", "PlainBlocks"]


@dataclass(frozen=True)
class PlainArc:
    """An arc or a helix in the plane XY, in units of the program.

    Attributes
    ----------
    start, end, centre : (3,) float64
        Absolute.
    sweep_rad : float
        Counter-clockwise above zero; more than a turn for a helix of several.
    absolute : bool
        The end is said as a place (G90), and not from the start (G91).
    """

    start: np.ndarray
    end: np.ndarray
    centre: np.ndarray
    sweep_rad: float
    absolute: bool = True

    @property
    def said(self) -> np.ndarray:
        """X Y Z of its end as the mode has them, (3,)."""
        return self.end if self.absolute else self.end - self.start

    @property
    def rise(self) -> float:
        """From the level of the start to that of the end."""
        return float(self.end[2] - self.start[2])


class PlainBlocks:
    """Parts of lines that stay, and plain lines for the others, in units of the program.

    Parameters
    ----------
    source : Source
    options : mapping of str to str
        Parameters of the control, see `gcode.language.options.ControlSettings`.
    """

    def __init__(self, source: Source, options: Mapping[str, str] | None = None) -> None:
        self.source, self.options = source, options or {}

    def last_line(self, line: int) -> int:
        """Last line of the block that begins in a line."""
        return line

    def waits(self, line: int) -> bool:
        """Whether other lines make its moves, so that it goes where they are written out."""
        raise NotImplementedError

    def sets_pole(self, line: int) -> bool:
        """Whether it says the circle centre of lines to come."""
        return False

    def needs_pole(self, line: int) -> bool:
        """Whether its end depends on a circle centre that plain arcs change."""
        return False

    def says_feed(self, line: int) -> bool:
        """Whether it has a feed of its own that holds on."""
        raise NotImplementedError

    def says_motion(self, line: int) -> bool:
        """Whether it says what kind of motion it is."""
        raise NotImplementedError

    def is_in_machine_coordinates(self, line: int) -> bool:
        """Whether its numbers count from machine zero."""
        raise NotImplementedError

    def framed(self, line: int, blocks: list[str]) -> list[str]:
        """Blocks with what stays of the line that they replace."""
        raise NotImplementedError

    def feed_unit_mm(self, line: int, unit_mm: float) -> float:
        """Unit of F in a line whose lengths have the unit `unit_mm`, mm."""
        return unit_mm

    def straight(self, end: np.ndarray, named: list[str], feed: float | None) -> list[str]:
        """A line with those of X Y Z, `end`, that are in `named`; rapid without a feed."""
        raise NotImplementedError

    def arc(self, arc: PlainArc, feed: float) -> list[str] | None:
        """An arc; None for one that has no plain form."""
        raise NotImplementedError

    def pause(self, seconds: float) -> list[str]:
        """A dwell."""
        raise NotImplementedError
