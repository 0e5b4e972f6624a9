"""The pieces of one move in words: one block each, the first of them the user's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gcode import SAME, UNKNOWN, BlockMotion, Labels, Word
from vmach.program_text.block_state import BlockState
from vmach.program_text.blocks.block_modes import PLANE_AXES
from vmach.program_text.blocks.pieces import Piece
from vmach.program_text.blocks.written_arc import LINE, RADIUS, fit_arc
from vmach.program_text.expanding.expanded_text import number_text
from vmach.program_text.frame_shift import turned_about_z
from vmach.program_text.plain_program import PlainProgram

__all__ = ["Goal", "MoveWriter", "WrittenMove"]

#: corrections that change no word count as swallowed above this, program units
_NOTHING = 1e-9


@dataclass(frozen=True)
class Goal:
    """A piece, and where its end and its middle shall be, (3,) mm, program coordinates."""

    piece: Piece
    end_mm: np.ndarray
    middle_mm: np.ndarray


@dataclass(frozen=True)
class WrittenMove:
    """What became of a move.

    Attributes
    ----------
    changes : dict of (int, int) to str
        Replacements for `gcode.Source.rewritten`.
    extra_blocks : list of int or None
        Blocks that every piece takes beyond the line's own; none where rounding has swallowed
        the piece.
    swallowed : int
        Corrections too small to change a word.
    state : BlockState
        For the next line.
    """

    changes: dict[tuple[int, int], str]
    extra_blocks: list[int | None]
    swallowed: int
    state: BlockState


@dataclass(frozen=True)
class _Place:
    """Where the words have led so far, and where they should have; (3,) mm, as in `Goal`."""

    written: np.ndarray
    aimed: np.ndarray


class MoveWriter:
    """Writes one move into its line and into blocks behind it.

    Parameters
    ----------
    plain : PlainProgram
    move : int
    state : BlockState
        Before the line.
    resolution_mm : float
    """

    def __init__(
        self, plain: PlainProgram, move: int, state: BlockState, resolution_mm: float
    ) -> None:
        line = int(plain.moves.line[move])
        self.plain, self.move, self.state = plain, move, state
        self.angle, self.end_mm = plain.angle[move], plain.end_mm[move]
        self.mode, self.programmed = plain.modes[line], plain.programmed[move]
        self.is_users = line not in plain.own
        self.unit = self.mode.unit_mm
        self.decimals = plain.control.decimals(resolution_mm, self.unit)
        self.step = 10.0**-self.decimals  # in program units
        self.zero = turned_about_z(state.frame.total_mm(self.angle), -self.angle)
        self.edit = plain.program.language.edit(
            plain.text, line, nominal=int(plain.code[move]), ending=plain.control.ending
        )

    def write(self, goals: Sequence[Goal], labels: Labels | None) -> WrittenMove:
        """Write the pieces of the move, one behind the other; `labels` number the new blocks."""
        place, motions, extra_blocks, swallowed = self._begin(), [], [], 0
        for goal in goals:
            own = {} if motions else self.edit.own
            motion, place, too_small = self._written(goal, place, own)
            swallowed += too_small
            if motions and motion.numbers == {}:  # nothing to say, and no block that says it
                extra_blocks.append(None)
            else:
                extra_blocks.append(self.edit.extra_blocks(motion, is_own=not motions))
                motions.append(motion)
        changes = self.edit.changes(motions, self.state.motion, labels)
        return WrittenMove(changes, extra_blocks, swallowed, self._left(place, motions[-1].code))

    def _begin(self) -> _Place:
        start_mm, state = self.plain.start_mm[self.move], self.state
        written = start_mm + turned_about_z(state.carried_mm, -self.angle)
        aimed = start_mm + turned_about_z(state.aimed_mm, -self.angle)
        if self.move == self.plain.first_move:  # which is taken to start where it ends
            words = [self.edit.own.get(axis) for axis in "XYZ"]
            way = [self.unit * w.value if w and self._counts_on(w) else 0.0 for w in words]
            written = self.end_mm - np.array(way)
        return _Place(written, aimed)

    def _left(self, place: _Place, code: int) -> BlockState:
        """What the next line finds."""
        return replace(
            self.state,
            carried_mm=turned_about_z(place.written - self.end_mm, self.angle),
            aimed_mm=turned_about_z(place.aimed - self.end_mm, self.angle),
            motion=UNKNOWN if self.edit.may_be_skipped else code,
        )

    def _written(
        self, goal: Goal, place: _Place, own: Mapping[str, Word]
    ) -> tuple[BlockMotion, _Place, int]:
        """The motion of a piece in a block of these words, where it leads, and what is swallowed.

        It has no numbers where rounding leaves nothing to do.
        """
        named = np.array([axis in own for axis in "XYZ"])
        code = self._code(goal.piece)
        if goal.piece.kept:  # its words lead to their nominal places
            stays = np.where(named | self.mode.incremental, self.end_mm, place.written)
            return BlockMotion(code, None), _Place(stays, stays), 0
        numbers, reached, swallowed = self._axes(goal.end_mm, place.written, own)
        if code > 1:
            code, centre = self._arc(goal, place, reached, own)
            numbers |= centre
        if self.mode.inverse_time and code and (numbers or own is self.edit.own):
            length_mm = float(np.linalg.norm(reached - place.written))
            numbers["F"] = number_text("F", self._inverse_feed(goal.piece, length_mm))
        aimed = np.where(self.programmed | named, goal.end_mm, place.written)
        return BlockMotion(code, numbers), _Place(reached, aimed), swallowed

    def _code(self, piece: Piece) -> int:
        nominal = int(self.plain.code[self.move])
        return nominal if nominal < 2 or piece.is_arc or piece.kept else 1

    def _counts_on(self, word: Word | None) -> bool:
        """Whether a word says how far to go from the place before."""
        said = word is not None and self.plain.text.is_incremental(word)
        return self.mode.incremental or said

    def _axes(
        self, wanted: np.ndarray, before: np.ndarray, own: Mapping[str, Word]
    ) -> tuple[dict[str, str], np.ndarray, int]:
        """Numbers of X Y Z that lead to a point, where they really lead, and what is swallowed."""
        numbers: dict[str, str] = {}
        reached, swallowed = before.copy(), 0
        for axis, letter in enumerate("XYZ"):
            word = own.get(letter)
            base = before[axis] if self._counts_on(word) else self.zero[axis]
            value = (wanted[axis] - base) / self.unit
            old = word.value if word else (before[axis] - base) / self.unit
            if word is None and not self.programmed[axis]:
                continue
            if abs(value - old) < 0.5 * self.step and (self.is_users or not word):
                swallowed += int(abs(value - old) > _NOTHING)
                new = old
                if word:
                    numbers[letter] = SAME
            else:
                numbers[letter] = self._number(value, word)
                new = float(numbers[letter])
            reached[axis] = base + new * self.unit
        return numbers, reached, swallowed

    def _number(self, value: float, like: Word | None) -> str:
        habit = self.edit.number_of(like) if self.is_users else None
        return self.plain.text.number(value, self.decimals, habit)

    def _arc(
        self, goal: Goal, place: _Place, reached: np.ndarray, own: Mapping[str, Word]
    ) -> tuple[int, dict[str, str]]:
        """G code and numbers of an arc through three points; G1 where a line is nearer."""
        side = list(PLANE_AXES[self.mode.plane][:2])
        points = (place.aimed, goal.middle_mm, goal.end_mm, place.written, reached)
        arc = np.array([point[side] / self.unit for point in points])
        absolute = self.mode.absolute_centre or self.plain.text.absolute_centres
        origin = self.zero[side] / self.unit if absolute else arc[3]
        tolerance = np.array(self.plain.control.arcs.limits(self.unit))
        how, turns, *values = fit_arc(arc, origin, self.step, tolerance, self.edit.has_radius)
        if how == LINE:
            return 1, {}
        letters = ["R"] if how == RADIUS else ["IJK"[axis] for axis in side]
        numbers = {letter: self._number(value, own.get(letter))
                   for letter, value in zip(letters, values, strict=False)}  # fmt: skip
        return 3 if turns else 2, numbers

    def _inverse_feed(self, piece: Piece, chord_mm: float) -> float:
        """F of a piece under G93: the program's feed over the length of the piece."""
        length_mm = (piece.end - piece.start) * self.plain.length_mm[self.move]
        length_mm = max(length_mm, chord_mm, self.step * self.unit)
        return float(self.plain.moves.feed_mm_per_min[self.move]) / length_mm
