"""Corrected positions back into the words of the program, everything else byte for byte."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

import numpy as np

from gcode import MoveKind, Program, Word
from vmach.compensation.block_modes import BlockModes
from vmach.compensation.pieces import Piece, circle_through
from vmach.path_geometry import position_at

__all__ = ["Rewriter", "Target", "Written"]

_MOTION = {0, 10, 20, 30}


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


@dataclass
class _Block:
    """One block that is being written: its words, and the words it replaces."""

    words: dict[str, Word]
    changed: dict[str, str | None] = field(default_factory=dict)

    def put(self, letter: str, number: str | None) -> None:
        self.changed[letter] = number


class Rewriter:
    """Writes targets into one program.

    Parameters
    ----------
    program : Program
    modes : mapping of line to BlockModes
    """

    def __init__(
        self, program: Program, modes: dict[int, BlockModes], own: frozenset[int] = frozenset()
    ) -> None:
        self.program, self.modes, self.moves, self.own = program, modes, program.moves, own
        count = len(self.moves)
        angle = np.zeros(count)
        for row, _, name, *values in program.record.events:
            if name == "set_xy_rotation":
                angle[row:] = np.radians(values[0])
        self.angle = angle
        self.end_mm = program.record.path().point_mm

    def write(self, target: Target, resolution_mm: float) -> Written:
        """New text with the corrections of `target` at the given resolution."""
        written = Written(line_of_piece=[0] * len(target.pieces))
        edits: dict[tuple[int, int], str] = {}
        of_move: dict[int, list[int]] = {}
        for index, piece in enumerate(target.pieces):
            of_move.setdefault(piece.move, []).append(index)
        carried, motion = np.zeros(3), -1
        for move in range(len(self.moves)):
            if self.moves.kind[move] == MoveKind.DWELL:
                continue
            line = int(self.moves.line[move])
            words = {w.letter: w for w in self.program.source.words(line) if w.letter != "G"}
            if move not in of_move:
                still = [a not in words for a in "XYZ"]
                carried = np.where(still if not all(still) else False, carried, 0.0)
                motion = -1
                continue
            state = _Line(self, line, move, carried, motion, resolution_mm)
            for index in of_move[move]:
                state.piece(target, index, written)
            edits.update(state.edits())
            carried, motion = state.carried(), state.motion
        written.text = self.program.source.rewritten(edits)
        return written

    def to_program(self, vector: np.ndarray, move: int) -> np.ndarray:
        """A machine vector in the axes of the program."""
        return _turned(vector, -self.angle[move])

    def position(self, move: int, parameter: float) -> np.ndarray:
        """Nominal place in program coordinates, mm."""
        there = position_at(self.moves, np.array([move]), np.array([parameter]))[0]
        return self.end_mm[move] + self.to_program(there - self.moves.end_mm[move], move)


class _Line:
    """The new text of one line: its own block, then inserted ones."""

    def __init__(
        self, rewriter: Rewriter, line: int, move: int, carried: np.ndarray, motion: int,
        resolution_mm: float,
    ) -> None:  # fmt: skip
        self.rewriter, self.line, self.move, self.motion = rewriter, line, move, motion
        self.mode = rewriter.modes[line]
        source = rewriter.program.source
        self.words = source.words(line)
        self.lower = any(w.text[0] in "xyz" for w in self.words)
        self.decimals = int(np.ceil(-np.log10(resolution_mm) - 1e-9)) + (self.mode.unit_mm != 1.0)
        self.step = 10.0**-self.decimals  # in program units
        self.now = rewriter.position(move, 0.0) + rewriter.to_program(carried, move)
        self.first: dict[tuple[int, int], str] = {}
        self.blocks: list[str] = []
        self.own_done = False
        self.last_target = self.now

    def carried(self) -> np.ndarray:
        """Written minus nominal end, machine axes."""
        off = self.now - self.rewriter.end_mm[self.move]
        return _turned(off, self.rewriter.angle[self.move])

    def piece(self, target: Target, index: int, written: Written) -> None:
        piece = target.pieces[index]
        rewriter = self.rewriter
        code = self._code(piece)
        if piece.kept:
            self.now = rewriter.end_mm[self.move].copy()
            self.motion, self.own_done = code, True
            written.line_of_piece[index] = self.line + written.inserted
            return
        wanted = rewriter.position(piece.move, piece.end) + rewriter.to_program(
            target.ends_mm[index], piece.move
        )
        before, words = self.now.copy(), {} if self.own_done else self._own_words()
        texts = self._axis_texts(wanted, words, written)
        if piece.is_arc:
            middle = rewriter.position(piece.move, 0.5 * (piece.start + piece.end))
            middle = middle + rewriter.to_program(target.middles_mm[index], piece.move)
            centre = self._centre_texts(before, middle, wanted, words)
            if centre is None:
                code = 1
            else:
                texts |= centre
        if not texts and self.own_done:
            return
        if not self.own_done:
            self._edit_own(texts, words, code)
        else:
            head = f"G{code} " if code != self.motion else ""
            block = head + " ".join(f"{k}{v}" for k, v in texts.items())
            self.blocks.append(block.lower() if self.lower else block)
            written.inserted += 1
            written.inserted_after.append(self.line)
        self.own_done, self.motion = True, code
        written.line_of_piece[index] = self.line + written.inserted

    def _code(self, piece: Piece) -> int:
        moves = self.rewriter.moves
        kind = moves.kind[piece.move]
        if kind == MoveKind.RAPID:
            return 0
        if kind == MoveKind.LINE or not (piece.is_arc or piece.kept):
            return 1
        return 3 if moves.sweep_rad[piece.move] > 0 else 2

    def _own_words(self) -> dict[str, Word]:
        return {w.letter: w for w in self.words if w.letter in "XYZIJKRP" and w.value is not None}

    def _axis_texts(
        self, wanted: np.ndarray, words: dict[str, Word], written: Written
    ) -> dict[str, str]:
        """Words X Y Z that lead to the wanted point; moves `now` to where they really lead."""
        texts, unit = {}, self.mode.unit_mm
        for axis, letter in enumerate("XYZ"):
            base = self.now[axis] if self.mode.incremental else 0.0
            value = (wanted[axis] - base) / unit
            word = words.get(letter)
            old = word.value if word else (self.now[axis] - base) / unit
            if abs(value - old) < 0.5 * self.step:
                written.swallowed += int(abs(value - old) > 1e-9)
                new = old
                if word:
                    texts[letter] = word.text[1:]
            else:
                texts[letter] = _number(value, self.decimals)
                new = float(texts[letter])
            self.now[axis] = base + new * unit
        return texts

    def _centre_texts(
        self, start: np.ndarray, middle: np.ndarray, end: np.ndarray, words: dict[str, Word]
    ) -> dict[str, str] | None:
        """Words I J K of the arc, rounded so that both radii agree best; None for no arc."""
        axis = self.rewriter.moves.axis[self.move]
        side = [k for k in range(3) if abs(axis[k]) < 0.5]
        stop = self.now[side]
        if np.linalg.norm(stop - start[side]) < 20 * self.step * self.mode.unit_mm:
            return None
        centre = circle_through(start[side], middle[side], end[side])
        if centre is None:
            return None
        unit = self.mode.unit_mm
        origin = np.zeros(2) if self.mode.absolute_centre else start[side]
        ideal = (centre - origin) / unit
        near = np.round(ideal, self.decimals)
        tries = [near + self.step * np.array(d) for d in product((-1, 0, 1), repeat=2)]

        def unlike(value: np.ndarray) -> float:
            at = origin + value * unit
            radii = np.linalg.norm(start[side] - at), np.linalg.norm(stop - at)
            return abs(radii[0] - radii[1]) + 0.2 * np.linalg.norm(at - centre)

        best = min(tries, key=unlike)
        texts = {}
        for letter, value in zip(("IJK"[k] for k in side), best, strict=True):
            word = words.get(letter)
            same = word is not None and abs(word.value - value) < 0.5 * self.step
            texts[letter] = word.text[1:] if same else _number(value, self.decimals)
        return texts

    def _edit_own(self, texts: dict[str, str], words: dict[str, Word], code: int) -> None:
        """Replace, remove and add words of the line's own block."""
        added = {k: v for k, v in texts.items() if k not in words}
        is_arc = self.rewriter.moves.kind[self.move] == MoveKind.ARC
        for letter, word in words.items():
            if letter in texts:
                if texts[letter] != word.text[1:]:
                    self.first[word.span] = word.text[0] + texts[letter]
            elif letter in "IJKR" or (letter == "P" and is_arc):
                self.first[word.span] = ""
        motion = [w for w in self.words if w.letter == "G" and w.value is not None
                  and round(10 * w.value) in _MOTION]  # fmt: skip
        if motion and motion[0].value != code:
            self.first[motion[0].span] = f"{motion[0].text[0]}{code}"
        anchor = next(w for w in reversed(self.words) if w.letter in "XYZIJKRG")
        tail = [f"{k}{v}" for k, v in added.items()]
        if not motion and self.motion not in (-1, code):
            tail.insert(0, f"G{code}")
        if tail:
            gap = " " if self._is_spaced() else ""
            text = gap + gap.join(tail)
            kept = self.first.get(anchor.span, anchor.text)
            self.first[anchor.span] = kept + (text.lower() if self.lower else text)

    def _is_spaced(self) -> bool:
        pairs = zip(self.words, self.words[1:], strict=False)
        return any(right.span[0] > left.span[1] for left, right in pairs) or len(self.words) == 1

    def edits(self) -> dict[tuple[int, int], str]:
        """Replacements for `gcode.Source.rewritten`."""
        edits = dict(self.first)
        if self.blocks:
            source = self.rewriter.program.source
            text = source.lines[self.line - 1]
            at = int(source.line_starts[self.line - 1]) + len(text)
            eol = "\r\n" if source.data[at : at + 1] == b"\r" else "\n"
            lead = "/" if text.lstrip().startswith("/") else ""
            edits[at, at] = "".join(eol + lead + block for block in self.blocks)
        return edits


def _turned(vector: np.ndarray, angle_rad: float) -> np.ndarray:
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    x, y, z = vector
    return np.array([cos * x - sin * y, sin * x + cos * y, z])


def _number(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    return text[1:] if float(text) == 0.0 and text.startswith("-") else text
