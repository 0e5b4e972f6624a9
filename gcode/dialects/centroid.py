"""Centroid CNC12: letters as Fanuc has them, numbers as they stand, G4 P in seconds."""

from __future__ import annotations

from gcode.dialects.fanuc import Fanuc
from gcode.dialects.fanuc.confirmed import CONFIRMED
from gcode.dialects.fanuc.reader import FanucReader
from gcode.dialects.fanuc.settings import FanucSettings

__all__ = ["Centroid"]


class CentroidReader(FanucReader):
    """Runs a program of Centroid's CNC11 or CNC12."""

    settings = FanucSettings(
        radius_in_d=False,
        dwell_p_s=1.0,
        only_calculator=True,
        pointless_factor=True,
        builder_m={10: "clamp on", 11: "clamp off", 15: "no function", 26: "set axis home",
                   39: "air drill", 48: "overrides on", 49: "overrides off"},
        z_home_m=frozenset((25,)),
        peck_clearance_mm=0.254,
    )  # fmt: skip


class Centroid(Fanuc):
    """Centroid CNC11 and CNC12."""

    name = "centroid"
    title = "Centroid CNC12"
    source = "Centroid M-Series Operator's Manual, chapters 11 to 13 (M functions, G codes)"
    marks = None
    rank = 62
    reader = CentroidReader
    reads = ("linuxcnc", "fanuc")
    confirmed = {
        "posts": "G0; G1; G2; G3; G17; G21; G40; G49; G53; G80; G81; G82; G83; G90; G98; M25; M99",
        "fanuc": CONFIRMED["manual"],
        "no motion": CONFIRMED["no motion"],
    }

    @classmethod
    def detect(cls, text: str) -> None:
        """Never: nothing in a text says it."""
