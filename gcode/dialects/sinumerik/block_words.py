"""Words of a SINUMERIK block: ``X=R1+5``, ``Y=IC(10)``, ``CR=7``; read and written as RS274/NGC."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from gcode.dialects.sinumerik.codes import ACCEPTED_G, CODES, ISO_G, M_CODES, SAME, STOPS, TURNING_G
from gcode.dialects.sinumerik.values.expressions import Worked, expression_at
from gcode.errors import ProgramError
from gcode.language.translate import number
from gcode.motion import frames
from gcode.text.lexer import read_block

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["ADDRESSES", "BlockWords", "Words", "split_arguments"]

#: letter or address, and its number
Words = list[tuple[str, float]]

#: addresses of more than one letter
ADDRESSES = ("CR", "TURN", "AP", "RP", "RND", "RNDM", "CHF", "CHR", "FRC", "FRCM", "RPL", "ADIS",
             "DISC", "DISR", "DISCL", "FAD", "I1", "J1", "K1", "AR")  # fmt: skip
_NUMBER = re.compile(r"\s*([+-]?\s*(?:\d+\.?\d*|\.\d+))")
_WORD = re.compile(
    r"\s*(CR|TURN|AP|AR|RPL|RP|RNDM?|CHF|CHR|FRCM?|ADIS|DISCL|DISR|DISC|FAD|[IJK]1(?=\s*=)|H\d+(?=\s*=)|[A-Z])\s*(=?)",
    re.IGNORECASE,
)
_OWN = re.compile(r"\s*(AC|IC|DC|ACP|ACN)\s*\(", re.IGNORECASE)
_CLOSED = re.compile(r"\s*\)")


def split_arguments(text: str) -> list[str]:
    """Arguments between commas that stand in no bracket."""
    pieces, depth = [""], 0
    for letter in text:
        depth += (letter in "([") - (letter in ")]")
        if letter == "," and depth == 0:
            pieces.append("")
        else:
            pieces[-1] += letter
    return pieces


class _Written(NamedTuple):
    """A word as it stands: its number, or the expression that gives it, and AC, IC or nothing."""

    letter: str
    value: float = 0.0
    worked: Worked | None = None
    mode: str = ""


@lru_cache(maxsize=4096)
def _written(content: str) -> tuple[_Written, ...]:
    """The words of a block, read once however often it runs."""
    words, position = [], 0
    while content[position:].strip():
        match = _WORD.match(content, position)
        letter = match[1].upper() if match else ""
        if match is None or (letter in ADDRESSES and not match[2]):
            raise _unknown(content[position:].strip())
        word, position = _word(content, match, letter)
        words.append(word)
    return tuple(words)


def _word(content: str, match: re.Match, letter: str) -> tuple[_Written, int]:
    if not match[2]:
        found = _NUMBER.match(content, match.end())
        if found is None:
            raise _unknown(content[match.start() :].strip())
        return _Written(letter, float(re.sub(r"\s", "", found[1]))), found.end()
    own = _OWN.match(content, match.end())
    worked, stop = expression_at(content, match.end() if own is None else own.end())
    if own is None:
        return _Written(letter, worked=worked), stop
    closing, mode = _CLOSED.match(content, stop), own[1].upper()
    if closing is None:
        raise ProgramError(f"'{mode}(' is not closed")
    if mode not in ("AC", "IC"):  # which way round an axis turns, to an absolute place
        if letter not in ("A", "B", "C"):
            raise ProgramError(f"{mode} with {letter}", accepted="rotary axes A B C")
        mode = "AC"
    return _Written(letter, worked=worked, mode=mode), closing.end()


class BlockWords:
    """Words of a program's blocks.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader = reader

    # reading

    def read(self, content: str) -> Words:
        """Words with their values; those of AC and IC as the mode of the block has them."""
        words: Words = []
        for word in _written(content):
            value = word.value
            if word.worked is not None:
                value = self.reader.variables.worked_out(word.worked, content)
            if word.mode:
                value = self._as_mode(word.letter, value, word.mode, words)
            words.append((word.letter, value))
        return words

    def _as_mode(self, letter: str, value: float, kind: str, words: Words) -> float:
        """AC and IC: the number that says the same in the mode of the block."""
        here = self.reader.here()
        if letter in ("I", "J", "K"):
            return value - here["IJK".index(letter)] if kind == "AC" else value
        absolute = self.reader.is_absolute([v for name, v in words if name == "G"])
        if letter in ("AP", "RP"):
            return self.reader.poles.in_mode(letter, value, kind, absolute=absolute)
        if letter not in ("X", "Y", "Z", "A", "B", "C"):
            raise ProgramError(f"{kind} with {letter}", accepted="X Y Z A B C I J K AP")
        place = here["XYZABC".index(letter)]
        if absolute:
            return value if kind == "AC" else value + place
        return value - place if kind == "AC" else value

    # writing

    def text(self, words: Words) -> str:
        """The block in RS274/NGC."""
        text, controller = [], self.reader.controller
        for letter, value in words:
            if letter == "G":
                text.append(self._code(value))
            elif letter == "M":
                if value not in STOPS and value != 6:
                    text.append(self._m_code(value))
            elif letter == "CR":
                text.append(f"r{number(value)}")
            elif letter == "TURN":
                text.append(f"p{_further_turns(value) + 1}")
            elif letter in ("T", "D", "N"):
                continue
            elif letter in "XYZABCIJKFS":
                text.append(f"{letter.lower()}{number(value)}")
            elif letter[0] == "H":  # H5, and H41=5
                own = f"H{value:g}" if letter == "H" else f"{letter}={value:g}"
                controller.note(own, "auxiliary function")
            else:
                raise _unknown(f"{letter}{value:g}")
        block = "".join(text)
        if block and controller.motion in (None, "G80") and not read_block(block).g_codes:
            block = "g1" + block if any(w[0] in "XYZABC" for w in words) else block
        return block

    def _m_code(self, value: float) -> str:
        if value in self.reader.options.control.ignore_m:
            self.reader.controller.note(
                f"M{value:g}", "machine builder's code, ignored by ignore_m"
            )
            return ""
        if value not in M_CODES:
            raise self.reader.unknown(m_code=int(value))
        if value >= 40.0:
            self.reader.controller.note(f"M{value:g}", "gear stage or mode of the spindle")
            return ""
        return f"m{value:g}"

    def _code(self, value: float) -> str:
        controller = self.reader.controller
        if 505.0 <= value <= 599.0:
            frames.select_system(controller, f"G54.1 P{value - 500.0:.0f}")
            return ""
        if value == 500.0:
            frames.select_system(controller, "G54.1 P1")  # no code of this control sets it
            return ""
        if value in CODES and value != 500.0:
            return CODES[value]
        if value not in SAME:
            hint = "FANUC's, or of this control's ISO dialect (G291)" if value in ISO_G else None
            hint = "of turning programs" if value in TURNING_G else hint
            raise ProgramError(f"Sinumerik G{value:g} is not read", accepted=ACCEPTED_G, hint=hint)
        if value in (18.0, 19.0):
            controller.note("G18, G19", "the tool's length stays along Z, as with setting data "
                            "$SC_TOOL_LENGTH_CONST = 17")  # fmt: skip
        return f"g{value:.0f}"


def _further_turns(value: float) -> int:
    """TURN: full turns before the arc to the end, which is a full one where the end is the start.

    Autodesk's post "Matsuura - Multi - 840Di" (conturo-prototyping/cnc-posts on GitHub) counts
    them the same way: its full circles have one turn less than they go round.
    """
    if not (value.is_integer() and 0.0 <= value <= 999.0):
        raise ProgramError(
            f"TURN={value:g} is no number of turns",
            accepted="0 to 999, the full turns before the arc to the end",
        )
    return int(value)


def _unknown(rest: str) -> ProgramError:
    word = re.match(r"\w+|.", rest)[0]
    return ProgramError(
        f"Sinumerik word '{word}' is not read",
        accepted="G M T D F S X Y Z A B C I J K CR= TURN= AP= RP= with numbers or expressions",
        hint="a comment begins with ;" if word == "(" else None,
    )
