"""Words of a Klartext motion line: ``L X+10 IY-5 RL F200 M3``."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping

from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.errors import ProgramError

__all__ = ["Words", "motion_words", "refuse_foreign"]

#: word -> its number, or the sign of DR; None for words that stand alone
Words = Mapping[str, "float | str | None"]

_WORD = re.compile(
    r"(I?[XYZABC]|I?P[RA]|DR|R[0LR](?![\d.])|LEN|MB|F\s*(?:MAX|AUTO)|F[ZU]|F|S|M|R|[A-Z]+)\s*"
    rf"({NUMBER}|MAX)?\s*([+-])?(?=\s|$|[A-Z])"
)
_LETTERS = frozenset(("X", "Y", "Z", "A", "B", "C", "IX", "IY", "IZ", "IA", "IB", "IC", "F", "R",
                      "S", "PR", "PA", "IPR", "IPA"))  # fmt: skip
_POLAR = ("PR", "PA", "IPR", "IPA")
#: first word of a line -> words that say nothing in it
_FOREIGN = {"L": ("R", "DR", *_POLAR), "LP": ("R", "DR"), "CP": ("R",), "C": ("R", *_POLAR),
            "CR": _POLAR, "CT": ("R", *_POLAR)}  # fmt: skip
_HINTS = {letter: f"feed per {what}: post the feed per minute"
          for letter, what in (("FZ", "tooth"), ("FU", "revolution"))}  # fmt: skip
_ACCEPTED = "X Y Z IX IY IZ PR PA IPA R DR RL RR R0 F FMAX M"


def motion_words(
    content: str, number: Callable[[str], float]
) -> tuple[dict[str, float | str | None], list[int]]:
    """Words of a motion line, and its M codes.

    Parameters
    ----------
    content : str
        The line behind its first word, in upper case.
    number : callable
        Value of a number or Q parameter.

    Raises
    ------
    ProgramError
        For what is no word of a motion line, and words that stand twice.
    """
    words: dict[str, float | str | None] = {}
    codes, position = [], 0
    for match in _WORD.finditer(content):
        if content[position : match.start()].strip():
            break
        position = match.end()
        letter, value, sign = re.sub(r"\s", "", match[1]), match[2], match[3]
        if letter == "M":  # early controls write an M without a number
            codes += [] if value is None else [_m_code(value, number)]
        elif letter == "DR" and (sign or value is None):
            words["DR"] = sign
        elif letter == "MB":
            words["MB"] = None if value in (None, "MAX") else number(value)
        elif letter in ("R0", "RL", "RR", "FMAX", "FAUTO") and value is None:
            words[letter] = None
        elif letter in ("R", "F") and value is None:  # early controls: as before
            continue
        elif value in (None, "MAX") or letter not in _LETTERS:
            raise ProgramError(f"Klartext word '{letter}' is not read in a motion line",
                               accepted=_ACCEPTED, hint=_HINTS.get(letter))  # fmt: skip
        elif letter in words:
            raise ProgramError(f"two {letter} words in one line")
        else:
            words[letter] = number(value)
    if content[position:].strip():
        raise ProgramError(f"cannot read '{content[position:].strip()}'", accepted=_ACCEPTED)
    return words, codes


def refuse_foreign(head: str, words: Words) -> None:
    """Refuse words of other lines, which would be left out without a word."""
    for letter in words.keys() & set(_FOREIGN[head]):
        raise ProgramError(f"Klartext word {letter} beside {head} is not read", hint="remove it")


def _m_code(value: str, number: Callable[[str], float]) -> int:
    said = math.nan if value == "MAX" else number(value)
    if not math.isfinite(said):
        raise ProgramError(f"M{value} is no M function", accepted="M with a number")
    return int(said)
