"""Squareness from a ballbar's own file: XML with PLANE and FEATURE elements (``.b5r``).

The maker publishes no specification. What is read is what public readers of such files show: the
attribute TEST_PLANE of PLANE, and FEATURE with NAME="AF_SQUARENESS", DT="UT_SQUARENESS", in um/m.
"""

from __future__ import annotations

import math
import re

from vmach.files.text_file import decimal_number
from vmach.importers.importer import Imported, Importer
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile
from vmach.importers.squareness import squareness_sections
from vmach.importers.xml_text import xml_root

__all__ = ["BallbarReport"]

_NAME, _UNIT = "AF_SQUARENESS", "UT_SQUARENESS"


class BallbarReport(Importer):
    """The squareness that the ballbar's program found; which way it leans is asked."""

    name = "ballbar_report"
    title = "Squareness in a ballbar's own file"
    reads = ".b5r: XML with PLANE and FEATURE AF_SQUARENESS; the curve itself is not read"
    rank = 10
    keys = {"angle": "more or less: the angle between the plane's + axes against 90 degrees"}

    def recognises(self, source: SourceFile) -> bool:
        return source.suffix == ".b5r"

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        root = xml_root(source)
        planes = {e.get("TEST_PLANE", "").upper() for e in root.iter("PLANE")}
        values = [e for e in root.iter("FEATURE") if e.get("NAME") == _NAME]
        if len(planes) != 1 or len(values) != 1:
            raise source.error(
                f"{len(planes)} planes and {len(values)} features {_NAME}",
                line=1,
                accepted="one PLANE with TEST_PLANE, one FEATURE AF_SQUARENESS",
            )
        line = _line_of(source, _NAME)
        value = decimal_number((values[0].text or "").replace(",", "."))
        if values[0].get("DT") != _UNIT or not abs(value) < math.inf:
            raise source.error(
                f"{_NAME} is '{values[0].text}' with DT='{values[0].get('DT')}'",
                line=line,
                accepted=f"a number with DT='{_UNIT}', which is in um/m",
            )
        return squareness_sections(planes.pop(), abs(value), questions, what=source.path.name)


def _line_of(source: SourceFile, word: str) -> int:
    return next((k for k, line in enumerate(source.lines, 1) if re.search(word, line)), 1)
