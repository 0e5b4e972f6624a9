"""One block: its words with their values."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from gcode.dialects.fanuc.macro.expressions import MacroReader, Variables, is_null
from gcode.errors import ProgramError
from gcode.language.translate import number
from gcode.state.block_values import whole
from gcode.text.expressions import value_of

__all__ = ["MacroBlock", "read_words"]

#: they call a macro: letters behind them are its arguments, M too
_CALLS = (65, 66)


@dataclass
class MacroBlock:
    """A block with all its values; words whose variable is <null> are left out.

    Attributes
    ----------
    words : dict
        Lower-case letter -> value; of a letter that stands twice the last one.
    all_words : list of (str, float)
        Every word but G and M, in the order of the text; M too where it is a macro's argument.
    has_point : list of bool
        Which of them have a decimal point, or no plain number.
    g, m : list of float
    pointless : set of str
        Letters whose number has no decimal point; a comma for ``,R`` and ``,C``.
    corner : tuple of (str, float) or None
        ``,R`` or ``,C`` with its length.
    """

    words: dict[str, float] = field(default_factory=dict)
    all_words: list[tuple[str, float]] = field(default_factory=list)
    has_point: list[bool] = field(default_factory=list)
    g: list[float] = field(default_factory=list)
    m: list[int] = field(default_factory=list)
    pointless: set[str] = field(default_factory=set)
    corner: tuple[str, float] | None = None

    def add(self, letter: str, value: float, *, has_point: bool) -> None:
        """Add a word that is neither G nor M."""
        self.words[letter] = value
        self.all_words.append((letter, value))
        self.has_point.append(has_point)
        if has_point:
            self.pointless.discard(letter)
        else:
            self.pointless.add(letter)

    def has(self, *codes: float) -> bool:
        """Whether one of some G codes stands in the block."""
        return any(code in self.g for code in codes)

    def take(self, *codes: float) -> float | None:
        """Take out one of some G codes; None where there is none."""
        found = next((code for code in codes if code in self.g), None)
        if found is not None:
            self.g.remove(found)
        return found

    def pop(self, letters: str) -> dict[str, float]:
        """Take out words."""
        return {letter: self.words.pop(letter) for letter in letters if letter in self.words}

    def text(self) -> str:
        """The block in RS274/NGC."""
        codes = [f"g{code:g}" for code in self.g]
        words = [f"{letter}{number(value)}" for letter, value in self.words.items()]
        return "".join([*codes, *words, *(f"m{code}" for code in self.m)])


def read_words(text: str, variables: Variables) -> MacroBlock:
    """Read a block without label, comments and blanks, in lower case.

    Raises
    ------
    ProgramError
        For what is no word.
    """
    reader, block = MacroReader(text), MacroBlock()
    while reader.position < len(text):
        comma = reader.accept(",")
        letter = reader.peek()
        if comma and letter == "a":
            raise ProgramError(",A (the angle of a line) is not read", accepted=",R and ,C",
                               hint="post the program with the line's end")  # fmt: skip
        if not ("a" <= letter <= "z") or (comma and letter not in ("r", "c")):
            raise ProgramError(
                f"cannot read '{text[reader.position :]}'",
                accepted="letters with numbers or variables, ,R and ,C",
            )
        reader.position += 1
        start = reader.position
        value = value_of(reader.value(), variables)
        if is_null(value):
            continue
        if not math.isfinite(value):
            raise ProgramError(f"{letter.upper()} is not a finite number")
        literal = text[start : reader.position]
        if comma:
            block.corner = (letter, value)
            if literal.isdigit():
                block.pointless.add(",")
        elif letter == "g":
            block.g.append(round(value, 1))
        elif letter == "m" and not block.has(*_CALLS):
            block.m.append(whole(value, "M code"))
        elif letter != "n":
            block.add(letter, value, has_point=not literal.lstrip("+-").isdigit())
    return block
