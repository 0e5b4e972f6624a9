"""Mazak EIA/ISO: Fanuc's language with two tools in a block and a G61.1 without stops."""

from __future__ import annotations

from gcode.dialects.fanuc import Fanuc
from gcode.dialects.fanuc.confirmed import CONFIRMED
from gcode.dialects.fanuc.reader import FanucReader
from gcode.dialects.fanuc.settings import FanucSettings

__all__ = ["Mazak"]


class MazakReader(FanucReader):
    """Runs a program in EIA/ISO of a Mazatrol control."""

    settings = FanucSettings(next_tool_in_block=True, smooth_g61_1=True)


class Mazak(Fanuc):
    """Mazak EIA/ISO; Mazatrol conversational programs are no text."""

    name = "mazak"
    title = "Mazak EIA/ISO"
    source = "Mazak, EIA/ISO Programming Manual of Mazatrol Matrix (from memory)"
    marks = None
    rank = 63
    reader = MazakReader
    reads = ("linuxcnc", "fanuc")
    confirmed = {"fanuc": CONFIRMED["manual"], "no motion": CONFIRMED["no motion"]}

    @classmethod
    def detect(cls, text: str) -> None:
        """Never: its programs are Fanuc's until somebody says so."""
