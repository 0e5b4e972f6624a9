"""Sinumerik: G code blocks with plain motion; variables, cycles and frames are refused."""

from __future__ import annotations

import re

from gcode.errors import ProgramError
from gcode.geometry.arc_tolerance import ARC_TOLERANCES
from gcode.language.dialect import Dialect
from gcode.language.options import RunOptions
from gcode.language.translate import Translated, number
from gcode.state.controller import Controller
from gcode.text.lexer import read_block
from gcode.text.source import Word
from gcode.writing.block_text import BlockText

__all__ = ["Sinumerik"]

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)"
_WORD = re.compile(rf"(CR|TURN|[A-Z])\s*(=?)\s*({_NUMBER})(?![\d.]*\s*=)", re.IGNORECASE)
#: Codes of this control -> RS274/NGC, times ten; absent ones keep their meaning.
_CODES = {70: "g20", 700: "g20", 71: "g21", 710: "g21", 60: "g61.1", 64: "g64", 601: "", 602: "",
          450: "", 451: ""}  # fmt: skip
_SAME = frozenset((0, 1, 2, 3, 17, 18, 19, 40, 53, 54, 55, 56, 57, 90, 91, 94, 95))
_MOTION = frozenset((0, 1, 2, 3))
_STOPS = frozenset((0, 1, 2, 30, 17))
#: for the screen, or how the control follows the path
_NO_MOTION = re.compile(
    r"\b(?:(WORKPIECE|MSG|CYCLE832)\s*\((?:\"[^\"]*\"|[^)\"])*\)"
    r"|(STOPRE|FFWON|FFWOF|SOFT|BRISK|COMPOF|COMPON|COMPCURV|COMPCAD|CFTCP|CFC|CFIN)\b)",
    re.IGNORECASE,
)
_SUPPRESSED = re.compile(r"\bSUPA\b", re.IGNORECASE)  #: every frame, for one block


class SinumerikReader(Translated):
    """Runs a Sinumerik program; every line becomes blocks of RS274/NGC."""

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        super().__init__(controller, lines, options)
        self.edge = 1  #: D: cutting edge, 0 takes the tool offset off
        self.execute("g21g90g17g40")

    def obey(self, text: str) -> None:
        """Obey one line."""
        content = re.sub(r";.*", "", text).strip()
        if not content or content.startswith("%"):
            return
        content = re.sub(r"^/?\s*(?:[N:]\d+\s*)?", "", content, flags=re.IGNORECASE)
        content = _SUPPRESSED.sub("G53", _NO_MOTION.sub(self._noted, content))
        words = self._words(content)
        g_codes = [value for letter, value in words if letter == "G"]
        if 4.0 in g_codes:
            self._dwell(words)
            return
        self._tool(words)
        self.execute(self._block(words, g_codes))
        stop = [v for letter, v in words if letter == "M" and v in _STOPS]
        if stop:
            self.execute("m30" if stop[0] in (2, 17, 30) else f"m{stop[0]:.0f}")

    def _noted(self, found: re.Match) -> str:
        self.controller.note((found[1] or found[2]).upper(), "screen, or following of the path")
        return ""

    def _words(self, content: str) -> list[tuple[str, float]]:
        words, position = [], 0
        for match in _WORD.finditer(content):
            if content[position : match.start()].strip():
                break
            letter = match[1].upper()
            if letter in ("CR", "TURN") and not match[2]:
                break
            words.append((letter, float(match[3])))
            position = match.end()
        rest = content[position:].strip()
        if rest:
            word = re.match(r"\w+|.", rest)[0]
            raise ProgramError(
                f"Sinumerik word '{word}' is not read",
                accepted="G M T D F S X Y Z A B C I J K CR= TURN= with numbers",
                hint="post the program without variables, cycles and frames",
            )
        return words

    def _dwell(self, words: list[tuple[str, float]]) -> None:
        """G4 F is a time in seconds, G4 S a number of revolutions."""
        values = dict(words)
        if set(values) == {"G", "F"}:
            self.execute(f"g4p{number(values['F'])}")
        elif set(values) == {"G", "S"} and self.controller.speed > 0.0:
            self.execute(f"g4p{number(values['S'] * 60.0 / self.controller.speed)}")
        else:
            raise ProgramError("G4 takes F (seconds) or S (revolutions) alone in its block")

    def _tool(self, words: list[tuple[str, float]]) -> None:
        values = dict(words)
        if "T" in values:
            self.execute(f"t{values['T']:.0f}")
        edge = self.edge
        if "D" in values:
            if values["D"] not in (0.0, 1.0):
                raise ProgramError(f"cutting edge D{values['D']:g}", accepted="D0 D1")
            edge = int(values["D"])
        changed = any(letter == "M" and value == 6 for letter, value in words)
        if changed:
            self.execute("m6")
        if changed or edge != self.edge:
            self.edge = edge
            tool = self.controller.tool
            self.execute(f"g43h{tool}" if edge and tool else "g49")

    def _block(self, words: list[tuple[str, float]], g_codes: list[float]) -> str:
        text = []
        for letter, value in words:
            if letter == "G":
                text.append(self._code(value))
            elif letter == "M":
                if value not in _STOPS and value != 6:
                    text.append(f"m{value:g}")
            elif letter == "CR":
                text.append(f"r{number(value)}")
            elif letter == "TURN":
                text.append(f"p{value + 1:.0f}")
            elif letter in ("T", "D"):
                continue
            elif letter in "XYZABCIJKFS":
                text.append(f"{letter.lower()}{number(value)}")
            else:
                raise ProgramError(
                    f"Sinumerik word '{letter}{value:g}' is not read",
                    accepted="G M T D F S X Y Z A B C I J K CR= TURN=",
                )
        block = "".join(text)
        if block and not read_block(block).g_codes and self.controller.motion in (None, "G80"):
            block = "g1" + block if any(w[0] in "XYZABC" for w in words) else block
        return block

    @staticmethod
    def _code(value: float) -> str:
        if value in _CODES:
            return _CODES[value]
        if value not in _SAME:
            raise ProgramError(
                f"Sinumerik G{value:g} is not read",
                accepted="G0-G4 G17-G19 G40 G53-G57 G60 G64 G70 G71 G90 G91 G94 G95",
            )
        return f"g{value:.0f}"


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


_START = r"^[ \t]*(?:N?\d+[ \t]+)?"  # block number


class Sinumerik(Dialect):
    """SINUMERIK in its own language, not its ISO mode."""

    name = "sinumerik"
    title = "SINUMERIK 840D sl, 828D, ONE"
    source = "SINUMERIK 840D sl/828D Programming Manual Fundamentals 6FC5398-1BP40"
    synonyms = ("siemens",)
    rank = 30
    marks = re.compile(
        r"^[ \t]*(?:%_N_\w+|;\$PATH=)"
        rf"|{_START}(?:DEF[ \t]+(?:REAL|INT|BOOL|STRING)|PROC[ \t]|EXTERN[ \t]|ENDFOR|ENDWHILE"
        r"|STOPRE|WORKPIECE[ \t]*\(|CYCLE\d+[ \t]*\(|TRANS[ \t]|ATRANS[ \t]|MSG[ \t]*\(\")"
        r"|^[^(;\n]*\b(?:[XYZFS]|CR|TURN|AP|RP)[ \t]*=[ \t]*[-+.\dA-Z]",
        re.IGNORECASE | re.MULTILINE,
    )
    reader = SinumerikReader
    arcs = ARC_TOLERANCES["sinumerik"]
    inch_decimals = 2
    text = SinumerikText
