"""Grbl 1.1: a part of RS274/NGC, and commands of its own that begin with a dollar sign."""

from __future__ import annotations

import re

from gcode.errors import ProgramError
from gcode.geometry.arc_tolerance import ARC_TOLERANCES
from gcode.language.dialect import Dialect
from gcode.language.translate import Translated
from gcode.text.lexer import compact, read_block

__all__ = ["Grbl"]

_G_CODES = frozenset((0, 1, 2, 3, 4, 10, 17, 18, 19, 20, 21, 28, 28.1, 30, 30.1, 38.2, 38.3, 38.4,
                      38.5, 40, 43.1, 49, 53, 54, 55, 56, 57, 58, 59, 61, 80, 90, 91, 91.1, 92,
                      92.1, 93, 94))  # fmt: skip
_M_CODES = frozenset((0, 2, 3, 4, 5, 7, 8, 9, 30))
_LETTERS = frozenset("fijklnprstxyz")
_EXPRESSION = re.compile(r"[#\[]")
#: commands to the firmware: settings, homing, start-up lines; none of them cuts
_COMMAND = re.compile(r"\$(?:[$#GINXHCL]|N\d|RST|SLP|\d+=).*", re.IGNORECASE)


class GrblReader(Translated):
    """Refuses what Grbl refuses; the rest are blocks of RS274/NGC."""

    def obey(self, text: str) -> None:
        """Obey one line."""
        content = re.sub(r"\([^)]*\)|;.*", "", text).strip()
        if content in ("", "%"):
            return
        if content.startswith("$"):
            self._command(content)
            return
        block = read_block(compact(content))
        if block.control is not None or _EXPRESSION.search(content):
            raise ProgramError("parameters, expressions and O-words are no words of Grbl",
                               accepted="letters with numbers")  # fmt: skip
        self._check("G", block.g_codes, _G_CODES)
        self._check("M", block.m_codes, _M_CODES)
        for letter in sorted(block.words.keys() - _LETTERS):
            raise ProgramError(f"{letter.upper()} is no word of Grbl",
                               accepted=" ".join(sorted(_LETTERS)).upper())  # fmt: skip
        self.execute(content)

    def _command(self, content: str) -> None:
        if not _COMMAND.fullmatch(content):
            raise ProgramError(f"'{content}' is not read", accepted="$H, $X, settings; no jogging")
        self.controller.note(content.split("=")[0], "command to the firmware")

    @staticmethod
    def _check(letter: str, codes: list[float], known: frozenset[float]) -> None:
        for code in codes:
            if round(code, 1) not in known:
                raise ProgramError(
                    f"{letter}{code:g} is no word of Grbl",
                    accepted=" ".join(f"{letter}{k:g}" for k in sorted(known)),
                )


class Grbl(Dialect):
    """Grbl, the firmware of small routers."""

    name = "grbl"
    title = "Grbl 1.1"
    source = "Grbl 1.1 documentation: Commands (supported G-codes), Settings ($12 arc tolerance)"
    marks = re.compile(r"^[ \t]*\$(?:[HXC]|\d+=)", re.MULTILINE)
    rank = 40
    reader = GrblReader
    is_rs274 = True
    arcs = ARC_TOLERANCES["grbl"]
