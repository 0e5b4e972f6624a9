"""Plain motion of Klartext in the fast lane."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gcode.dialects.heidenhain.motion import centre_of_radius
from gcode.dialects.heidenhain.side_planes import XY
from gcode.fast.klartext_lines import (
    BLOCK,
    KLARTEXT,
    LINE,
    NO_PIECE,
    RADIUS,
    obey_klartext_lines,
)
from gcode.language.translated_lane import TranslatedLane

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["KlartextLane"]

_M_CODES = frozenset((3, 4, 5, 7, 8, 9, 13, 14))


class KlartextLane(TranslatedLane):
    """Compiled reading of one program.

    Parameters
    ----------
    reader : KlartextReader
        What it remembers beside the controller is handed over as well.
    data : bytes
        Its lines; each ends with a new line.
    starts : (lines + 1,) int64
        Offset of each line's first byte, and of the end.
    """

    reader: KlartextReader
    tells_lines = True

    def __init__(self, reader: KlartextReader, data: bytes, starts: np.ndarray) -> None:
        super().__init__(reader, data, starts)
        self.block, self.klartext = np.zeros(1, BLOCK), np.zeros(2, KLARTEXT)

    @property
    def is_here(self) -> bool:
        """The lines are those of the program itself, and every word means what it says."""
        reader, motion = self.reader, self.reader.motion
        before = reader.lines[reader.next - 1] if reader.next else ""
        return (
            super().is_here
            and not before.rstrip().endswith("~")  # which takes the next line with it
            and motion.corners.waiting is None
            and motion.sides is None
            and motion.plunge_share is None
            and not reader.cycles.modal
            and reader.frames.scaling.is_identity
            and reader.controller.absolute
            and _M_CODES.isdisjoint(reader.options.control.ignore_m)
        )

    def hand_over(self) -> bool:
        """Put the state of controller and reader into the records."""
        motion, k = self.reader.motion, self.klartext[0]
        has_pole = motion.pole is not None and motion.pole_axes == XY
        k["pole"] = motion.pole if has_pole else math.nan
        k["feed"] = math.nan if motion.feed is None else motion.feed
        k["tool_feed"] = math.nan if motion.tool_feed is None else motion.tool_feed
        k["piece"] = NO_PIECE
        return super().hand_over()

    def give_back(self) -> None:
        """Take the state of controller and reader over from the records."""
        super().give_back()
        motion, k = self.reader.motion, self.klartext[0]
        motion.corners.corner = None
        x, y = k["pole"].tolist()
        if not math.isnan(x):
            motion.pole, motion.pole_axes = (x, y), XY
        feed = float(k["feed"])
        motion.feed = None if math.isnan(feed) else feed
        self._give_back_tangent()

    def _give_back_tangent(self) -> None:
        motion, k = self.reader.motion, self.klartext[0]
        kind, sense = int(k["piece"]), int(k["sense"])
        start, end, centre = (tuple(k[name].tolist()) for name in ("start", "end", "centre"))
        if kind == LINE:
            motion.tangent = end, end[0] - start[0], end[1] - start[1]
        elif kind != NO_PIECE:
            if kind == RADIUS:
                centre = centre_of_radius(start, end, float(k["radius"]) * sense)
            motion.tangent = end, (centre[1] - end[1]) * sense, (end[0] - centre[0]) * sense

    def obey(self, data: np.ndarray, place: tuple[int, int], _: None) -> tuple[int, int]:
        """Obey lines until there is no more room; gives offset and 0-based line behind them."""
        return obey_klartext_lines(data, place[1], place[0], self.state, self.kept, self.words,
                                   self.block, self.klartext, self.output)  # fmt: skip
