"""What compiled code needs to know of the moves of a program, as columns."""

from __future__ import annotations

import numpy as np

from gcode import MoveKind
from vmach.program_text.block_state import BlockState
from vmach.program_text.blocks.block_modes import PLANE_AXES
from vmach.program_text.plain_program import PlainProgram
from vmach.program_text.runs.axis_words import RADIUS, AxisWords
from vmach.program_text.runs.plain_run import LONGEST, Run, RunState

__all__ = ["RunColumns", "left_by", "state_for"]


class RunColumns:
    """Columns of a program's moves.

    Parameters
    ----------
    plain : PlainProgram

    Attributes
    ----------
    is_plain : (M,) bool
        Moves whose lines are letters and plain numbers, in absolute positions, and hold all
        words of an arc: their numbers may be written in compiled code.
    """

    def __init__(self, plain: PlainProgram) -> None:
        self.plain = plain
        self.words = plain.axis_words
        if plain.text.own_word_form == "klartext":  # L says G0 and G1, as the feed behind it is
            self.words = self.words._replace(motion=plain.code)
        self.unit_mm = self._mode("unit_mm", 1.0)
        self.code = plain.code
        plane = self._mode("plane", 1)
        self.side = np.array([(0, 0, 0), *PLANE_AXES.values()], np.int8)[plane][:, :2]
        self.absolute_centre = self._mode("absolute_centre", other=False)
        self.absolute_centre |= plain.text.absolute_centres
        self.own = np.isin(plain.moves.line, list(plain.own))
        self.is_plain = self._plain_moves()

    def _mode(self, name: str, other: float | bool) -> np.ndarray:
        return self.plain.modes.column(name, self.plain.moves.line, other)

    def _plain_moves(self) -> np.ndarray:
        plain, language = self.plain, self.plain.program.language
        is_usual = plain.text.own_word_form in vars(language.edit).get("word_forms", ())
        if not is_usual or plain.sets_zeros:
            return np.zeros(len(plain.moves), bool)
        said = self.words.motion
        found = self.words.is_plain & self._has_arc_words() & (plain.angle == 0.0)
        found &= (said < 0) | (said == self.code)
        for name in ("incremental", "inverse_time", "left"):
            found &= ~self._mode(name, other=True)
        found &= plain.moves.kind != MoveKind.DWELL
        if plain.first_move >= 0:
            found[plain.first_move] = False
        return found

    def _has_arc_words(self) -> np.ndarray:
        """Straight moves without words of an arc; arcs with centre or radius alone, (M,) bool."""
        has = self.words.start >= 0
        row = np.arange(len(has))
        in_plane = has[row, 3 + self.side[:, 0]] | has[row, 3 + self.side[:, 1]]
        in_plane &= ~has[row, 6 - self.side.sum(axis=1)]  # and none of the axis across
        centre, radius = has[:, 3:6].sum(axis=1), has[:, RADIUS]
        by_centre = in_plane & ~radius
        by_radius = (centre == 0) & radius
        return np.where(self.code > 1, by_centre | by_radius, (centre == 0) & ~radius)

    def run(
        self, only_piece: np.ndarray, wanted_mm: np.ndarray, middle_mm: np.ndarray,
        resolution_mm: float,
    ) -> Run:  # fmt: skip
        """The moves and what they shall become.

        Parameters
        ----------
        only_piece : (M,) int64
            The piece of every move that has one alone, which is written; else -1.
        wanted_mm, middle_mm : (K, 3) float64
            Where ends and middles of the pieces shall be, program coordinates.
        resolution_mm : float
        """
        plain, words = self.plain, self.words
        units, which = np.unique(self.unit_mm, return_inverse=True)
        decimals = [plain.control.decimals(resolution_mm, unit) for unit in units.tolist()]
        steps = np.array([10.0**-d for d in decimals])
        decimals = np.array(decimals, np.int64)[which]
        arcs = plain.control.arcs
        tolerance = np.array([arcs.limits(unit) for unit in units.tolist()])
        fill, bare, plus = self._habits(words, decimals)
        return Run(np.where(self.is_plain, only_piece, -1), self.code, words.motion, self.unit_mm,
                   decimals, steps[which], plain.programmed, plain.start_mm, plain.end_mm,
                   wanted_mm, middle_mm, self.side, self.absolute_centre, tolerance[which],
                   words.start, words.stop, fill, words.value, bare, plus, words.behind,
                   self.own, self._habits_of_added())  # fmt: skip

    def _habits_of_added(self) -> np.ndarray:
        """Habits of words that lines lack, as `BlockText.word` and `BlockText.number` have them."""
        text, style = self.plain.text, self.plain.text.style
        return np.array([len(style.between), len(style.gap), style.lower,
                         max(style.fill, text.fewest_decimals), style.bare_point,
                         style.plus])  # fmt: skip

    def _habits(
        self, words: AxisWords, decimals: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Decimals, missing zeros and plus signs of new numbers, as `BlockText.number` has them."""
        text, style, own = self.plain.text, self.plain.text.style, self.own[:, None]
        fill = np.where(own, np.int8(style.fill), words.fill)
        most = decimals.astype(np.int8)[:, None]  # as the others are: a long program has many
        fill = np.maximum(np.minimum(fill, most), np.int8(text.fewest_decimals))
        bare = np.where(own, style.bare_point, words.is_bare | (style.bare_point & ~words.has_zero))
        plus = np.where(own, style.plus, words.has_plus | (style.plus & words.has_minus))
        return fill, bare, plus


def state_for(state: BlockState, count: int) -> RunState:
    """The state before a run of moves, with room for so many numbers."""
    return RunState(state.carried_mm.astype(np.float64), state.aimed_mm.astype(np.float64),
                    np.array([state.motion], np.int64), np.zeros(2, np.int64),
                    np.empty(count, np.int64), np.empty(count, np.int64),
                    np.empty((count, LONGEST), np.uint8), np.empty(count, np.int64))  # fmt: skip


def left_by(run: RunState, state: BlockState) -> BlockState:
    """The state behind a run."""
    return BlockState(run.carried_mm.copy(), run.aimed_mm.copy(), int(run.motion[0]), state.frame)
