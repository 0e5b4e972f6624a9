"""Klartext cycles 1, 2 and 17 of the first TNC controls, as the newer ones they were replaced by.

HEIDENHAIN TNC 426/430 User's Manual, "Cycles for drilling and tapping": cycle 1 PECKING (set-up
clearance, depth, pecking depth, dwell, feed), 2 TAPPING (set-up clearance, depth, dwell, feed), 17
RIGID TAPPING (set-up clearance, depth, pitch). The tool stands at the set-up clearance.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.errors import ProgramError

__all__ = ["OLD_CYCLES", "old_datum", "renewed"]

#: cycle -> the newer one, and the Q parameter of each of its lines
OLD_CYCLES: dict[int, tuple[int, tuple[str, ...]]] = {
    1: (200, ("200", "201", "202", "211", "206")),
    2: (206, ("200", "201", "211", "206")),
    17: (207, ("200", "201", "239")),
}


def old_datum(text: str, value: Callable[[str], float]) -> tuple[int, int, float] | None:
    """Cycle, line and number of ``1.2 DEPTH -20``; None for the title in line 0.

    Raises
    ------
    ProgramError
        The line has no number.
    """
    match = re.match(rf"(\d+)\.(\d+)\s*(?:[A-Z .\-]*?)({NUMBER})?\s*$", text)
    if match is None or (match[3] is None and match[2] != "0"):
        raise ProgramError(f"cannot read 'CYCL DEF {text}'", accepted="CYCL DEF 1.2 DEPTH -20")
    return None if match[2] == "0" else (int(match[1]), int(match[2]), value(match[3]))


def renewed(cycle: int, data: dict[int, float], level: float) -> tuple[int, dict[str, float]]:
    """The newer cycle and its Q parameters, for a tool that stands at `level`."""
    newer, names = OLD_CYCLES[cycle]
    missing = [k for k in range(1, len(names) + 1) if k not in data]
    if missing:
        raise ProgramError(f"CYCL DEF {cycle}.{missing[0]} is missing")
    found = {name: data[k] for k, name in enumerate(names, 1)}
    clearance = abs(found["200"])
    found |= {
        "200": clearance,
        "201": -abs(found["201"]),
        "203": level - clearance,
        "204": clearance,
    }
    return newer, found
