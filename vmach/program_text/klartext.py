"""Heidenhain Klartext: how its blocks are written, and edits of one line."""

from __future__ import annotations

import re
from functools import cached_property

from gcode import Word
from vmach.program_text.block_text import BlockText, Labels, Style
from vmach.program_text.line_edit import Block, LineEdit

__all__ = ["KlartextEdit", "KlartextText"]


class KlartextText(BlockText):
    """Heidenhain Klartext: L, C and CR with signed numbers, circle centres in CC blocks."""

    absolute_centres = True
    fewest_decimals = 1
    _TOKEN = re.compile(
        r"(?<![A-Z])(I?[XYZ]|DR|R(?![0LR](?![\d.]))|F|M)[ \t]*"
        r"([+-]?[ \t]*(?:\d+\.?\d*|\.\d+)|[+-](?=\s|$))",
        re.IGNORECASE,
    )
    _HEAD = re.compile(r"^([ \t]*(?:\d+[ \t]+)?)(L|CR|CC|C)(?=[ \t]|$)", re.IGNORECASE)
    _LABEL = re.compile(rb"^([ \t]*)(\d+)(?=[ \t])", re.MULTILINE)

    def _read(self, line: int) -> tuple[Word, ...]:
        text = self.source.lines[line - 1].split(";")[0]
        offset = int(self.source.line_starts[line - 1])
        head = self._HEAD.match(text)
        if head is None:
            return ()
        words = [Word("HEAD", None, head[2], (offset + head.start(2), offset + head.end(2)))]
        for found in self._TOKEN.finditer(text, head.end()):
            name, value = found[1].upper(), re.sub(r"\s", "", found[2])
            signs_only = value in ("+", "-")
            words.append(Word("DR" if name == "DR" else name[-1],
                              None if signs_only else float(value), found.group(),
                              (offset + found.start(), offset + found.end())))  # fmt: skip
        return tuple(words)

    def motion_word(self, line: int) -> Word | None:
        """L, C or CR."""
        return next((w for w in self.words(line) if w.letter == "HEAD"), None)

    def is_incremental(self, word: Word) -> bool:
        """IX, IY, IZ."""
        return word.text[0] in "Ii" and word.letter in "XYZ"

    @cached_property
    def style(self) -> Style:
        """Signs before all numbers, words apart."""
        found = BlockText.style.func(self)
        return Style(plus=True, fill=found.fill, lower=found.lower)

    def labels_in_order(self) -> bool:
        """Whether every line has a block number."""
        lines = [s for s in self.source.lines if s.strip()]
        return bool(lines) and all(re.match(r"\s*\d+\s", s) for s in lines)

    @cached_property
    def labels(self) -> Labels | None:
        """None: all blocks are numbered anew at the end."""
        return None

    def finish(self, text: bytes) -> bytes:
        """Number the blocks consecutively, where the program does."""
        if not self.labels_in_order():
            return text
        first = int(re.match(r"\s*(\d+)", next(s for s in self.source.lines if s.strip()))[1])
        lines, number = text.splitlines(keepends=True), first
        for index, line in enumerate(lines):
            if line.strip():
                bare = self._LABEL.sub(rb"\1", line, count=1).lstrip()
                lines[index] = b"%d " % number + bare
                number += 1
        return b"".join(lines)


class KlartextEdit(LineEdit):
    """The same in Klartext, where an arc's centre is a block of its own before it."""

    def __init__(
        self, text: KlartextText, line: int, motion: int, *, nominal: int, ending: frozenset[int]
    ) -> None:
        super().__init__(text, line, motion, nominal=nominal, ending=ending)
        found = next((w for w in self.words if w.letter == "DR"), None)
        if found is not None:
            self.position["DR"] = found
        self.poles: list[str] = []  #: blocks before the line's own

    def write(self, code: int, numbers: dict[str, str]) -> int:
        """Write one motion; arcs about a centre take a CC block more."""
        centre = [numbers.pop(k) for k in "IJ" if k in numbers]
        before = self._put_pole(dict(zip("XY", centre, strict=True))) if centre else 0
        self.head = "L" if code < 2 else "C" if centre else "CR"
        if code > 1:
            numbers["DR"] = "+" if code == 3 else "-"
        if not self.own_done:
            return before + super().write(code, numbers)
        words = [self.text.word(letter, number) for letter, number in numbers.items()]
        self.blocks.append(Block(None, {"": " ".join([self.head, *words])}))
        return before + 1

    def _put_pole(self, centre: dict[str, str]) -> int:
        """Say the centre, in the user's CC block where that stands right before the line."""
        said = self._users_pole()
        if said and not self.own_done:
            for axis, number in centre.items():
                self.changes[said[axis].span] = self.text.word(axis, number, said[axis])
            return 0
        pole = " ".join(["CC", *(self.text.word(a, number) for a, number in centre.items())])
        if self.own_done:
            self.blocks.append(Block(None, {"": pole}))
        else:
            self.poles.append(pole)
        return 1

    def _users_pole(self) -> dict[str, Word] | None:
        words = self.text.words(self.line - 1) if self.line > 1 else ()
        if not words or words[0].text.upper() != "CC":
            return None
        found = {w.letter: w for w in words[1:] if not self.text.is_incremental(w)}
        return found if set(found) == {"X", "Y"} else None

    def _gone(self, numbers: dict[str, str]) -> list[str]:
        return [k for k in ("R", "DR") if k in self.position and k not in numbers]

    def _differs(self, said: Word, code: int) -> bool:
        return said.text.upper() != self.head

    def _motion(self, code: int, said: Word) -> str:
        return self.head

    def _block(self, block: Block, tail: list[str]) -> str:
        return " ".join([block.words[""], *tail])

    def edits(self) -> dict[tuple[int, int], str]:
        """Replacements, the centre's block first."""
        edits = super().edits()
        if self.poles:
            at = int(self.text.source.line_starts[self.line - 1])
            ending = "\r\n" if b"\r\n" in self.text.source.data[: at + 200] else "\n"
            edits[at, at] = "".join(pole + ending for pole in self.poles)
        return edits
