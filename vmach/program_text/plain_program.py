"""A program in plain blocks: its moves, and what its text says about each."""

from __future__ import annotations

from collections import deque

import numpy as np

from gcode import Dialect, MoveKind, Program, Step
from vmach.path.geometry import move_length_mm, position_at
from vmach.program_text.blocks.line_modes import LineModes
from vmach.program_text.frame_shift import rotation_of_moves, turned_about_z, zero_settings
from vmach.program_text.programmed_axes import programmed_axes
from vmach.program_text.runs.axis_words import axis_words

__all__ = ["PlainProgram"]


class PlainProgram:
    """A program that a control shall read with other ends.

    Parameters
    ----------
    program : Program
        In plain blocks.
    modes : LineModes
    own : frozenset of int
        Lines whose numbers are not the user's and get the target's decimals.
    control : type of Dialect

    Attributes
    ----------
    axis_words : AxisWords
        Words X Y Z of the lines of the moves, as far as they are plain.
    programmed : (N, 3) bool
        Axes that every move may correct, see `programmed_axes`.
    unknown_start : (N,) bool
        Moves that begin where the program does not say.
    code : (N,) int64
        G code of every move.
    rewritten : (N,) bool
        Moves whose blocks are written anew though nothing is corrected: their numbers are not
        the user's, count from a zero that a corrected tool has set, or from a centre that
        another block has changed.
    end_mm, start_mm : (N, 3) float64
        Nominal places in program coordinates.
    angle : (N,) float64
        By which the program is turned about Z, rad.
    moving : (K,) int64
        Moves but for dwells.
    sets_zeros : bool
        Lines set zeros where the tool stands, see `zero_settings`.
    first_move : int
        The one that is taken to start where it ends; -1 where the program says its start.
    """

    def __init__(
        self, program: Program, modes: LineModes, own: frozenset[int] = frozenset(),
        control: type[Dialect] = Dialect,
    ) -> None:  # fmt: skip
        self.program, self.modes, self.moves, self.own = program, modes, program.moves, own
        self.control, self.text = control, program.language.text(program.source)
        self.angle = rotation_of_moves(program)
        source, form = program.source, self.text.own_word_form
        self.axis_words = axis_words(source.data, source.line_starts, self.moves.line, form)
        self.programmed, self.unknown_start = programmed_axes(program, modes, self.text,
                                                              self.axis_words)  # fmt: skip
        self.end_mm = program.record.path().point_mm
        count, kind = len(self.moves), self.moves.kind
        self.start_mm = self.places(np.arange(count), np.zeros(count))
        self.length_mm = move_length_mm(self.moves)
        turning = np.where(self.moves.sweep_rad > 0, 3, 2)
        straight = np.where(kind == MoveKind.RAPID, 0, 1)
        self.code = np.where(kind == MoveKind.ARC, turning, straight)
        self.moving = np.flatnonzero(kind != MoveKind.DWELL)
        starts_anywhere = len(self.moving) > 0 and program.home_mm is None
        self.first_move = int(self.moving[0]) if starts_anywhere else -1
        settings, lines = zero_settings(program), self.moves.line.tolist()
        self.sets_zeros = bool(settings)
        self._settings = _by_move_behind(settings, self.moving, lines)
        self.rewritten = np.isin(self.moves.line, list(own)) | bool(settings)
        if self.text.absolute_centres:
            self.rewritten |= kind == MoveKind.ARC
        self.program = program.without_record()  # of a long one it is not needed any more

    def places(
        self, move: np.ndarray, parameter: np.ndarray, correction_mm: np.ndarray | float = 0.0
    ) -> np.ndarray:
        """Places on nominal moves with corrections, (K, 3), program coordinates in mm."""
        there = position_at(self.moves, move, parameter) + correction_mm - self.moves.end_mm[move]
        return self.end_mm[move] + turned_about_z(there, -self.angle[move])

    def zeros_before(self, move: int) -> list[tuple[Step, float]]:
        """Lines since the last move that set or choose a zero, see `zero_settings`."""
        return self._settings.get(move, [])


def _by_move_behind(
    settings: list[tuple[Step, float]], moving: np.ndarray, lines: list[int]
) -> dict[int, list[tuple[Step, float]]]:
    """Sort zero settings by the move that comes next."""
    found: dict[int, list[tuple[Step, float]]] = {}
    waiting = deque(settings)
    for move in moving.tolist() if waiting else ():
        while waiting and waiting[0][0].line <= lines[move]:
            found.setdefault(move, []).append(waiting.popleft())
    return found
