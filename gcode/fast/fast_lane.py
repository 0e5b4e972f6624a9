"""Fast lane: hands stretches of plain motion to the compiled reader, and takes over after it."""

from __future__ import annotations

import numpy as np

from gcode.fast.plain_kernel import plain_stretch
from gcode.state.controller import Controller
from gcode.state.record import Path

__all__ = ["FastLane"]

#: Stretches shorter than this are not worth the way to the compiled reader, lines.
_SHORT = 8
#: lines at most that go to the interpreter before the compiled reader is tried again
_LONGEST_PAUSE = 256
#: Bytes from which the number of lines is estimated.
_SAMPLE = 1 << 16


class FastLane:
    """Compiled reading of one program.

    Parameters
    ----------
    controller : Controller
        State to read and to bring forward.
    data : bytes
        The program.
    """

    def __init__(self, controller: Controller, data: bytes) -> None:
        self.controller = controller
        whole_lines = data.rfind(b"\n") + 1
        self.data = np.frombuffer(data, np.uint8)[:whole_lines]
        sample = data[:_SAMPLE]
        self.capacity = len(data) * (sample.count(b"\n") + 1) // max(len(sample), 1) * 9 // 8 + 64
        self.rows: tuple[np.ndarray, ...] = ()
        self.free = 0
        self.pause = self.longer = 0  # lines to leave to the interpreter, now and next time

    def run(self, place: tuple[int, int]) -> tuple[int, int]:
        """Obey as many lines as possible.

        Parameters
        ----------
        place : tuple of int
            0-based line and byte offset of its first byte.

        Returns
        -------
        tuple of int
            Place of the first line that was not obeyed.
        """
        if self.pause:
            self.pause -= 1
            return place
        c = self.controller
        if c.side or c.feed_mode != "minute" or c.diameter_mode or c.refresh:
            return place
        if c.record.feed_mm_per_min != c.feed * c.unit_mm:  # told in another unit
            return place
        if self.free >= (len(self.rows[0]) if self.rows else 0):
            self._allocate()
        state = np.array([*c.position[:3], {"G0": 0.0, "G1": 1.0}.get(c.motion, -1.0), c.feed,
                          c.unit_mm, float(c.absolute)])  # fmt: skip
        offset, line, row = plain_stretch(self.data, place[1], state, self.rows, self.free,
                                          place[0])  # fmt: skip
        self._adjust_pause(line - place[0])
        if line != place[0]:
            self._bring_forward(state, line, row)
        return int(line), int(offset)

    def _allocate(self) -> None:
        count = self.capacity
        self.rows = (np.empty(count, np.int8), np.empty(count, np.int32), np.empty((count, 3)),
                     np.empty(count))  # fmt: skip
        self.free = 0

    def _adjust_pause(self, lines: int) -> None:
        if lines < _SHORT:
            self.longer = min(2 * self.longer + 1, _LONGEST_PAUSE)
            self.pause = self.longer
        else:
            self.longer = 0

    def _bring_forward(self, state: np.ndarray, line: int, row: int) -> None:
        """Put the stretch into the record and its end into the controller."""
        c, first = self.controller, self.free
        x, y, z, motion, feed = state[:5].tolist()
        c.feed, c.record.feed_mm_per_min = feed, feed * c.unit_mm
        c.line = c.record.line = int(line)
        if row == first:
            return
        calls, lines, points, feeds = (array[first:row] for array in self.rows)
        rotary = np.broadcast_to(np.array(c.position[3:]), (row - first, 3))
        c.record.stretch(Path(calls, lines, points, rotary, feeds))
        c.position = [x, y, z, *c.position[3:]]
        c.record.last_straight = tuple(c.position)
        c.motion = "G1" if motion == 1.0 else "G0"
        c.cycle.initial = None
        c.straight_only = False
        self.free = row
