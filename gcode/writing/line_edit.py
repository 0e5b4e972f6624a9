"""What motions make of one line's text: the first goes into its own block, the others behind it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from gcode.text.source import Word
from gcode.writing.block_text import BlockText, Labels, split_word

__all__ = ["AS_PROGRAMMED", "SAME", "UNKNOWN", "BlockMotion", "LineEdit"]

#: number of a word that stays as it is
SAME = "same"
#: G code in force as the program has it; unknown, because a block may be skipped
AS_PROGRAMMED, UNKNOWN = -1, -2
_POSITION = frozenset("XYZIJKR")


@dataclass(frozen=True)
class BlockMotion:
    """A motion to be written.

    Attributes
    ----------
    code : int
        0 to 3 for G0 to G3.
    numbers : mapping of str to str, optional
        Of its words by letter; none where the user's block stays as it is.
    """

    code: int
    numbers: Mapping[str, str] | None


class LineEdit:
    """A line whose motion is written anew.

    Parameters
    ----------
    text : BlockText
    line : int
    nominal : int
        G code of the line's own motion.
    ending : frozenset of int
        M codes that act when a block's motion has ended.

    Attributes
    ----------
    own : dict of str to Word
        The words of the line's own block that belong to its motion, by letter.
    """

    #: forms of words whose numbers are replaced as they stand; a subclass says its own
    word_forms: tuple[str, ...] = ("letters", "equal signs")

    def __init__(self, text: BlockText, line: int, *, nominal: int, ending: frozenset[int]) -> None:
        self.text, self.line, self.nominal, self.ending = text, line, nominal, ending
        self.words = text.words(line)
        self.own = {w.letter: w for w in self.words if w.letter in _POSITION | {"P", "F"}}

    @property
    def may_be_skipped(self) -> bool:
        """The line begins with a slash."""
        return self.text.may_be_skipped(self.line)

    @property
    def has_radius(self) -> bool:
        """The user gives the arc by its radius."""
        return "R" in self.own

    def number_of(self, word: Word | None) -> str | None:
        """The number that a word has in the text."""
        return None if word is None else split_word(word.text)[1]

    def extra_blocks(self, motion: BlockMotion, *, is_own: bool) -> int:
        """How many blocks a motion takes beyond the line's own, for that one or behind it."""
        return 0 if is_own else 1

    def changes(
        self, motions: Sequence[BlockMotion], in_force: int, labels: Labels | None
    ) -> dict[tuple[int, int], str]:
        """Replacements for `gcode.Source.rewritten`.

        Parameters
        ----------
        motions : sequence of BlockMotion
            At least one.
        in_force : int
            G code in force before the line, `AS_PROGRAMMED` or `UNKNOWN`.
        labels : Labels or None
            Gives the inserted blocks their numbers.
        """
        own, *others = motions
        changes = {} if own.numbers is None else self._own_changes(own, in_force)
        if not others:
            return changes
        blocks, code = [], own.code
        for motion in others:
            blocks += self._blocks_behind(motion, code)
            code = motion.code
        last = [w for w in self.words if w.letter == "M" and w.value in self.ending]
        for word in last:
            changes |= self._removal(word)
        blocks[-1] += [word.text for word in last]
        at = self._start + len(self.text.source.line(self.line))
        ending = self._line_end(at + 2)
        added = "".join(ending + self._inserted(words, labels) for words in blocks)
        return changes | {(at, at): changes.get((at, at), "") + added}

    @property
    def _start(self) -> int:
        return int(self.text.source.line_starts[self.line - 1])

    def _line_end(self, before: int) -> str:
        return "\r\n" if self.text.source.has_cr_lf(before) else "\n"

    def _own_changes(self, motion: BlockMotion, in_force: int) -> dict[tuple[int, int], str]:
        """Replace, remove and add words of the line's own block."""
        changes, added, numbers = {}, [], self._numbers(motion)
        for letter, number in numbers.items():
            if letter not in self.own:
                added.append(self.text.word(letter, number))
            elif number != SAME:
                word = self.own[letter]
                changes[word.span] = self.text.word(letter, number, word)
        for letter in self._leaving():
            if letter in self.own and letter not in numbers:
                changes |= self._removal(self.own[letter])
        said = self.text.motion_word(self.line)
        if said is not None:
            head = self._head(motion, said)
            if head != said.text:
                changes[said.span] = head
        elif motion.code != (self.nominal if in_force == AS_PROGRAMMED else in_force):
            added.insert(0, self.text.motion(motion.code))
        return changes | self._addition(added)

    def _numbers(self, motion: BlockMotion) -> Mapping[str, str]:
        """Numbers of the words in the motion's own block, by letter."""
        return motion.numbers

    def _leaving(self) -> Sequence[str]:
        """Letters that the block loses where the new motion does not have them."""
        return "IJKRP" if self.nominal > 1 else "IJKR"

    def _head(self, motion: BlockMotion, said: Word) -> str:
        """The word that says the motion, in the place of the user's."""
        return said.text if said.value == motion.code else self.text.motion(motion.code, said)

    def _removal(self, word: Word) -> dict[tuple[int, int], str]:
        """Take a word out with the blank before it."""
        data, (start, stop) = self.text.source.data, word.span
        while data[start - 1 : start] in (b" ", b"\t"):
            start -= 1
        following = data[stop : stop + 1]
        keep_blank = start == self._start or following not in (b" ", b"\t", b"\r", b"\n", b"")
        return {(word.span[0] if keep_blank else start, stop): ""}

    def _addition(self, added: Sequence[str]) -> dict[tuple[int, int], str]:
        """Put words behind the last one that has to do with the motion."""
        if not added:
            return {}
        said = self.text.motion_word(self.line)
        behind = [w for w in self.words if w.letter in _POSITION or w is said or w.letter == "G"]
        at = (behind or self.words)[-1].span[1]
        gap = self.text.style.between
        return {(at, at): gap + gap.join(added)}

    def _blocks_behind(self, motion: BlockMotion, in_force: int) -> list[list[str]]:
        """The words of the blocks that a motion takes behind the line."""
        holds = self.text.is_modal and motion.code == in_force
        said = [] if holds else [self.text.motion(motion.code)]
        return [[*said, *self._words(motion)]]

    def _words(self, motion: BlockMotion) -> list[str]:
        return [self.text.word(k, number) for k, number in self._numbers(motion).items()]

    def _inserted(self, words: Sequence[str], labels: Labels | None) -> str:
        """A new block, numbered and skipped as the line itself is."""
        block = self.text.block(words)
        if labels is not None:
            own = self.text.label_of(self.line)
            label = labels.after(int(own.value) if own else None)
            block = block if label is None else self.text.labelled(block, label)
        return ("/" if self.may_be_skipped else "") + block
