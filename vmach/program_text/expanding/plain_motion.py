"""Canned cycles, cutter compensation, corners and polar words as G0, G1, G2, G3 and G4."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gcode import Modes, MoveKind, PlainLines, Program, Step, Word
from vmach.errors import InputError
from vmach.program_text.blocks.block_modes import PLANE_AXES
from vmach.program_text.expanding.expanded_text import Expanded, LineBuilder, number_text
from vmach.program_text.frame_shift import rotation_of_moves, turned_about_z

__all__ = ["plain"]

_TAPPING = {"G74", "G84"}
_CYCLES = {"G73", "G74", "G81", "G82", "G83", "G84", "G85", "G86", "G89"}
#: G codes whose motion cannot be written in plain blocks
_REFUSED = {"G5": "spline", "G5.1": "spline", "G5.2": "spline", "G5.3": "spline",
            "G33": "threading", "G38.2": "probing", "G38.3": "probing", "G38.4": "probing",
            "G38.5": "probing", "G76": "threading", "G87": "back boring",
            "G88": "boring with retraction by hand"}  # fmt: skip
_PLAIN = {"G0", "G1", "G2", "G3"}
_COMPENSATION = {"G41", "G42", "G41.1", "G42.1"}
_GONE = _PLAIN | _COMPENSATION | _CYCLES | {"G40", "G53", "G80", "G98", "G99"}
_PATH_CONTROL = {"G61", "G61.1", "G64"}
_GONE_WORDS = frozenset("XYZIJKRPQLD@^")
_AXES = "XYZ"
_STILL_MM = 1e-9
_CORNER = "corner: lines and arcs"
_REFERENCE = {"G28", "G30"}


def plain(program: Program, *, floating_tap: bool) -> Expanded | None:
    """Write out what is not plain motion; None where everything is.

    Parameters
    ----------
    program : Program
        Every line obeyed at most once, in order, with numbers only.
    floating_tap : bool
        The control taps by reversing the spindle at feed, so that this can be written out.

    Raises
    ------
    InputError
        Splines, threading, probing, and cycles that plain blocks cannot do.
    """
    if not program.language.is_rs274:
        return None
    writer = _Writer(program, LineBuilder(program))
    done = 0
    for step in program.outline:
        if isinstance(step, PlainLines):
            writer.plain_lines(step)
            done = step.last
            continue
        for line in range(done + 1, step.line):
            writer.line(line, None, None)
        _write_step(writer, step, floating_tap=floating_tap)
        done = step.line
    for line in range(done + 1, len(program.source) + 1):
        writer.line(line, None, None)
    writer.end_exact_path()
    return writer.lines.result() if writer.lines.reasons else None


def _write_step(writer: _Writer, step: Step, *, floating_tap: bool) -> None:
    """Copy the line of a step or write it out; refuse what cannot be written out."""
    rows, path = writer.rows_of(step.line), writer.program.path
    if (refused := _refused(step, rows)) is not None:
        raise InputError(f"{refused} cannot be compensated", file=path, line=step.line)
    why = _why(step, rows)
    if why is None and len(rows) > 1 and writer.has_corner(step.line):
        why = _CORNER
    if why and step.modes.motion in _TAPPING and not floating_tap:
        raise InputError(
            f"tapping cycle {step.modes.motion} cannot be written out for this control",
            file=path,
            line=step.line,
            accepted="LinuxCNC, whose G84 feeds and reverses the spindle",
        )
    writer.line(step.line, step, why)


def _refused(step: Step, rows: np.ndarray) -> str | None:
    """What of a line, with rows (R,) of the record, cannot be written in plain blocks."""
    for code in (*step.g_names, *([step.modes.motion] if len(rows) else [])):
        if code in _REFUSED:
            return _REFUSED[code]
    return "diameter mode" if len(rows) and step.modes.diameter else None


def _why(step: Step, rows: np.ndarray) -> str | None:
    """Why a line is to be written out; None where it may stay."""
    codes = step.g_names
    modes, switched = step.modes, step.before.side != step.modes.side
    if modes.motion in _CYCLES and (len(rows) or codes & _CYCLES):
        return "canned cycle: plain motion"
    if modes.side or step.before.side or switched or codes & _COMPENSATION:
        return "cutter compensation: the compensated path"
    if len(rows) and step.words.keys() & {"@", "^"}:
        return "polar coordinates: X and Y"
    return None


@dataclass
class _Writer:
    """Writes line after line."""

    program: Program
    lines: LineBuilder
    motion: str | None = None  #: G code in force in the new text; None where it is the old one's
    resume: str | None = None  #: words that end the exact stops of a run of cycles
    said_control: str = "G64"
    ended_compensation: bool = False
    after_corner: bool = False  #: the line before ends where its rounding or chamfer does

    def __post_init__(self) -> None:
        self.path = self.program.record.path()
        self.moves = self.program.moves
        order = self.order = self.path.line.astype(np.int64)
        if (np.diff(order) < 0).any():
            line = int(order[1:][np.diff(order) < 0][0])
            raise InputError(
                f"moves of line {line} out of the order of the lines", file=self.program.path
            )
        moving = np.flatnonzero(self.moves.kind != MoveKind.DWELL)
        self.first_row = int(moving[0]) if len(moving) else -1
        self.angle = rotation_of_moves(self.program)
        record = self.program.record
        self.arcs = {int(arc[0]): arc for arc in record.arcs.tolist()}
        self.seconds = {int(row): seconds for row, seconds in record.dwells.tolist()}

    def rows_of(self, line: int) -> np.ndarray:
        """Rows of the record that a line makes, (R,) indices."""
        first, stop = np.searchsorted(self.order, [line, line + 1])
        return np.arange(first, stop)

    def motion_of(self, row: int) -> np.ndarray:
        """Motion of a row in the axes of the program, (3,) mm; frames may change between rows."""
        motion = self.moves.end_mm[row] - self.moves.start_mm[row]
        return turned_about_z(motion, -self.angle[row])

    def line(self, line: int, step: Step | None, why: str | None) -> None:
        """Copy a line, or write it out."""
        rows = self.rows_of(line)
        if step is not None and step.g_names & _PATH_CONTROL:
            self.said_control = " ".join(
                [f"{w.letter}{w.text[1:].strip()}" for w in self.program.source.words(line)
                 if w.letter in "GPQ" and (w.letter != "G" or w.value in (61, 61.1, 64))]
            )  # fmt: skip
        self.ended_compensation |= step is not None and bool(step.before.side)
        cycle = why is not None and step.modes.motion in _CYCLES
        if len(rows) and not cycle:
            self.end_exact_path()
        if why is None and step is not None and len(rows):
            if self._loses_motion(step):
                why = "modal motion of the lines before it"
            elif self._goes_elsewhere(step, rows):
                why = "cutter compensation: the programmed point after its end"
            elif self.after_corner:
                why = _CORNER
        if why is None:
            self.lines.keep(line)
            if step is not None and step.g_names & (_PLAIN | {"G80"}):
                self.motion = None
        else:
            self._write_out(line, step, rows, why)
        if len(rows):
            self.after_corner = self.has_corner(line)

    def has_corner(self, line: int) -> bool:
        """A word such as ``,R5.`` or ``,C2.``, a rounding or a chamfer behind the move."""
        return any(self._is_corner(line, word) for word in self.program.source.words(line))

    def _is_corner(self, line: int, word: Word) -> bool:
        source = self.program.source
        before = source.line(line)[: word.span[0] - int(source.line_starts[line - 1])]
        return before.rstrip(" \t").endswith(",")

    def plain_lines(self, lines: PlainLines) -> None:
        """Copy lines of plain motion; the first of them may not be able to stay."""
        line = lines.first
        while line <= lines.last and self._is_unsettled:
            self.line(line, self._step(lines, line), None)
            line += 1
        if line <= lines.last:
            self.lines.keep(line, lines.last)

    @property
    def _is_unsettled(self) -> bool:
        """Lines have been written out, on which the next line that moves may rely."""
        pending = self.motion is not None or self.resume is not None
        return pending or self.ended_compensation or self.after_corner

    def _step(self, lines: PlainLines, line: int) -> Step:
        """The step of one line of plain motion."""
        index, words = line - lines.first, self.program.source.words(line)
        codes = [w.value for w in words if w.letter == "G"]
        motion = f"G{lines.motion[index]}" if lines.motion[index] >= 0 else lines.before.motion
        modes = replace(lines.before, motion=motion)
        said = {w.letter: w.value for w in words if w.letter not in "GN"}
        return Step(line, modes, said, codes, blocks=1, modes=modes)

    def _loses_motion(self, step: Step) -> bool:
        """A line that relies on a motion word that the new text has changed."""
        return not step.g_names & _PLAIN and self.motion not in (None, step.modes.motion)

    def _goes_elsewhere(self, step: Step, rows: np.ndarray) -> bool:
        """The first line after G40 also moves the axes that it does not name."""
        row, codes = int(rows[0]), step.g_names
        if not self.ended_compensation or codes & _REFERENCE:
            return False
        self.ended_compensation = False
        motion, unit_mm = self.motion_of(row), step.modes.unit_mm
        said = np.array([unit_mm * step.words.get(letter, 0.0) for letter in _AXES])
        if step.modes.absolute or "G53" in codes:
            said = np.where([letter in step.words for letter in _AXES], motion, 0.0)
        return bool((np.abs(motion - said) > _STILL_MM).any())

    def _write_out(self, line: int, step: Step, rows: np.ndarray, why: str) -> None:
        blocks = [b for b in _Blocks(self, step, rows) if b]
        exact = step.modes.motion in _CYCLES and step.modes.path_control == "G64" and len(blocks)
        if exact and self.resume is None:
            blocks[0], self.resume = f"G61 {blocks[0]}", self.said_control
        head = self._head(line, step, blocks[0] if blocks else "")
        lower = head != head.upper() and head == head.lower()
        if head.strip(" \t/"):
            self.lines.write(line, head, why)
        else:
            self.lines.drop(line, why)
        deleted = "/" if head.lstrip().startswith("/") else ""
        for block in blocks[1:]:
            self.lines.write(line, deleted + (block.lower() if lower else block), why)

    def _head(self, line: int, step: Step, block: str) -> str:
        """The line with its motion words replaced by a block."""
        source, start = self.program.source, int(self.program.source.line_starts[line - 1])
        words = [w for w in source.words(line) if self._goes(w, step) or self._is_corner(line, w)]
        text = source.line(line)
        if step.modes.feed_mode == "inverse":
            words += [w for w in source.words(line) if w.letter == "F"]
            words.sort(key=lambda w: w.span)
        lower = any(w.text[0].islower() for w in source.words(line))
        block = block.lower() if lower else block
        if not words and block:
            last = source.words(line)[-1].span[1] - start if source.words(line) else 0
            return f"{text[:last]} {block}{text[last:]}"
        pieces, position = [], 0
        for word in words:
            before = text[position : word.span[0] - start]
            if self._is_corner(line, word):
                before = before.rstrip(" \t").removesuffix(",")
            first = word is words[0] and block
            pieces += [before, block] if first else [before.rstrip(" \t") if position else before]
            position = word.span[1] - start
        return "".join([*pieces, text[position:]]).rstrip(" \t")

    def _goes(self, word: Word, step: Step) -> bool:
        if word.letter == "G":
            return word.value is not None and f"G{word.value:g}" in _GONE
        return word.letter in _GONE_WORDS and not (
            word.letter in "PQ" and step.g_names & {"G4", "G10", "G64"}
        )

    def end_exact_path(self) -> None:
        """Let the corners be rounded again after a run of cycles."""
        if self.resume is not None:
            self.lines.write(self.lines.last_origin, self.resume, "canned cycle: plain motion",
                             numbers=False)  # fmt: skip
            self.resume = None


class _Blocks:
    """Blocks of the rows of one line, in its modes."""

    def __init__(self, writer: _Writer, step: Step, rows: np.ndarray) -> None:
        self.writer, self.step, self.rows = writer, step, rows
        self.modes: Modes = step.modes

    def __iter__(self) -> Iterator[str]:
        """Blocks of text."""
        pending: str | None = None  # M code after the next move
        for row in self.rows.tolist():
            kind = self.writer.moves.kind[row]
            if kind == MoveKind.DWELL:
                if self.modes.motion not in _CYCLES:  # the block with G4 stays
                    continue
                before, after, pending = self._at_the_bottom()
                yield from before
                seconds = self.writer.seconds.get(row, 0.0)
                if seconds:
                    yield self.writer.program.language.pause(seconds)
                yield from after
            else:
                yield self._move(row)
                if pending:
                    yield pending
                    pending = None

    def _at_the_bottom(self) -> tuple[list[str], list[str], str | None]:
        """M codes before and after the pause, and after the move that follows it."""
        forward, backward = ("M3", "M4") if self.modes.spindle > 0 else ("M4", "M3")
        if self.modes.motion in _TAPPING:
            return [backward], [], forward
        if self.modes.motion == "G86":
            return [], ["M5"], forward
        return [], [], None

    def _move(self, row: int) -> str:
        writer = self.writer
        end = writer.path.point_mm[row]
        start = end - writer.motion_of(row)
        arc = writer.arcs.get(row)
        kind = writer.moves.kind[row]
        texts = self._axis_words(row, start, end)
        if arc is not None:
            code = 3 if arc[6] > 0 else 2
            texts += self._centre_words(start, arc)
        elif not texts:
            return ""
        else:
            code = 0 if kind == MoveKind.RAPID else 1
        writer.motion = f"G{code}"
        if self.modes.feed_mode == "inverse" and code:
            texts.append("F" + self._inverse_feed(row))
        return " ".join([f"G{code}", *texts])

    def _axis_words(self, row: int, start: np.ndarray, end: np.ndarray) -> list[str]:
        is_arc = row in self.writer.arcs
        moved = np.abs(end - start) > _STILL_MM
        if row == self.writer.first_row:  # nobody knows where the machine stands before it
            moved |= [a in self.step.words for a in _AXES]
            moved[:2] |= bool(self.step.words.keys() & {"@", "^"})
        if is_arc:
            moved[list(PLANE_AXES[self.modes.plane][:2])] = True
        values = (end if self.modes.absolute else end - start) / self.modes.unit_mm
        return [a + number_text(a, v) for a, v, m in zip(_AXES, values, moved, strict=True) if m]

    def _centre_words(self, start: np.ndarray, arc: tuple) -> list[str]:
        first, second, _ = PLANE_AXES[self.modes.plane]
        centre = {first: arc[4], second: arc[5]}
        words = []
        for axis in sorted(centre):
            value = centre[axis] - (0.0 if self.modes.arc_absolute else start[axis])
            words.append("IJK"[axis] + number_text("I", value / self.modes.unit_mm))
        turns = abs(int(arc[6]))
        return [*words, f"P{turns}"] if turns > 1 else words

    def _inverse_feed(self, row: int) -> str:
        """One over the minutes that the move takes."""
        moves = self.writer.moves
        minutes = moves.duration_s[row] / 60.0
        return number_text("F", 1.0 / minutes if minutes > 0 else 1.0)
