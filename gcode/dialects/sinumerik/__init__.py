"""SINUMERIK in its own language, not its ISO mode."""

from __future__ import annotations

import re
from types import MappingProxyType

from gcode.dialects.sinumerik.confirmed import CONFIRMED
from gcode.dialects.sinumerik.reader import SinumerikReader
from gcode.geometry.arc_tolerance import ARC_TOLERANCES
from gcode.language.dialect import Dialect
from gcode.text.source import Word
from gcode.writing.block_text import BlockText
from gcode.writing.sinumerik_blocks import SinumerikBlocks

__all__ = ["Sinumerik"]

_START = r"^[ \t]*(?:N?\d+[ \t]+)?"  # block number
_BARE = r"^[^(;\n]*\b"  # a word outside of comments and of arguments


class SinumerikText(BlockText):
    """Sinumerik: ``X=1.5``, ``CR=`` for the radius, ``TURN=`` for further turns."""

    word_form = "equal signs"
    plain = SinumerikBlocks
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


class Sinumerik(Dialect):
    """SINUMERIK in its own language, not its ISO mode."""

    name = "sinumerik"
    title = "SINUMERIK 840D sl, 828D, ONE"
    source = "SINUMERIK 840D sl/828D Programming Manual Fundamentals 6FC5398-1BP40"
    synonyms = ("siemens",)
    file_endings = (".mpf", ".spf")
    rank = 30
    marks = re.compile(
        r"^[ \t]*(?:%_N_\w+|;\$PATH=)"
        rf"|{_START}(?:DEF[ \t]+(?:REAL|INT|BOOL|STRING|AXIS)|PROC[ \t]|EXTERN[ \t]|ENDFOR|ENDWHILE"
        r"|ENDLOOP|STOPRE|MCALL\b|SUPA\b|TRAORI\b|CIP[ \t]|REPEATB?[ \t]+[A-Z_]{2}"
        r"|(?:WORKPIECE|GROUP_BEGIN|CYCLE\d+|POCKET\d|SLOT\d|HOLES\d|LONGHOLE|MSG)[ \t]*\("
        r"|A?(?:TRANS|ROT|MIRROR|SCALE)[ \t])"
        rf"|{_BARE}(?:[DFS-Z]|[IJK](?=[ \t]*=[ \t]*[AI]C)|R\d+|CR|AR|TURN|AP|RP|RNDM?|CH[FR]|SPOS"
        r"|ADIS)[ \t]*=[ \t]*[-+.\dA-Z\"(]"
        rf"|{_BARE}(?:GOTO[FBC]|SUPA|COMPCAD|FFWON|DIAMOF)\b",
        re.IGNORECASE | re.MULTILINE,
    )
    reader = SinumerikReader
    options = MappingProxyType({"d_numbers": ("edges", "flat")})
    confirmed = CONFIRMED
    arcs = ARC_TOLERANCES["sinumerik"]
    inch_decimals = 2
    comment = ("; ", "")
    text = SinumerikText
    flow_lines = re.compile(
        r"\s*/?\s*(?:N\d+\s*)?(?:\w+:\s*)?(?:IF|ELSE|ENDIF|WHILE|ENDWHILE|FOR|ENDFOR|LOOP|ENDLOOP"
        r"|REPEATB?|UNTIL|CASE|GOTO[FBCS]?)\b",
        re.IGNORECASE,
    )
    unwritable = re.compile(
        r"=\s*[-+]?\s*(?![-+.\d\s])|=\s*[-+]?[\d.]+\s*[-+*/]|\b(?:AP|RP|AR)\s*=|\bMCALL\b|CYCLE[78]|HOLES[12]"
        r"|POCKET|SLOT[12]|LONGHOLE|\bC(?:IP|T)\b|\bRNDM?\s*=|\bCH[FR]\s*=|\bDISR\s*=",
        re.IGNORECASE,
    )
