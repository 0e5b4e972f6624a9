"""Corrected positions back into the words of the program, everything else byte for byte."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from vmach.program_text.block_state import BlockState
from vmach.program_text.blocks.move_writer import Goal, MoveWriter
from vmach.program_text.blocks.pieces import Piece
from vmach.program_text.plain_program import PlainProgram

__all__ = ["Rewriter", "Target", "Written"]


@dataclass(frozen=True)
class Target:
    """Pieces and the corrections at their ends and middles, (K, 3) mm, machine axes."""

    pieces: list[Piece]
    ends_mm: np.ndarray
    middles_mm: np.ndarray


@dataclass(frozen=True)
class Written:
    """A program's new text and where its pieces stand.

    Attributes
    ----------
    text : bytes
    line_of_piece : list of int
        1-based line of the new text; 0 for a piece that rounding has swallowed.
    inserted_after : list of int
        For every new block the line of the original program that it stands behind.
    swallowed : int
        Corrections too small to change a word.
    """

    text: bytes
    line_of_piece: list[int]
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

    def write(self, target: Target, resolution_mm: float) -> Written:
        """New text with the corrections of `target` at the given resolution."""
        goals, changes = self._goals(target), {}
        pieces_of_move = defaultdict(list)
        for index, piece in enumerate(target.pieces):
            pieces_of_move[piece.move].append(index)
        line_of_piece, inserted_after, swallowed = [0] * len(goals), [], 0
        state, labels = BlockState(), self.text.free_labels()
        for move in self.moving:
            line, pieces = int(self.moves.line[move]), pieces_of_move.get(move)
            for step, angle in self.zeros_before(move):
                state = state.after_zero(step, angle)
            if pieces is None:
                state = self._after_user_line(line, state)
                continue
            writer = MoveWriter(self, move, state, resolution_mm)
            written = writer.write([goals[index] for index in pieces], labels)
            for index, extra in zip(pieces, written.extra_blocks, strict=True):
                if extra is not None:
                    inserted_after += [line] * extra
                    line_of_piece[index] = line + len(inserted_after)
            changes |= written.changes
            swallowed += written.swallowed
            state = written.state
        text = self.text.finish(self.program.source.rewritten(changes))
        return Written(text, line_of_piece, inserted_after, swallowed)

    def _goals(self, target: Target) -> list[Goal]:
        """Where every piece shall lead."""
        move = np.array([piece.move for piece in target.pieces], np.int64)
        spans = np.array([(piece.start, piece.end) for piece in target.pieces]).reshape(-1, 2)
        ends = self.places(move, spans[:, 1], target.ends_mm)
        middles = self.places(move, 0.5 * (spans[:, 0] + spans[:, 1]), target.middles_mm)
        return [Goal(*goal) for goal in zip(target.pieces, ends, middles, strict=True)]

    def _after_user_line(self, line: int, state: BlockState) -> BlockState:
        named = {word.letter for word in self.text.words(line)} & set("XYZ")
        says_motion = self.text.motion_word(line) is not None
        return state.after_user_line(named, says_motion=says_motion)
