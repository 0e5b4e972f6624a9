"""LinuxCNC probe logs: nine numbers a line, X Y Z A B C U V W, of each successful probe.

Source: LinuxCNC, "G-Codes", G38.n: "(PROBEOPEN filename.txt)" logs the nine coordinates of the
controlled point, in the coordinate system in use.
"""

from __future__ import annotations

import numpy as np

from vmach.files.text_file import decimal_number
from vmach.importers.importer import Imported, Importer
from vmach.importers.kinds.scan import coordinates
from vmach.importers.measured_points import laid_on_part, points_file
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile

__all__ = ["ProbeLog"]

_NUMBERS = 9


class ProbeLog(Importer):
    """Centres of the probe's ball at contact, in workpiece coordinates."""

    name = "probe_log"
    title = "LinuxCNC probe log (PROBEOPEN)"
    reads = "nine numbers a line: X Y Z A B C U V W; needs --job with a CAD"
    rank = 15
    keys = {
        "unit": "of the coordinates: mm, inch",
        "ball_mm": "diameter of the probe's ball; 0 where the log has the surface",
    }

    def recognises(self, source: SourceFile) -> bool:
        if not source.is_text or source.path.is_dir():
            return False
        lines = [line.split() for line in source.lines[:5] if line.strip()]
        return bool(lines) and all(
            len(words) == _NUMBERS and all(decimal_number(w) == decimal_number(w) for w in words)
            for words in lines
        )

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        log = coordinates(source, least=_NUMBERS)
        if log[:, 3:6].any():
            line = int(np.argmax(np.any(log[:, 3:6], axis=1))) + 1
            raise source.error("A, B or C is not 0", line=line, accepted="probing with three axes")
        ball = questions.number("ball_mm", "diameter of the probe's ball", unit="mm")
        points, told = laid_on_part(log[:, :3], source, questions, radius_mm=0.5 * ball)
        return points_file(points, source, told)
