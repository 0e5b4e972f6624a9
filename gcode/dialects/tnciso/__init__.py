"""HEIDENHAIN in DIN/ISO: G codes of the controls that also read Klartext."""

from __future__ import annotations

import re
from types import MappingProxyType

from gcode.dialects.heidenhain import Heidenhain
from gcode.dialects.heidenhain.confirmed import CONFIRMED
from gcode.dialects.tnciso.reader import TncIsoReader

__all__ = ["TncIso"]


class TncIso(Heidenhain):
    """HEIDENHAIN in DIN/ISO."""

    name = "tnciso"
    title = "HEIDENHAIN TNC, DIN/ISO"
    source = "HEIDENHAIN TNC 426/430 User's Manual ISO Programming"
    synonyms = ()
    file_endings = (".i",)
    rank = 9
    marks = re.compile(
        r"^[ \t]*(?:N\d+[ \t]*)?%[ \t]*\w+[ \t]+G7[01]\b[ \t]*\*?", re.IGNORECASE | re.MULTILINE
    )
    reader = TncIsoReader
    is_written = False
    options = MappingProxyType({})
    #: words are counted as those of Klartext that they become
    confirmed = CONFIRMED
