"""What a dialect says of its lines so that some of them can be written out as plain ones."""

from __future__ import annotations

import numpy as np

from gcode.text.source import Source

__all__ = ["PlainBlocks"]


class PlainBlocks:
    """Parts of lines that stay, and plain lines in the place of the others; lengths in mm.

    Parameters
    ----------
    source : Source
    """

    def __init__(self, source: Source) -> None:
        self.source = source

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

    def straight(self, end: np.ndarray, named: list[str], feed: float | None) -> list[str]:
        """A line to a place, X Y Z of which those in `named` are said; rapid without a feed."""
        raise NotImplementedError

    def arc(
        self, start: np.ndarray, end: np.ndarray, centre: np.ndarray, feed: float, *,
        counter_clockwise: bool,
    ) -> list[str] | None:  # fmt: skip
        """An arc in the plane XY about a centre; None for one that has no plain form."""
        raise NotImplementedError

    def pause(self, seconds: float) -> list[str]:
        """A dwell."""
        raise NotImplementedError
