"""Haas: read as Fanuc is."""

from __future__ import annotations

from gcode.dialects.fanuc import Fanuc

__all__ = ["Haas"]


class Haas(Fanuc):
    """Haas Next Generation Control."""

    name = "haas"
    title = "Haas NGC"
    source = "Haas Automation, Mill Operator's Manual 96-8210"
    marks = None
    reads = ("linuxcnc", "fanuc")
