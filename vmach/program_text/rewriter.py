"""Corrected positions back into the words of the program, everything else byte for byte."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

import numpy as np

from gcode import MoveKind, Program, Word
from vmach.path_geometry import move_length_mm, position_at
from vmach.program_text.block_modes import PLANE_AXES, BlockModes
from vmach.program_text.control import CONTROLS, TargetControl
from vmach.program_text.dialect_text import block_text, line_edit
from vmach.program_text.expanded_text import number_text
from vmach.program_text.frame_shift import (
    FrameShift,
    rotation_of_moves,
    turned_about_z,
    zero_settings,
)
from vmach.program_text.line_edit import AS_PROGRAMMED, SAME, UNKNOWN
from vmach.program_text.pieces import Piece
from vmach.program_text.said_axes import said_axes
from vmach.program_text.written_arc import WantedArc, best_centre, best_radius, chord_miss

__all__ = ["Rewriter", "Target", "Written"]

#: corrections that change no word count as swallowed above this, program units
_NOTHING = 1e-9


@dataclass(frozen=True)
class Target:
    """Pieces and the corrections at their ends and middles, (K, 3) mm, machine axes."""

    pieces: list[Piece]
    ends_mm: np.ndarray
    middles_mm: np.ndarray


@dataclass
class Written:
    """A program's new text and where its pieces stand.

    Attributes
    ----------
    text : bytes
    line_of_piece : list of int
        1-based line of the new text; 0 for a piece that rounding has swallowed.
    inserted, swallowed : int
        Blocks that are new; corrections too small to change a word.
    inserted_after : list of int
        For every new block the line of the original program that it stands behind.
    """

    text: bytes = b""
    line_of_piece: list[int] = field(default_factory=list)
    inserted: int = 0
    swallowed: int = 0
    inserted_after: list[int] = field(default_factory=list)

    def original_line(self, line: int | None) -> int | None:
        """Line of the original program that a line of the text comes from."""
        if line is None:
            return None
        for source in self.inserted_after:
            if source < line:
                line = max(source, line - 1)
        return line


class Rewriter:
    """Writes targets into one program.

    Parameters
    ----------
    program : Program
        In plain blocks.
    modes : mapping of line to BlockModes
    own : frozenset of int
        Lines whose numbers are not the user's and get the target's decimals.
    control : TargetControl

    Attributes
    ----------
    said : (N, 3) bool
        Axes that every move may correct, see `said_axes`.
    unknown_start : (N,) bool
        Moves that begin where the program does not say.
    code : list of int
        G code of every move.
    rewritten : (N,) bool
        Moves whose blocks are written anew though nothing is corrected: their numbers are not
        the user's, count from a zero that a corrected tool has set, or from a centre that
        another block has changed.
    """

    def __init__(
        self, program: Program, modes: dict[int, BlockModes], own: frozenset[int] = frozenset(),
        control: TargetControl = CONTROLS["linuxcnc"],
    ) -> None:  # fmt: skip
        self.program, self.modes, self.moves, self.own = program, modes, program.moves, own
        self.control, self.text = control, block_text(program)
        count = len(self.moves)
        self.angle = rotation_of_moves(program)
        self.said, self.unknown_start = said_axes(program, modes, self.text)
        self.zero_settings = zero_settings(program)
        self.end_mm = program.record.path().point_mm
        rows = np.arange(count)
        self.start_mm = self.places(rows, np.zeros(count))
        self.length_mm = move_length_mm(self.moves)
        turning = np.where(self.moves.sweep_rad > 0, 3, 2)
        straight = np.where(self.moves.kind == MoveKind.RAPID, 0, 1)
        self.code = np.where(self.moves.kind == MoveKind.ARC, turning, straight).tolist()
        moving = np.flatnonzero(self.moves.kind != MoveKind.DWELL)
        lines = self.moves.line.tolist()
        self.rewritten = np.array([line in own for line in lines], bool) | bool(self.zero_settings)
        if self.text.absolute_centres:
            self.rewritten |= self.moves.kind == MoveKind.ARC
        self.first_move = int(moving[0]) if len(moving) and program.home_mm is None else -1

    def write(self, target: Target, resolution_mm: float) -> Written:
        """New text with the corrections of `target` at the given resolution."""
        written = Written(line_of_piece=[0] * len(target.pieces))
        edits: dict[tuple[int, int], str] = {}
        of_move: dict[int, list[int]] = {}
        for index, piece in enumerate(target.pieces):
            of_move.setdefault(piece.move, []).append(index)
        if self.text.labels is not None:
            del self.text.labels  # every text takes its numbers anew
        places = self._places_of(target)
        state, settings = _State(), deque(self.zero_settings)
        for move in np.flatnonzero(self.moves.kind != MoveKind.DWELL).tolist():
            line = int(self.moves.line[move])
            while settings and settings[0][0].line <= line:
                step, angle = settings.popleft()
                state.frame.obey(step, state.carried_mm, angle)
            if move not in of_move:
                self._pass(line, state)
                continue
            writer = _LineWriter(self, line, move, state, resolution_mm)
            for index in of_move[move]:
                writer.piece(target.pieces[index], index, places, written)
            edits.update(writer.edit.edits())
            writer.leave(state)
        written.text = self.text.finish(self.program.source.rewritten(edits))
        return written

    def _places_of(self, target: Target) -> _Places:
        move = np.array([p.move for p in target.pieces], np.int64)
        first, last = np.array([(p.start, p.end) for p in target.pieces]).reshape(-1, 2).T
        return _Places(
            self.places(move, last, target.ends_mm),
            self.places(move, 0.5 * (first + last), target.middles_mm),
        )

    def _pass(self, line: int, state: _State) -> None:
        """A line that stays: named axes are then where the program has them."""
        named = {w.letter for w in self.text.words(line)} & set("XYZ")
        still = [axis not in named for axis in "XYZ"] if named else [False] * 3
        state.carried_mm = np.where(still, state.carried_mm, 0.0)
        state.aimed_mm = np.where(still, state.aimed_mm, 0.0)
        if self.text.motion_word(line) is not None:
            state.motion = AS_PROGRAMMED

    def places(
        self, move: np.ndarray, parameter: np.ndarray, correction_mm: np.ndarray | float = 0.0
    ) -> np.ndarray:
        """Places on nominal moves with corrections, (K, 3), program coordinates in mm."""
        there = position_at(self.moves, move, parameter) + correction_mm - self.moves.end_mm[move]
        return self.end_mm[move] + turned_about_z(there, -self.angle[move])


@dataclass(frozen=True)
class _Places:
    """Wanted ends and middles of the pieces, (K, 3) mm, program coordinates."""

    end: np.ndarray
    middle: np.ndarray


@dataclass
class _State:
    """What one line leaves to the next.

    Attributes
    ----------
    carried_mm, aimed_mm : (3,) float64
        Written and wanted minus nominal place, machine axes.
    motion : int
        G code in force.
    frame : FrameShift
        Zeros that went along with a corrected tool.
    """

    carried_mm: np.ndarray = field(default_factory=lambda: np.zeros(3))
    aimed_mm: np.ndarray = field(default_factory=lambda: np.zeros(3))
    motion: int = AS_PROGRAMMED
    frame: FrameShift = field(default_factory=FrameShift)


class _LineWriter:
    """Writes the pieces of one move into its line and into inserted blocks."""

    def __init__(
        self, rewriter: Rewriter, line: int, move: int, state: _State, resolution_mm: float
    ) -> None:
        self.rewriter, self.move, self.mode = rewriter, move, rewriter.modes[line]
        self.unit = self.mode.unit_mm
        self.decimals = rewriter.control.decimals(resolution_mm, self.unit)
        self.step = 10.0**-self.decimals  # in program units
        self.edit = line_edit(rewriter.text, line, state.motion, nominal=rewriter.code[move],
                              ending=rewriter.control.ending)  # fmt: skip
        self.now = rewriter.start_mm[move] + turned_about_z(state.carried_mm, -rewriter.angle[move])
        self.aim = rewriter.start_mm[move] + turned_about_z(state.aimed_mm, -rewriter.angle[move])
        angle = rewriter.angle[move]
        self.zero = turned_about_z(state.frame.total_mm(angle), -angle)
        if move == rewriter.first_move:  # which is taken to start where it ends
            self.now = rewriter.end_mm[move] - self._distances()
        self.is_own, self.said = line in rewriter.own, rewriter.said[move]

    def _distances(self) -> np.ndarray:
        """What the user's words add to the place before, mm."""
        words = [self.edit.own_word(letter) for letter in "XYZ"]
        return np.array([self.unit * w.value if w and self._counts_on(w) else 0.0 for w in words])

    def _counts_on(self, word: Word | None) -> bool:
        said = word is not None and self.rewriter.text.is_incremental(word)
        return self.mode.incremental or said

    def leave(self, state: _State) -> None:
        """Hand over to the next line."""
        rewriter = self.rewriter
        off = self.now - rewriter.end_mm[self.move]
        state.carried_mm = turned_about_z(off, rewriter.angle[self.move])
        aimed = self.aim - rewriter.end_mm[self.move]
        state.aimed_mm = turned_about_z(aimed, rewriter.angle[self.move])
        state.motion = UNKNOWN if self.edit.may_be_skipped else self.edit.motion

    def piece(self, piece: Piece, index: int, places: _Places, written: Written) -> None:
        """Write one piece, or nothing where rounding leaves nothing to do."""
        line = self.edit.line
        if piece.kept:
            self._keep_place()
            self.aim = self.now.copy()
            self.edit.keep(self._code(piece))
            written.line_of_piece[index] = line + written.inserted
            return
        begin, wanted, before = self.aim, places.end[index], self.now.copy()
        named = [self.edit.own_word(letter) is not None for letter in "XYZ"]
        self.aim = np.where(self.said | named, wanted, self.now)
        texts = self._axis_texts(wanted, written)
        code = self._code(piece)
        if code > 1:
            code = self._arc((begin, places.middle[index], wanted), before, texts)
        if not texts and self.edit.own_done:
            return
        if self.mode.inverse_time and code:
            texts["F"] = number_text("F", self._inverse_feed(piece, before))
        count = self.edit.write(code, texts)
        written.inserted += count
        written.inserted_after += [line] * count
        written.line_of_piece[index] = line + written.inserted

    def _keep_place(self) -> None:
        """The block stays: its words lead to their nominal places."""
        end = self.rewriter.end_mm[self.move]
        named = [self.edit.own_word(letter) is not None for letter in "XYZ"]
        self.now = np.where(named, end, self.now) if not self.mode.incremental else end.copy()

    def _code(self, piece: Piece) -> int:
        nominal = self.rewriter.code[self.move]
        return nominal if nominal < 2 or piece.is_arc or piece.kept else 1

    def _axis_texts(self, wanted: np.ndarray, written: Written) -> dict[str, str]:
        """Words X Y Z that lead to the wanted point; moves `now` to where they really lead."""
        texts: dict[str, str] = {}
        for axis, letter in enumerate("XYZ"):
            word = self.edit.own_word(letter)
            base = self.now[axis] if self._counts_on(word) else self.zero[axis]
            value = (wanted[axis] - base) / self.unit
            old = word.value if word else (self.now[axis] - base) / self.unit
            if word is None and not self.said[axis]:
                continue
            if abs(value - old) < 0.5 * self.step and not (word and self.is_own):
                written.swallowed += int(abs(value - old) > _NOTHING)
                new = old
                if word:
                    texts[letter] = SAME
            else:
                texts[letter] = self._number(value, word)
                new = float(texts[letter])
            self.now[axis] = base + new * self.unit
        return texts

    def _number(self, value: float, like: Word | None) -> str:
        habit = None if self.is_own else self.edit.number_of(like)
        return self.rewriter.text.number(value, self.decimals, habit)

    def _arc(
        self, wanted: tuple[np.ndarray, ...], before: np.ndarray, texts: dict[str, str]
    ) -> int:
        """Add the words of an arc through three points; its G code, 1 where a line is nearer."""
        side = list(PLANE_AXES[self.mode.plane][:2])
        arc = WantedArc(*(p[side] / self.unit for p in (*wanted, before, self.now)))
        absolute = self.mode.absolute_centre or self.rewriter.text.absolute_centres
        origin = self.zero[side] / self.unit if absolute else arc.start
        centre = best_centre(arc, origin, self.step, self._accepts)
        if centre is None or chord_miss(arc) <= centre.miss:
            return 1
        radius = best_radius(arc, self.step) if self.edit.has_radius else None
        if radius is not None and radius.miss <= max(centre.miss, 0.3 * self.step):
            texts["R"] = self._number(radius.value, self.edit.own_word("R"))
        else:
            for axis, value in zip(side, centre.value, strict=True):
                letter = "IJK"[axis]
                texts[letter] = self._number(value, self.edit.own_word(letter))
        return 3 if arc.is_counter_clockwise else 2

    def _accepts(self, first: float, last: float) -> bool:
        return self.rewriter.control.radii_agree(first, last, unit_mm=self.unit)

    def _inverse_feed(self, piece: Piece, before: np.ndarray) -> float:
        """F of a piece under G93: the program's feed over the length of the piece."""
        rewriter, move = self.rewriter, piece.move
        length = (piece.end - piece.start) * rewriter.length_mm[move]
        length = max(length, float(np.linalg.norm(self.now - before)), self.step * self.unit)
        return float(rewriter.moves.feed_mm_per_min[move]) / length
