"""Okuma OSP: recognised, and refused; its words mean other things than those of its neighbours."""

from __future__ import annotations

import re

from gcode.errors import ProgramError
from gcode.language.dialect import Dialect
from gcode.language.options import RunOptions
from gcode.state.controller import Controller
from gcode.text.source import Source

__all__ = ["Okuma"]


class Okuma(Dialect):
    """Programs of Okuma's OSP controls."""

    name = "okuma"
    title = "Okuma OSP"
    source = "Okuma OSP-P300M Programming Manual: file names, G15 H, VC variables, CALL O"
    rank = 5
    marks = re.compile(
        r"^[ \t]*\$\S+\.(?:MIN|SUB)\b"
        r"|^[ \t]*(?:N\w+[ \t]+)?(?:CALL[ \t]+O\w|G15[ \t]*H\d|VC\d+[ \t]*=)",
        re.IGNORECASE | re.MULTILINE,
    )

    @classmethod
    def run(cls, controller: Controller, source: Source, options: RunOptions) -> None:
        """Refuse the program."""
        raise ProgramError(
            "a program for Okuma OSP is not read",
            line=1,
            accepted="fanuc, grbl, haas, heidenhain, linuxcnc, sinumerik",
            hint="post it for Fanuc",
        )
