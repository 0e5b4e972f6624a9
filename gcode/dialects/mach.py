"""Mach3 and Mach4: letters as Fanuc has them, numbers as they stand, G4 P in seconds."""

from __future__ import annotations

from gcode.dialects.fanuc import Fanuc
from gcode.dialects.fanuc.confirmed import CONFIRMED
from gcode.dialects.fanuc.reader import FanucReader
from gcode.dialects.fanuc.settings import FanucSettings

__all__ = ["Mach"]


class MachReader(FanucReader):
    """Runs a program of Mach3 or Mach4."""

    settings = FanucSettings(
        radius_in_d=False,
        dwell_p_s=1.0,
        only_calculator=True,
        pointless_factor=True,
        builder_m={47: "repeat from the first line", 48: "overrides on", 49: "overrides off"},
        peck_clearance_mm=0.254,
    )


class Mach(Fanuc):
    """Mach3 and Mach4."""

    name = "mach"
    title = "Mach3, Mach4"
    source = "ArtSoft, Using Mach3Mill, chapter 10 (G-code language reference)"
    synonyms = ("mach3", "mach4")
    marks = None
    rank = 61
    reader = MachReader
    reads = ("linuxcnc", "fanuc")
    confirmed = {
        "posts": "G0; G1; G2; G3; G17; G21; G40; G43; G49; G54; G80; G81; G82; G83; G90; G98",
        "fanuc": CONFIRMED["manual"],
        "no motion": CONFIRMED["no motion"],
    }

    @classmethod
    def detect(cls, text: str) -> None:
        """Never: nothing in a text says it."""
