"""One line of a program while its block is corrected and further blocks are put behind it."""

from __future__ import annotations

from dataclasses import dataclass

from gcode import Word
from vmach.program_text.block_text import BlockText, split_word

__all__ = ["AS_PROGRAMMED", "SAME", "UNKNOWN", "Block", "LineEdit"]

#: number of a word that stays as it is
SAME = "same"
#: G code in force as the program has it; unknown, because a block may be skipped
AS_PROGRAMMED, UNKNOWN = -1, -2
_POSITION = frozenset("XYZIJKR")


@dataclass(frozen=True)
class Block:
    """A block to be inserted: its G code where it has to be said, and numbers by letter."""

    code: int | None
    words: dict[str, str]


class LineEdit:
    """Edits of one line and the blocks inserted after it.

    Parameters
    ----------
    text : BlockText
    line : int
    motion : int
        G code in force before the line, `AS_PROGRAMMED` or `UNKNOWN`.
    nominal : int
        G code of the line's own motion.
    ending : frozenset of int
        M codes that act when a block's motion has ended.

    Attributes
    ----------
    own_done : bool
        The line's own block is written; what follows is inserted.
    """

    def __init__(
        self, text: BlockText, line: int, motion: int, *, nominal: int, ending: frozenset[int]
    ) -> None:
        self.text, self.line, self.motion, self.nominal = text, line, motion, nominal
        self.words, self.ending = text.words(line), ending
        self.position = {w.letter: w for w in self.words if w.letter in _POSITION | {"P", "F"}}
        self.own_done = False
        self.changes: dict[tuple[int, int], str] = {}
        self.blocks: list[Block] = []

    @property
    def may_be_skipped(self) -> bool:
        """The line begins with a slash."""
        return self.text.may_be_skipped(self.line)

    @property
    def has_radius(self) -> bool:
        """The user gives the arc by its radius."""
        return "R" in self.position

    def own_word(self, letter: str) -> Word | None:
        """A word of the line's own block, as long as that is not written."""
        return None if self.own_done else self.position.get(letter)

    def number_of(self, word: Word | None) -> str | None:
        """The number that a word has in the text."""
        return None if word is None else split_word(word.text)[1]

    def keep(self, code: int) -> None:
        """Leave the line's own block as it is."""
        self.own_done, self.motion = True, code

    def write(self, code: int, numbers: dict[str, str]) -> int:
        """Write one motion with the given numbers by letter.

        Returns
        -------
        int
            How many blocks it took beyond the line's own.
        """
        if self.own_done:
            self.blocks.append(Block(self._said_code(code), numbers))
            self.motion = code
            return 1
        self._change_own(code, numbers)
        self.own_done, self.motion = True, code
        return 0

    def _said_code(self, code: int) -> int | None:
        return None if code == self.motion else code

    def _change_own(self, code: int, numbers: dict[str, str]) -> None:
        """Replace, remove and add words of the line's own block."""
        added = []
        for letter, number in numbers.items():
            if letter not in self.position:
                added.append(self.text.word(letter, number))
            elif number != SAME:
                word = self.position[letter]
                self.changes[word.span] = self.text.word(letter, number, word)
        for letter in self._gone(numbers):
            self._remove(self.position[letter])
        said = self.text.motion_word(self.line)
        in_force = self.nominal if self.motion == AS_PROGRAMMED else self.motion
        if said is not None:
            if self._differs(said, code):
                self.changes[said.span] = self._motion(code, said)
        elif in_force != code:
            added.insert(0, self.text.motion(code))
        if added:
            self._add(added)

    def _differs(self, said: Word, code: int) -> bool:
        return said.value != code

    def _motion(self, code: int, said: Word) -> str:
        return self.text.motion(code, said)

    def _gone(self, numbers: dict[str, str]) -> list[str]:
        """Letters of the own block that the new motion does not have."""
        possible = "IJKRP" if self.nominal > 1 else "IJKR"
        return [k for k in possible if k in self.position and k not in numbers]

    def _remove(self, word: Word) -> None:
        """Take a word out with the blank before it."""
        start, stop = word.span
        while self.text.source.data[start - 1 : start] in (b" ", b"\t"):
            start -= 1
        following = self.text.source.data[stop : stop + 1]
        at_start = start == int(self.text.source.line_starts[self.line - 1])
        keep_blank = at_start or following not in (b" ", b"\t", b"\r", b"\n", b"")
        self.changes[(word.span[0] if keep_blank else start), stop] = ""

    def _add(self, added: list[str]) -> None:
        """Put words behind the last one that has to do with the motion."""
        said = self.text.motion_word(self.line)
        behind = [w for w in self.words if w.letter in _POSITION or w is said or w.letter == "G"]
        anchor = behind[-1] if behind else self.words[-1]
        gap = self.text.style.between
        at = anchor.span[1]
        self.changes[at, at] = gap + gap.join(added)

    def edits(self) -> dict[tuple[int, int], str]:
        """Replacements for `gcode.Source.rewritten`."""
        tail: list[str] = []
        if self.blocks:
            for word in self.words:
                if word.letter == "M" and word.value in self.ending:
                    tail.append(word.text)
                    self._remove(word)
        lines = [self._block(b, tail if b is self.blocks[-1] else []) for b in self.blocks]
        edits = dict(self.changes)
        if lines:
            text, source = self.text.source.lines[self.line - 1], self.text.source
            at = int(source.line_starts[self.line - 1]) + len(text)
            ending = "\r\n" if b"\r\n" in source.data[: at + 2] else "\n"
            added = edits.get((at, at), "")
            edits[at, at] = added + "".join(ending + line for line in lines)
        return edits

    def _block(self, block: Block, tail: list[str]) -> str:
        words = [self.text.word(letter, number) for letter, number in block.words.items()]
        text = self.text.block(block.code, [*words, *tail])
        if self.text.labels is not None:
            own = self.text.label_of(self.line)
            label = self.text.labels.after(int(own.value) if own else None)
            text = text if label is None else self.text.labelled(text, label)
        return ("/" if self.may_be_skipped else "") + text
