"""The syntax of each dialect: how its blocks are written, and edits of one line in it."""

from __future__ import annotations

import re

from gcode import Program, Word
from vmach.program_text.blocks.block_text import BlockText
from vmach.program_text.blocks.line_edit import LineEdit
from vmach.program_text.klartext import KlartextEdit, KlartextText

__all__ = ["block_text", "line_edit"]


class SinumerikText(BlockText):
    """Sinumerik: ``X=1.5``, ``CR=`` for the radius, ``TURN=`` for further turns."""

    _TOKEN = re.compile(r"(CR|TURN|[A-Z])[ \t]*(=?)[ \t]*([+-]?(?:\d+\.?\d*|\.\d+))", re.IGNORECASE)

    def _read(self, line: int) -> tuple[Word, ...]:
        text = self.source.lines[line - 1].split(";")[0]
        offset = int(self.source.line_starts[line - 1])
        return tuple(
            Word({"CR": "R", "TURN": "P"}.get(m[1].upper(), m[1].upper()), float(m[3]), m.group(),
                 (offset + m.start(), offset + m.end()))
            for m in self._TOKEN.finditer(text)
        )  # fmt: skip

    def word(self, letter: str, number: str, like: Word | None = None) -> str:
        """A word with a number; CR takes an equal sign."""
        return super().word("CR=" if letter == "R" and like is None else letter, number, like)


def block_text(program: Program) -> BlockText:
    """The syntax of a program."""
    kinds = {"sinumerik": SinumerikText, "heidenhain": KlartextText}
    return kinds.get(program.dialect, BlockText)(program.source)


def line_edit(text: BlockText, line: int, *, nominal: int, ending: frozenset[int]) -> LineEdit:
    """The edit of a line in the syntax of its program."""
    kind = KlartextEdit if isinstance(text, KlartextText) else LineEdit
    return kind(text, line, nominal=nominal, ending=ending)
