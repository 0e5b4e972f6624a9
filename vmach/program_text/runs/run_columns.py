"""What compiled code needs to know of the moves of a program, as columns."""

from __future__ import annotations

import numpy as np

from gcode import BlockText, LineEdit, MoveKind
from vmach.program_text.block_state import BlockState
from vmach.program_text.plain_program import PlainProgram
from vmach.program_text.runs.axis_words import AxisWords
from vmach.program_text.runs.plain_run import LONGEST, Run, RunState

__all__ = ["RunColumns", "left_by", "state_for"]

_AXES = 3


class RunColumns:
    """Columns of a program's moves.

    Parameters
    ----------
    plain : PlainProgram

    Attributes
    ----------
    is_plain : (M,) bool
        Straight moves whose lines are letters and plain numbers, in absolute positions: their
        numbers may be written in compiled code.
    """

    def __init__(self, plain: PlainProgram) -> None:
        self.plain = plain
        self.words = plain.axis_words
        lines, self.which = np.unique(plain.moves.line, return_inverse=True)
        self.modes = [plain.modes.get(line) for line in lines.tolist()]
        self.unit_mm = self._of_lines([m.unit_mm if m else 1.0 for m in self.modes])
        self.code = np.array(plain.code, np.int64)
        self.is_plain = self._plain_moves(lines)

    def _of_lines(self, values: list) -> np.ndarray:
        return np.array(values)[self.which]

    def _plain_moves(self, lines: np.ndarray) -> np.ndarray:
        plain, language = self.plain, self.plain.program.language
        if type(plain.text) is not BlockText or language.edit is not LineEdit or plain.sets_zeros:
            return np.zeros(len(plain.moves), bool)
        users = [line not in plain.own for line in lines.tolist()]
        absolute = [m is not None and not (m.incremental or m.inverse_time or m.left)
                    for m in self.modes]  # fmt: skip
        said = self.words.motion
        found = self.words.is_plain & (self.code < 2) & (plain.angle == 0.0)
        found &= (said < 0) | (said == self.code)
        found &= self._of_lines(users) & self._of_lines(absolute)
        found &= plain.moves.kind != MoveKind.DWELL
        if plain.first_move >= 0:
            found[plain.first_move] = False
        return found

    def run(self, only_piece: np.ndarray, wanted_mm: np.ndarray, resolution_mm: float) -> Run:
        """The moves and what they shall become.

        Parameters
        ----------
        only_piece : (M,) int64
            The piece of every move that has one alone, which is written; else -1.
        wanted_mm : (K, 3) float64
            Where the pieces shall end, program coordinates.
        resolution_mm : float
        """
        plain, words = self.plain, self.words
        units, which = np.unique(self.unit_mm, return_inverse=True)
        decimals = [plain.control.decimals(resolution_mm, unit) for unit in units.tolist()]
        steps = np.array([10.0**-d for d in decimals])
        decimals = np.array(decimals, np.int64)[which]
        fill, bare, plus = self._habits(words, decimals)
        return Run(np.where(self.is_plain, only_piece, -1), self.code, words.motion, self.unit_mm,
                   decimals, steps[which], plain.programmed, plain.start_mm, plain.end_mm,
                   wanted_mm, words.start, words.stop, words.value, fill, bare, plus)  # fmt: skip

    def _habits(
        self, words: AxisWords, decimals: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Decimals, missing zeros and plus signs of new numbers, as `BlockText.number` has them."""
        text, style = self.plain.text, self.plain.text.style
        fill = np.maximum(np.minimum(words.fill, decimals[:, None]), text.fewest_decimals)
        bare = words.is_bare | (style.bare_point & ~words.has_zero)
        return fill, bare, words.has_plus | (style.plus & words.has_minus)


def state_for(state: BlockState, room: int) -> RunState:
    """The state before a run of moves, with room for the numbers of so many of them."""
    count = _AXES * room
    return RunState(state.carried_mm.astype(np.float64), state.aimed_mm.astype(np.float64),
                    np.array([state.motion], np.int64), np.zeros(2, np.int64),
                    np.empty(count, np.int64), np.empty(count, np.int64),
                    np.empty((count, LONGEST), np.uint8), np.empty(count, np.int64))  # fmt: skip


def left_by(run: RunState, state: BlockState) -> BlockState:
    """The state behind a run."""
    return BlockState(run.carried_mm.copy(), run.aimed_mm.copy(), int(run.motion[0]), state.frame)
