"""How a program in letters and numbers writes its blocks: words, numbers, labels."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from gcode.text.source import Source, Word
from gcode.writing.plain_blocks import PlainBlocks

__all__ = ["BlockText", "Labels", "Style", "split_word"]

_NUMBER = re.compile(r"(?:[+-][ \t]*)?(?:\d[\d \t]*\.?[\d \t]*|\.[ \t]*\d[\d \t]*)$")
_COMMENT, _LABEL_LETTER = re.compile(rb"\([^)\n]*\)?|;[^\n]*"), re.compile(rb"[Nn]")
_HIGHEST_LABEL = 99999  #: of Fanuc and LinuxCNC: five digits
#: lines from which the style is taken
_SAMPLE = 400


@dataclass(frozen=True)
class Style:
    """Habits of a program.

    Attributes
    ----------
    plus : bool
        Positive numbers have a sign.
    bare_point : bool
        ``.5`` rather than ``0.5``.
    gap, between : str
        Blanks between letter and number, and between words.
    fill : int
        Fewest decimals.
    lower, padded : bool
        Lower case; ``G01`` rather than ``G1``.
    closing : str
        What ends every block, as the ``;`` of some controls.
    """

    plus: bool = False
    bare_point: bool = False
    gap: str = ""
    between: str = " "
    fill: int = 0
    lower: bool = False
    padded: bool = False
    closing: str = ""


class BlockText:
    """Blocks of letters and numbers, as RS274/NGC and Fanuc write them.

    Parameters
    ----------
    source : Source
    """

    #: how the words of most lines stand, so that compiled code finds them: ``letters`` with
    #: numbers, ``equal signs`` between some of them, ``klartext``; a subclass says its own
    word_form = "letters"
    #: the centre of an arc is said in absolute numbers whatever the modes are
    absolute_centres = False
    #: a motion word holds until another one comes
    is_modal = True
    #: all blocks are numbered anew at the end
    renumbers = False
    fewest_decimals = 0
    plain: type[PlainBlocks] | None = None  #: how other lines are written out

    def __init__(self, source: Source) -> None:
        self.source = source
        self._words: dict[int, tuple[Word, ...]] = {}

    @property
    def own_word_form(self) -> str:
        """`word_form`, or nothing where a subclass does not say it."""
        return vars(type(self)).get("word_form", "")

    def words(self, line: int) -> tuple[Word, ...]:
        """Words of a line."""
        if line not in self._words:
            self._words[line] = self._read(line)
        return self._words[line]

    def _read(self, line: int) -> tuple[Word, ...]:
        return self.source.words(line)

    def motion_word(self, line: int) -> Word | None:
        """The word that says G0, G1, G2 or G3."""
        found = (w for w in self.words(line)
                 if w.letter == "G" and w.value in (0.0, 1.0, 2.0, 3.0))  # fmt: skip
        return next(found, None)

    def may_be_skipped(self, line: int) -> bool:
        """Whether the line begins with a slash."""
        return self.source.line(line).lstrip().startswith("/")

    def is_incremental(self, word: Word) -> bool:
        """Whether the word itself says that it is a distance."""
        return False

    @cached_property
    def style(self) -> Style:
        """Habits of the program, as most of its words have it."""
        words = [w for line in range(1, min(len(self.source), _SAMPLE) + 1)
                 for w in self.words(line) if w.value is not None]  # fmt: skip
        axes = [w for w in words if w.letter in "XYZ"]
        numbers = [split_word(w.text)[1] for w in axes]
        positive = [n for n, w in zip(numbers, axes, strict=True) if w.value > 0]
        small = [n.lstrip("+-") for n, w in zip(numbers, axes, strict=True) if 0 < abs(w.value) < 1]
        pointed = [len(n) - n.index(".") - 1 for n in numbers if "." in n]
        codes = [w.text for w in words if w.letter == "G" and w.value in (0, 1, 2, 3)]
        lines = map(self.source.line, range(1, min(len(self.source), _SAMPLE) + 1))
        ends = [s.rstrip().endswith(";") for s in lines if s.strip(" \t%")]
        return Style(
            plus=_mostly(n.startswith("+") for n in positive),
            bare_point=_mostly(n.startswith(".") for n in small),
            gap=" " if _mostly(len(split_word(w.text)[0].rstrip()) < len(split_word(w.text)[0])
                               for w in axes) else "",
            between=" " if _mostly(self._blanks()) else "",
            fill=max(min(pointed, default=0), self.fewest_decimals),
            lower=_mostly(w.text[0].islower() for w in axes),
            padded=_mostly(len(text) > 2 for text in codes),
            closing=";" if ends and all(ends) else "",
        )  # fmt: skip

    def _blanks(self) -> list[bool]:
        """Whether there are blanks between neighbouring words."""
        found = []
        for line in range(1, min(len(self.source), _SAMPLE) + 1):
            words = self.words(line)
            found += [b.span[0] > a.span[1] for a, b in pairwise(words)]
        return found or [True]

    def number(self, value: float, decimals: int, like: str | None = None) -> str:
        """A number as the user writes numbers; `like` is the one that it replaces."""
        style, shown = self.style, f"{abs(value):.{decimals}f}"
        whole, fraction = shown.split(".")
        fill, plus, bare = style.fill, style.plus, style.bare_point
        if like is not None:
            bare = like.lstrip("+-").startswith(".") or (bare and not like.startswith("0"))
            plus = like.startswith("+") or (plus and like.startswith("-"))
            fill = len(like) - like.index(".") - 1 if "." in like else 0
        fill = max(min(fill, decimals), self.fewest_decimals)
        fraction = fraction.rstrip("0").ljust(fill, "0")
        sign = "" if float(shown) == 0.0 and not plus else "-" if value < 0 else "+" * plus
        sign = "+" if float(shown) == 0.0 and plus else sign
        return sign + ("" if bare and whole == "0" and fraction else whole) + "." + fraction

    def word(self, letter: str, number: str, like: Word | None = None) -> str:
        """A word with a number; the letter and what follows it as in the word it replaces."""
        if like is not None and _NUMBER.search(like.text):
            return split_word(like.text)[0] + number
        text = letter + self.style.gap + number
        return text.lower() if self.style.lower else text

    def motion(self, code: int, like: Word | None = None) -> str:
        """G0, G1, G2 or G3."""
        padded = self.style.padded if like is None else len(like.text) > 2
        letter = like.text[0] if like is not None else "g" if self.style.lower else "G"
        return f"{letter}{code:02d}" if padded else f"{letter}{code}"

    def block(self, words: Sequence[str]) -> str:
        """An inserted block without its label."""
        return self.style.between.join(words) + self.style.closing

    def label_of(self, line: int) -> Word | None:
        """The block number of a line."""
        return next((w for w in self.words(line) if w.letter == "N" and w.value is not None), None)

    def labelled(self, block: str, label: str) -> str:
        """A block with its number before it."""
        letter = "n" if self.style.lower else "N"
        return f"{letter}{label}{self.style.between}{block}"

    def free_labels(self) -> Labels | None:
        """Block numbers that inserted blocks may get, where the program numbers its blocks."""
        return Labels(*self._numbering) if self._numbering else None

    @cached_property
    def _numbering(self) -> tuple[set[int], int] | None:
        """Block numbers that are taken, and with how many digits they are written."""
        if self._has_few_labels:
            return None
        numbered = [self.label_of(k) for k in range(1, len(self.source) + 1) if self.words(k)]
        blocks = [w for w in numbered if w is not None]
        if len(blocks) < 2 or len(blocks) < 0.9 * len(numbered):
            return None
        width = len(blocks[0].text) - 1 if blocks[0].text[1:].startswith("0") else 0
        return {int(w.value) for w in blocks}, width

    @property
    def _has_few_labels(self) -> bool:
        """Whether the letter N stands outside comments less than twice."""
        return len(_LABEL_LETTER.findall(_COMMENT.sub(b"", self.source.data))) < 2

    def finish(self, text: bytes) -> bytes:
        """Last touch to the whole text."""
        return text


class Labels:
    """Block numbers that are still free."""

    def __init__(self, used: set[int], width: int) -> None:
        self.given, self.used, self.width = sorted(used), set(used), width
        self.next = max(used) + 1

    def after(self, label: int | None) -> str | None:
        """A number between `label` and the one that follows it, or above all; None for none."""
        number = None if label is None else self._between(label)
        if number is None:
            while self.next in self.used:
                self.next += 1
            number = self.next
        if number > _HIGHEST_LABEL:
            return None
        self.used.add(number)
        return f"{number:0{self.width}d}"

    def _between(self, label: int) -> int | None:
        above = bisect_right(self.given, label)
        stop = self.given[above] if above < len(self.given) else _HIGHEST_LABEL + 1
        return next((k for k in range(label + 1, stop) if k not in self.used), None)


def split_word(text: str) -> tuple[str, str]:
    """Letter with what follows it, and number without blanks."""
    found = _NUMBER.search(text)
    if found is None:
        return text, ""
    return text[: found.start()], re.sub(r"\s", "", found.group())


def _mostly(flags: object) -> bool:
    counts = Counter(bool(flag) for flag in flags)
    return counts[True] > counts[False]
