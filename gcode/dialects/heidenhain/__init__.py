"""Heidenhain Klartext."""

from __future__ import annotations

import re
from types import MappingProxyType

from gcode.dialects.heidenhain.confirmed import CONFIRMED
from gcode.dialects.heidenhain.reader import KlartextReader
from gcode.geometry.arc_tolerance import ARC_TOLERANCES
from gcode.language.dialect import Dialect
from gcode.writing.klartext import KlartextEdit, KlartextText

__all__ = ["Heidenhain"]


class Heidenhain(Dialect):
    """Heidenhain Klartext."""

    name = "heidenhain"
    title = "HEIDENHAIN TNC 620, TNC 640"
    source = "HEIDENHAIN TNC 640 User's Manual for Klartext Programming 892903"
    synonyms = ("klartext",)
    file_endings = (".h",)
    rank = 10
    marks = re.compile(
        r"^[ \t]*(?:N?\d+[ \t]+)?(?:BEGIN PGM|BLK FORM|TOOL CALL|CYCL DEF)\b",
        re.IGNORECASE | re.MULTILINE,
    )
    reader = KlartextReader
    arcs = ARC_TOLERANCES["heidenhain"]
    flow_lines = re.compile(
        r"\s*(?:\d+\s+)?(?:LBL|CALL\s+LBL|FN\s*(?:9|1[012])\s*:)", re.IGNORECASE
    )
    unwritable = re.compile(r"\bQ[LR]?\d|\d,\d|^\s*(?:\d+\s+)?(?:LP|CP|CT)\b", re.IGNORECASE)
    inch_decimals = 2
    comment = ("; ", "")
    text = KlartextText
    edit = KlartextEdit
    confirmed = CONFIRMED
    #: how the control reads a helix, beside CP with IPA
    options = MappingProxyType({"helix": ("CP", "C")})
