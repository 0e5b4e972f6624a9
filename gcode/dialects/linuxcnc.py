"""LinuxCNC: RS274/NGC."""

from __future__ import annotations

import re

from gcode.control.flow import run_rs274
from gcode.geometry.arc_tolerance import ARC_TOLERANCES
from gcode.language.dialect import Dialect
from gcode.language.options import RunOptions
from gcode.state.controller import Controller
from gcode.text.source import Source

__all__ = ["LinuxCnc"]


class LinuxCnc(Dialect):
    """The language in which all other dialects are executed."""

    name = "linuxcnc"
    title = "LinuxCNC 2.9"
    source = "LinuxCNC 2.9 documentation, G-Code Programming; its interpreter is the oracle"
    synonyms = ("rs274",)
    file_endings = (".ngc",)
    is_rs274 = True
    arcs = ARC_TOLERANCES["linuxcnc"]
    own_words = re.compile(
        r"(?:^|[\s\d/])O\s*(?:<|\d+\s*(?:SUB|CALL|IF|ELSE|END|WHILE|DO|REPEAT|BREAK|CONTINUE|RETURN))"
        r"|[@^]|#\s*<|G\s*(?:43\.[12]|59\.[123]|6[14]\s*\.1|64\s*P|9[01]\.1|92\.[123]|38\.\d|33\.1"
        r"|4[12]\.1|7(?![\d.])|8(?![\d.])|10\s*L\s*(?:1|10|11|20)(?!\d))|M\s*(?:6[1-8]|7[0-3])(?!\d)",
        re.IGNORECASE,
    )
    #: dwell in seconds, start-up of compensation, cycles whose defaults differ
    unlike = re.compile(r"G\s*0*(?:4|4[12]|7[346]|8[1-9])(?![\d.])", re.IGNORECASE)
    inch_decimals = 2
    ending = frozenset((0, 1, 2, 30, 60))
    floating_tap = True

    @classmethod
    def run(cls, controller: Controller, source: Source, options: RunOptions) -> None:
        """Obey a program line by line, or a stretch of plain motion at a time."""
        run_rs274(controller, source, block_delete=options.skips(1),
                  max_blocks=options.max_blocks, fast=options.fast)  # fmt: skip
