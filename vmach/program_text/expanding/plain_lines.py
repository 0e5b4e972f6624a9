"""Cycles, radius compensation, parameters and polar words of a dialect without letters-and-numbers
blocks, written out as plain lines and arcs."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import replace

import numpy as np

from gcode import MoveKind, PlainArc, PlainBlocks, PlainLines, Program, Step
from vmach.program_text.expanding.expanded_text import Expanded, LineBuilder
from vmach.program_text.frame_shift import rotation_of_moves, turned_about_z

__all__ = ["plain_lines"]

_STILL_MM = 1e-9


def plain_lines(program: Program) -> Expanded | None:
    """Write out the lines that make several motions or whose words cannot be written anew.

    None where there are none, or where the dialect has no plain lines for them; a line that plain
    ones cannot replace (a helix of Klartext, machine coordinates) stays as it is.

    Parameters
    ----------
    program : Program
        Every line obeyed at most once, in order.
    """
    text = program.language.text(program.source)
    moving = program.moves.line[program.moves.kind != MoveKind.DWELL]
    if program.language.is_rs274 or text.plain is None or (np.diff(moving) < 0).any():
        return None
    control = program.options.get("control")
    blocks = text.plain(program.source, control.options if control else {})
    writer = _Writer(program, blocks)
    writer.write()
    return writer.lines.result() if writer.lines.reasons else None


class _Steps:
    """Steps by line, where those of plain motion are made when they are asked for.

    Parameters
    ----------
    program : Program
    """

    def __init__(self, program: Program) -> None:
        self.text = program.language.text(program.source)
        outline = program.outline
        self.single = {step.line: step for step in outline if isinstance(step, Step)}
        self.plain = [part for part in outline if isinstance(part, PlainLines)]
        self.first = [part.first for part in self.plain]

    def stretch(self, line: int) -> PlainLines | None:
        """The lines of plain motion to which a line belongs."""
        place = bisect_right(self.first, line) - 1
        is_plain = place >= 0 and line <= self.plain[place].last and line not in self.single
        return self.plain[place] if is_plain else None

    def get(self, line: int) -> Step | None:
        """The step of a line, without words where it is plain; None where it is not obeyed."""
        part = self.stretch(line)
        if part is None:
            return self.single.get(line)
        return Step(line, part.before, blocks=1, modes=part.modes)

    def with_words(self, line: int) -> Step | None:
        """The same with the words X Y Z of a plain line."""
        step = self.get(line)
        if step is None or line in self.single:
            return step
        words = {w.letter: w.value for w in self.text.words(line) if w.letter in ("X", "Y", "Z")}
        return replace(step, words=words)


class _Writer:
    """Writes line after line."""

    def __init__(self, program: Program, blocks: PlainBlocks) -> None:
        self.program, self.blocks, self.moves = program, blocks, program.moves
        self.lines = LineBuilder(program)
        self.point_mm = program.record.path().point_mm
        self.order = np.argsort(self.moves.line, kind="stable")
        self.angle = rotation_of_moves(program)
        self.seconds = {int(row): seconds for row, seconds in program.record.dwells.tolist()}
        self.steps = _Steps(program)
        self.looked_at = 0  #: up to this line, every line is looked at alone
        #: feed, circle centre and kind of motion in force are the user's
        self.own_feed = self.own_pole = self.own_motion = True

    def write(self) -> None:
        """All lines."""
        line, count = 1, len(self.program.source)
        while line <= count:
            untouched = self._untouched(line)
            if untouched:
                self.lines.keep(line, untouched)
                line = untouched + 1
                continue
            last = self.blocks.last_line(line)
            why = self._why(line)
            written = None if why is None else self._written(line)
            if written is None:
                self.lines.keep(line, last)
                self.own_feed |= self.blocks.says_feed(line)
                self.own_pole |= self.blocks.sets_pole(line)
                self.own_motion |= self.blocks.says_motion(line)
            else:
                for block in self.blocks.framed(line, written):
                    self.lines.write(line, block, why)
                if not written:
                    self.lines.drop(line, why)
                self.own_feed &= not written
                self.own_motion &= not written
                self.own_pole &= not any(block.startswith("CC") for block in written)
            line = last + 1

    def _untouched(self, line: int) -> int:
        """Last of the lines of plain motion from this one on, if all of them stay; 0 if not."""
        part = self.steps.stretch(line)
        if part is None or line <= self.looked_at or not (
            self.own_feed and self.own_pole and self.own_motion
        ):  # fmt: skip
            return 0
        source, pattern = self.program.source, self.program.language.unwritable
        text = source.data[source.line_starts[line - 1] : source.line_starts[part.last]]
        if pattern is None or not pattern.search(text.decode("latin-1")):
            return part.last
        self.looked_at = part.last
        return 0

    def _rows(self, line: int) -> np.ndarray:
        return self.order[
            slice(*np.searchsorted(self.moves.line, [line, line + 1], sorter=self.order))
        ]

    def _why(self, line: int) -> str | None:
        """Why a line is to be written out."""
        step, rows = self.steps.get(line), self._rows(line)
        moving = rows[self.moves.kind[rows] != MoveKind.DWELL]
        made_later = step is not None and not step.blocks and len(moving) > 0  # as under RNDM
        if self.blocks.waits(line) or made_later:
            return "corner or modal call: its moves"
        if step is None or not len(moving) or step.unwritable:
            return None
        if step.modes.side or step.before.side:
            return "radius compensation: the compensated path"
        pattern = self.program.language.unwritable
        if len(moving) > 1:
            return "cycle: plain motion"
        if pattern is not None and pattern.search(self.program.source.lines[line - 1]):
            return "parameters, polar words: X and Y"
        is_fed = self.moves.kind[moving[0]] != MoveKind.RAPID
        lacks_feed = is_fed and not self.own_feed and not self.blocks.says_feed(line)
        lacks_motion = not self.own_motion and not self.blocks.says_motion(line)
        lacks_pole = not self.own_pole and self.blocks.needs_pole(line)
        if lacks_feed or lacks_motion or lacks_pole:
            return "modes of the lines before it"
        return None

    def _written(self, line: int) -> list[str] | None:
        """Plain blocks of a line; None where plain ones cannot replace it."""
        step, found = self.steps.with_words(line), []
        if self.blocks.is_in_machine_coordinates(line):
            return None
        for row in self._rows(line).tolist():
            block = self._block(row, step)
            if block is None:
                return None
            found += block
        return found

    def _block(self, row: int, step: Step) -> list[str] | None:
        moves, kind = self.moves, self.moves.kind[row]
        modes = step.modes
        if modes.plane != 1 or modes.feed_mode != "minute":
            return None
        if kind == MoveKind.DWELL:
            seconds = self.seconds.get(row, 0.0)
            return self.blocks.pause(seconds) if seconds else []
        end = self.point_mm[row]
        motion = turned_about_z(moves.end_mm[row] - moves.start_mm[row], -self.angle[row])
        unit = modes.unit_mm
        feed_unit = self.blocks.feed_unit_mm(step.line, unit)
        feed = None if kind == MoveKind.RAPID else float(moves.feed_mm_per_min[row]) / feed_unit
        if kind == MoveKind.ARC:
            out = turned_about_z(moves.centre_mm[row] - moves.end_mm[row], -self.angle[row])
            turns = float(moves.sweep_rad[row] * moves.axis[row, 2])
            places = [place / unit for place in (end - motion, end, end + out)]
            return self.blocks.arc(PlainArc(*places, turns, absolute=modes.absolute), feed)
        named = [a for a, m in zip("XYZ", motion, strict=True)
                 if abs(m) > _STILL_MM or a in step.words]  # fmt: skip
        said = end if modes.absolute else motion
        return self.blocks.straight(said / unit, named, feed) if named else []
