"""Heidenhain Klartext: how its blocks are written, and edits of one line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cached_property

from gcode.text.source import Word
from gcode.writing.block_text import BlockText, Labels, Style
from gcode.writing.klartext_blocks import KlartextBlocks
from gcode.writing.line_edit import BlockMotion, LineEdit

__all__ = ["KlartextEdit", "KlartextText"]


class KlartextText(BlockText):
    """Heidenhain Klartext: L, C and CR with signed numbers, circle centres in CC blocks."""

    word_form = "klartext"
    absolute_centres = True
    renumbers = True
    fewest_decimals = 1
    plain = KlartextBlocks
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

    def free_labels(self) -> Labels | None:
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

    word_forms = ("klartext",)

    def __init__(
        self, text: KlartextText, line: int, *, nominal: int, ending: frozenset[int]
    ) -> None:
        super().__init__(text, line, nominal=nominal, ending=ending)
        self.own |= {w.letter: w for w in self.words if w.letter == "DR"}

    def extra_blocks(self, motion: BlockMotion, *, is_own: bool) -> int:
        """Arcs about a centre take a CC block more, but where the user's serves."""
        needs_pole = _has_centre(motion) and not (is_own and self._users_pole)
        return super().extra_blocks(motion, is_own=is_own) + needs_pole

    def changes(
        self, motions: Sequence[BlockMotion], in_force: int, labels: Labels | None
    ) -> dict[tuple[int, int], str]:
        """Replacements, the centre's block first."""
        changes, own = super().changes(motions, in_force, labels), motions[0]
        if self.extra_blocks(own, is_own=True):
            pole = " ".join(self._pole(own)) + self._line_end(self._start + 200)
            changes[self._start, self._start] = pole
        return changes

    @cached_property
    def _users_pole(self) -> dict[str, Word] | None:
        """X and Y of the user's own CC block, where it stands right before the line."""
        words = self.text.words(self.line - 1) if self.line > 1 else ()
        if not words or words[0].text.upper() != "CC":
            return None
        found = {w.letter: w for w in words[1:] if not self.text.is_incremental(w)}
        return found if set(found) == {"X", "Y"} else None

    def _own_changes(self, motion: BlockMotion, in_force: int) -> dict[tuple[int, int], str]:
        changes = super()._own_changes(motion, in_force)
        if _has_centre(motion) and self._users_pole:
            for axis, number in _centre(motion).items():
                word = self._users_pole[axis]
                changes[word.span] = self.text.word(axis, number, word)
        return changes

    def _numbers(self, motion: BlockMotion) -> dict[str, str]:
        turning = {"DR": "+" if motion.code == 3 else "-"} if motion.code > 1 else {}
        return {k: v for k, v in motion.numbers.items() if k not in "IJ"} | turning

    def _leaving(self) -> Sequence[str]:
        return ("R", "DR")

    def _head(self, motion: BlockMotion, said: Word) -> str:
        head = _function(motion)
        return said.text if said.text.upper() == head else head

    def _blocks_behind(self, motion: BlockMotion, in_force: int) -> list[list[str]]:
        pole = [self._pole(motion)] if _has_centre(motion) else []
        return [*pole, [_function(motion), *self._words(motion)]]

    def _pole(self, motion: BlockMotion) -> list[str]:
        return ["CC", *(self.text.word(k, number) for k, number in _centre(motion).items())]


def _has_centre(motion: BlockMotion) -> bool:
    return motion.numbers is not None and "I" in motion.numbers


def _centre(motion: BlockMotion) -> dict[str, str]:
    """Numbers of the CC block, by letter."""
    return {"X": motion.numbers["I"], "Y": motion.numbers["J"]}


def _function(motion: BlockMotion) -> str:
    """The word that a block of this motion begins with."""
    return "L" if motion.code < 2 else "C" if _has_centre(motion) else "CR"
