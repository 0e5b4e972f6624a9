"""Logs of a spindle drift test: the tool tip against time (ISO 230-3)."""

from __future__ import annotations

import numpy as np

from vmach.importers.importer import Imported, Importer, Section
from vmach.importers.loose_table import SMALL_LENGTH, SPEED, TIME, Column, LooseTable
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile
from vmach.importers.time_of_day import CLOCK, COUNTED_FROM_THE_FIRST
from vmach.instruments.kinds.drift import Drift

__all__ = ["DriftLog"]

_TIME = Column("time", ("t", "time", "zeit", "elapsed", "elapsed time", "temps"), TIME)
_RPM = Column("rpm", ("rpm", "speed", "spindle", "spindle speed", "drehzahl", "n"), SPEED, "rpm",
              is_needed=False)  # fmt: skip


class DriftLog(Importer):
    """Displacements along X, Y and Z in time, with the speed of the spindle."""

    name = "drift"
    title = "Spindle drift log (ISO 230-3)"
    reads = "CSV or text with a heading: time, displacements X, Y, Z, speed of the spindle if there"
    rank = 35
    keys = {
        "at": "machine position of the spindle nose, mm",
        "tool_length": "from the spindle nose to the target, mm",
        "u_um": "standard uncertainty of a reading",
        "rpm": "speed of the spindle, where the file has none",
        "sensor": "workpiece: a positive reading is the tool moved along +; tool: the opposite",
        "unit": "of displacements whose heading names none",
    }

    def recognises(self, source: SourceFile) -> bool:
        return _table(source, Questions.none_open()) is not None

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        table = _table(source, questions)
        if table is None:
            raise source.error(
                "no heading with a time and displacements",
                accepted="columns such as 'Time (min)', 'dX (um)', 'dY (um)', 'dZ (um)'",
                hint="--column time=..., --column dx=... name other headings",
            )
        at = questions.point("at", "machine position of the spindle nose during the test")
        length = questions.number("tool_length", "from the spindle nose to the target", unit="mm")
        u_um = questions.number("u_um", "standard uncertainty of a reading", unit="um", default=0.5)
        on = questions.choice(
            "sensor",
            "is a reading positive where the tool moved along + (workpiece), or the reverse (tool)",
            ("workpiece", "tool"),
            default="workpiece",
        )
        sign = 1.0 if on == "workpiece" else -1.0
        time = table.complete("time")
        falls = np.flatnonzero(np.diff(time) < 0)
        if len(falls):
            line = int(table.lines[falls[0] + 1])
            raise source.error("time runs backwards", line=line, accepted="rows in order of time")
        # a direction without a sensor has no column
        read = [name for name in ("dx", "dy", "dz") if name in table.numbers]
        moved = np.column_stack([sign * table.complete(name) for name in read])
        rpm = table.complete("rpm") if "rpm" in table.numbers else np.full(
            len(time), questions.number("rpm", "speed of the spindle", unit="1/min"))  # fmt: skip
        lines = [",".join(["t_s", "spindle_rpm", *(f"{name}_um" for name in read)])]
        for row in zip(time, rpm, moved, strict=True):
            lines.append(f"{row[0]:.4f},{row[1]:g}," + ",".join(f"{v:.6g}" for v in row[2]))
        file = f"{source.path.stem}_drift.csv"
        values = {"kind": Drift.name, "file": file, "at_mm": at, "tool_length_mm": length,
                  "u_um": u_um}  # fmt: skip
        span = f"{source.path.name}: {len(time)} readings in {np.ptp(time) / 60:.1f} min, "
        span += f"{', '.join(read)}, " if len(read) < len("xyz") else ""
        said = span + f"up to {np.abs(moved).max():.1f} um"
        said += COUNTED_FROM_THE_FIRST if table.units["time"] == CLOCK else ""
        section = Section("job", "measurements", values, is_array=True)
        return Imported({file: "\n".join(lines) + "\n"}, (section,), (said,))


def _table(source: SourceFile, questions: Questions) -> LooseTable | None:
    unit = questions.unit()
    moved = tuple(
        Column(f"d{a}", (f"d{a}", f"{a}", f"{a} drift", f"drift {a}", f"displacement {a}"),
               SMALL_LENGTH, unit, is_needed=a == "z")
        for a in "xyz"
    )  # fmt: skip
    return LooseTable.find(source, (_TIME, *moved, _RPM), given=questions.columns)
