"""FANUC with custom macro B."""

from __future__ import annotations

import re
from types import MappingProxyType

from gcode.dialects.fanuc.confirmed import CONFIRMED
from gcode.dialects.fanuc.reader import FanucReader
from gcode.dialects.fanuc.turning import looks_like_turning
from gcode.language.dialect import Dialect

__all__ = ["Fanuc"]


class Fanuc(Dialect):
    """FANUC with custom macro B."""

    name = "fanuc"
    title = "FANUC Series 0i and 30i"
    source = "FANUC Series 30i/31i/32i-B Operator's Manual B-64484EN, part II"
    rank = 20
    marks = re.compile(
        r"^[ \t]*(?:N\d+[ \t]*)?(?:IF[ \t]*\[[^\n]*\][ \t]*(?:GOTO|THEN)"
        r"|WHILE[ \t]*\[[^\n]*\][ \t]*DO|GOTO[ \t]*[\d#\[]|END[ \t]*[123]\b(?![ \t]*:))"
        r"|^[^(;\n]*\bG0*6[56](?![\d.])"
        r"|^[^(;\n]*\bG(?:154|187)(?!\d)|^[^(;\n]*\bG0*54\.1[ \t]*P"
        r"|^(?:[^(;\nA-Z]|[A-Z](?![A-Z]))*,[ \t]*[RC][ \t]*[\d.]"
        r"|^[^(;\n]*\bG0*(?:43\.[45]|68\.[23])(?!\d)"
        r"|^[^(;\n]*\bG0*5\.1[ \t]*Q|^[^(;\n]*\bM0*97[ \t]*P",
        re.IGNORECASE | re.MULTILINE,
    )
    reader = FanucReader
    is_rs274 = True
    reads = ("linuxcnc", "haas")
    #: parameters 5003#0 SUP and 19607#2 CCC
    options = MappingProxyType({"start_up": ("A", "B"), "outer_corners": ("lines", "arcs")})
    confirmed = CONFIRMED

    @classmethod
    def pause(cls, seconds: float) -> str:
        """P without a point counts milliseconds on most of the family."""
        unit_s = cls.reader.settings.dwell_p_s
        return super().pause(seconds) if unit_s == 1.0 else f"G4 P{max(round(seconds / unit_s), 1)}"

    @classmethod
    def detect(cls, text: str) -> str | None:
        """By its words, or as a turning program, which the reader then refuses."""
        found = super().detect(text)
        if found is not None:
            return found
        turning = looks_like_turning(text.splitlines())
        return ", ".join(turning) if turning else None
