"""Centroid CNC12: letters as Fanuc has them, numbers as they stand, G4 P in seconds."""

from __future__ import annotations

from gcode.dialects.fanuc import Fanuc
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

    @classmethod
    def detect(cls, text: str) -> None:
        """Never: nothing in a text says it."""
