"""Corrected positions back into the words of the program, everything else byte for byte."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gcode import AS_PROGRAMMED
from vmach.program_text.block_state import BlockState
from vmach.program_text.blocks.move_writer import Goal, MoveWriter
from vmach.program_text.blocks.pieces import Pieces
from vmach.program_text.plain_program import PlainProgram
from vmach.program_text.runs.plain_run import write_run
from vmach.program_text.runs.run_columns import RunColumns, left_by, state_for
from vmach.program_text.runs.splicing import Edits, spliced

__all__ = ["Rewriter", "Target", "Written"]


@dataclass(frozen=True)
class Target:
    """Pieces and the corrections at their ends and middles, (K, 3) mm, machine axes."""

    pieces: Pieces
    ends_mm: np.ndarray
    middles_mm: np.ndarray


@dataclass(frozen=True)
class Written:
    """A program's new text and where its pieces stand.

    Attributes
    ----------
    text : bytes
    line_of_piece : (K,) int64
        1-based line of the new text; 0 for a piece that rounding has swallowed.
    inserted_after : list of int
        For every new block the line of the original program that it stands behind.
    swallowed : int
        Corrections too small to change a word.
    """

    text: bytes
    line_of_piece: np.ndarray
    inserted_after: list[int]
    swallowed: int

    @property
    def inserted(self) -> int:
        """Blocks that are new."""
        return len(self.inserted_after)

    def original_line(self, line: int | None) -> int | None:
        """Line of the original program that a line of the text comes from."""
        if line is None:
            return None
        for source in self.inserted_after:
            if source < line:
                line = max(source, line - 1)
        return line


class Rewriter(PlainProgram):
    """A program that targets are written into."""

    @cached_property
    def _columns(self) -> RunColumns:
        return RunColumns(self)

    def write(self, target: Target, resolution_mm: float) -> Written:
        """New text with the corrections of `target` at the given resolution."""
        writing = _Writing(self, target, resolution_mm)
        index = 0
        while index < len(self.moving):
            index = writing.plain_moves(index)
            if index < len(self.moving):
                writing.move(int(self.moving[index]))
                index += 1
        return writing.written()

    def _after_user_line(self, line: int, state: BlockState) -> BlockState:
        named = {word.letter for word in self.text.words(line)} & set("XYZ")
        says_motion = self.text.motion_word(line) is not None
        return state.after_user_line(named, says_motion=says_motion)


class _Writing:
    """One writing of a program: plain moves in compiled code, the others one by one."""

    def __init__(self, plain: Rewriter, target: Target, resolution_mm: float) -> None:
        self.plain, self.pieces, self.resolution_mm = plain, target.pieces, resolution_mm
        pieces, move = target.pieces, target.pieces.move
        self.ends_mm = plain.places(move, pieces.end, target.ends_mm)
        self.middles_mm = plain.places(move, 0.5 * (pieces.start + pieces.end), target.middles_mm)
        moving = plain.moving
        self.first = np.searchsorted(move, np.arange(len(plain.moves) + 1))
        self.moving = moving
        self.run = plain._columns.run(self._only_pieces(), self.ends_mm, self.middles_mm,
                                      resolution_mm)  # fmt: skip
        arcs = int((plain.code[moving] > 1).sum())
        self.run_state = state_for(BlockState(), 3 * len(moving) + 2 * arcs)
        self.state, self.labels = BlockState(), plain.text.free_labels()
        self.changes: dict[tuple[int, int], str] = {}
        self.line_of_piece = np.zeros(len(move), np.int64)
        self.inserted_after: list[int] = []

    def _only_pieces(self) -> np.ndarray:
        """The piece of every move that has one alone, an arc where the move is one; else -1."""
        first, count, pieces = self.first[:-1], np.diff(self.first), self.pieces
        turns = self.plain.code[pieces.move] > 1
        usual = np.append(~(pieces.kept | pieces.is_step) & (pieces.is_arc == turns), False)
        return np.where((count == 1) & usual[first], first, -1)

    def plain_moves(self, index: int) -> int:
        """Write plain moves from one on; gives the index of the first that needs more."""
        if self.run.piece[self.moving[index]] < 0:
            return index
        run, begun = self.run_state, index
        run.carried_mm[:], run.aimed_mm[:] = self.state.carried_mm, self.state.aimed_mm
        run.motion[0] = self.state.motion
        index = write_run(self.run, run, self.moving, index, AS_PROGRAMMED)
        if index > begun:
            moves = self.moving[begun:index]
            self.state = left_by(run, self.state)
            lines = self.plain.moves.line[moves] + len(self.inserted_after)
            self.line_of_piece[self.run.piece[moves]] = lines
        return index

    def move(self, move: int) -> None:
        """Write one move, whatever it needs."""
        plain, line = self.plain, int(self.plain.moves.line[move])
        pieces = range(self.first[move], self.first[move + 1])
        for step, angle in plain.zeros_before(move):
            self.state = self.state.after_zero(step, angle)
        if not pieces:
            self.state = plain._after_user_line(line, self.state)
            return
        own = slice(pieces.start, pieces.stop)
        goals = [*map(Goal, self.pieces.taken(own), self.ends_mm[own], self.middles_mm[own])]
        writer = MoveWriter(plain, move, self.state, self.resolution_mm)
        found = writer.write(goals, self.labels)
        for index, extra in zip(pieces, found.extra_blocks, strict=True):
            if extra is not None:
                self.inserted_after += [line] * extra
                self.line_of_piece[index] = line + len(self.inserted_after)
        self.changes |= found.changes
        self.run_state.count[1] += found.swallowed
        self.state = found.state

    def written(self) -> Written:
        """The text."""
        run, count = self.run_state, int(self.run_state.count[0])
        edits = Edits(run.start[:count], run.stop[:count], run.text[:count], run.length[:count])
        data = spliced(self.plain.program.source.data, edits, self.changes)
        return Written(self.plain.text.finish(data), self.line_of_piece,
                       self.inserted_after, int(run.count[1]))  # fmt: skip
