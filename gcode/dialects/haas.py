"""Haas: Fanuc's language with other defaults."""

from __future__ import annotations

from gcode.dialects.fanuc import Fanuc
from gcode.dialects.fanuc.confirmed import CONFIRMED
from gcode.dialects.fanuc.reader import FanucReader
from gcode.dialects.fanuc.settings import HAAS_COLUMNS, HAAS_M, FanucSettings

__all__ = ["Haas"]


class HaasReader(FanucReader):
    """Runs a Haas program."""

    settings = FanucSettings(
        columns=HAAS_COLUMNS,
        radius_in_d=False,
        pointed_p_is_seconds=True,
        pointless_factor=True,
        haas_cycles=True,
        reference_all_axes=True,
        counters=range(5401, 6000),
        common_again=range(10000, 11000),  # #10100 is #100
        builder_m=HAAS_M,
        peck_clearance_mm=1.27,
    )


class Haas(Fanuc):
    """Haas Next Generation Control."""

    name = "haas"
    title = "Haas NGC"
    source = "Haas Automation, Mill Operator's Manual 96-8210"
    marks = None
    rank = 60
    reader = HaasReader
    pointed_pause = True
    reads = ("linuxcnc", "fanuc")
    confirmed = {
        "manual": "G0; G1; G10; G12; G13; G28; G40; G41; G70; G71; G72; G80; G83; G91; G99; G114; "
        "G154",
        "closed form": "G100; G101",
        "fanuc": CONFIRMED["manual"],
        "no motion": CONFIRMED["no motion"],
    }

    @classmethod
    def detect(cls, text: str) -> None:
        """Never: its programs are Fanuc's until somebody says so."""
