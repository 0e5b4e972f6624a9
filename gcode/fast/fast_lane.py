"""Fast lane: hands stretches of lines to compiled code, and takes over after it."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from gcode.fast.code_table import CodeTable, code_table
from gcode.fast.lane_output import new_output, put_into
from gcode.fast.lane_state import (
    STATE,
    Frames,
    frames_of,
    give_back,
    give_back_cycle,
    hand_over,
    hand_over_cycle,
    note,
)
from gcode.fast.line_kernel import obey_lines
from gcode.fast.line_words import WORDS
from gcode.fast.plain_lines import OTHER, motion_of_lines
from gcode.state.controller import Controller
from gcode.state.trace import Modes

__all__ = ["FastLane"]

#: Stretches shorter than this are not worth the way to compiled code, lines.
_SHORT = 4
#: lines at most that go to the interpreter before compiled code is tried again
_LONGEST_PAUSE = 256


class FastLane:
    """Compiled reading of one program.

    Parameters
    ----------
    controller : Controller
        State to read and to bring forward.
    data : bytes
        The program.
    """

    is_sequential = False  #: every word is obeyed for itself, as Fanuc's are

    @property
    def each_word(self) -> int | None:
        """The same for the compiler, which leaves out what belongs to None."""
        return 1 if self.is_sequential else None

    def __init__(self, controller: Controller, data: bytes) -> None:
        self.controller, self.text = controller, data
        self.data = np.frombuffer(data, np.uint8)[: data.rfind(b"\n") + 1]
        self.codes, self.output = self.code_table(), new_output()
        self.state, self.kept = np.zeros(1, STATE), np.zeros(1, STATE)
        self.words = np.zeros(1, WORDS)
        self.pause = self.longer = 0  # lines to leave to the interpreter, now and next time

    def code_table(self) -> CodeTable | None:
        """Codes that are obeyed here; None where the language has none."""
        return code_table(is_sequential=self.is_sequential)

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
        trace, data = self.controller.trace, self.data
        if trace is not None:
            data = self.plain_part(place)
            trace.end()
            before = Modes.of(self.controller)
        if not len(data) or not self.hand_over():
            return place
        begun, place = place, self._obey_all(data, place)
        self._adjust_pause(place[0] - begun[0])
        if place != begun:
            self.give_back()
            if trace is not None:
                trace.plain_lines(begun[0] + 1, self.said_by(begun[0], place[0]), before)
        return place

    def _obey_all(self, data: np.ndarray, place: tuple[int, int]) -> tuple[int, int]:
        """Obey lines, and write them down whenever there is no more room; the place behind them."""
        frames, is_full = self.frames(), True
        while is_full:
            offset, line = self.obey(data, place, frames)
            is_full = bool(self.state[0]["is_full"]) and line != place[0]
            place = line, offset
            self.write()
        return place

    def frames(self) -> Frames | None:
        """Stored offsets that the lines may ask for."""
        return frames_of(self.controller)

    def obey(
        self, data: np.ndarray, place: tuple[int, int], frames: Frames | None
    ) -> tuple[int, int]:
        """Obey lines until there is no more room; gives offset and 0-based line behind them."""
        return obey_lines(data, place[1], place[0], self.state, self.kept, self.words, self.codes,
                          frames, self.output, self.each_word)  # fmt: skip

    @cached_property
    def _starts(self) -> np.ndarray:
        """Offset of every line's first byte and of the end, (L + 1,) int64."""
        return np.concatenate(([0], np.flatnonzero(self.data == ord("\n")) + 1))

    @cached_property
    def _said(self) -> np.ndarray:
        """What every line says, (L,) int8, see `motion_of_lines`."""
        said = np.empty(len(self._starts) - 1, np.int8)
        motion_of_lines(self.data, self._starts, said)
        return said

    def said_by(self, first: int, stop: int) -> np.ndarray:
        """G code that each of these lines says, 0-based, negative for none, (L,)."""
        return self._said[first:stop]

    @cached_property
    def _others(self) -> np.ndarray:
        """Lines that are not plain motion, 0-based, in order; behind them the number of lines."""
        return np.append(np.flatnonzero(self._said == OTHER), len(self._said))

    def plain_part(self, place: tuple[int, int]) -> np.ndarray:
        """The program up to the end of the lines of plain motion from a place on."""
        line = place[0]
        end = int(self._others[np.searchsorted(self._others, line)]) if line < len(
            self._said) else line  # fmt: skip
        is_moving = self.controller.motion in ("G0", "G1", "G2", "G3")
        if end - line < _SHORT or (not is_moving and self._said[line] < 0):
            return self.data[:0]
        return self.data[: self._starts[end]]

    def hand_over(self) -> bool:
        """Put the interpreter's state into the record; False where its modes forbid it."""
        hand_over_cycle(self.controller.cycle, self.state)
        return hand_over(self.controller, self.state)

    def give_back(self) -> None:
        """Take the state over from the record."""
        give_back_cycle(self.controller.cycle, self.state)
        give_back(self.controller, self.state)

    def write(self) -> None:
        """Put what has been obeyed into the record."""
        c, count = self.controller, int(self.state[0]["notes"])
        put_into(c.record, self.output, self.state, self.text)
        for line, tenths in self.output.notes[:count].tolist():
            note(c, line, tenths)

    def _adjust_pause(self, lines: int) -> None:
        if lines < _SHORT:
            self.longer = min(2 * self.longer + 1, _LONGEST_PAUSE)
            self.pause = self.longer
        else:
            self.longer = 0
