"""Klartext cycles 1 to 5 and 17 of the first TNC controls, as the newer ones they were replaced by.

Source: HEIDENHAIN TNC 426/430 User's Manual, "Cycles for drilling, tapping and thread milling" and
"Cycles for milling pockets, studs and slots".

- 1 PECKING: set-up clearance, depth, pecking depth, dwell, feed.
- 2 TAPPING: set-up clearance, depth, dwell, feed.
- 17 RIGID TAPPING: set-up clearance, depth, pitch.
- 3 SLOT MILLING and 4 POCKET MILLING: set-up clearance, depth, pecking depth with its feed, X, Y,
  feed; 4 with DR and RADIUS.
- 5 CIRCULAR POCKET: the same with one radius.

The tool stands at the set-up clearance.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.errors import ProgramError

__all__ = ["OLD_CYCLES", "old_data", "renewed"]

#: cycle -> the newer one, and the Q parameters of each of its lines
OLD_CYCLES: dict[int, tuple[int, tuple[str, ...]]] = {
    1: (200, ("200", "201", "202", "211", "206")),
    2: (206, ("200", "201", "211", "206")),
    3: (253, ("200", "201", "202 206", "218", "219", "207")),
    4: (251, ("200", "201", "202 206", "218", "219", "207 220")),
    5: (252, ("200", "201", "202 206", "223", "207")),
    17: (207, ("200", "201", "239")),
}
_SENSE = re.compile(r"\bDR\s*([+-])")


def old_data(text: str, value: Callable[[str], float]) -> tuple[int, int, dict[str, float]] | None:
    """Cycle, line and Q parameters of ``1.2 DEPTH -20``; None for the title in line 0.

    Raises
    ------
    ProgramError
        The line has no number, or more of them than it may.
    """
    match = re.match(r"(\d+)\.(\d+)(.*)", text)
    if match is not None and match[2] == "0":
        return None
    cycle, line = (0, 0) if match is None else (int(match[1]), int(match[2]))
    names = OLD_CYCLES[cycle][1] if cycle in OLD_CYCLES else ()
    body = "" if match is None else match[3]
    said = re.findall(rf"(?<![.\d]){NUMBER}", _SENSE.sub(" ", body))
    if not 0 < line <= len(names) or not 0 < len(said) <= len(names[line - 1].split()):
        raise ProgramError(f"cannot read 'CYCL DEF {text}'", accepted="CYCL DEF 1.2 DEPTH -20")
    data = dict(zip(names[line - 1].split(), map(value, said), strict=False))
    sense = _SENSE.search(body)
    if sense is not None:
        data["351"] = 1.0 if sense[1] == "+" else -1.0
    return cycle, line, data


def renewed(
    cycle: int, lines: dict[int, dict[str, float]], level: float
) -> tuple[int, dict[str, float]]:
    """The newer cycle and its Q parameters, for a tool that stands at `level`."""
    newer, names = OLD_CYCLES[cycle]
    missing = [k for k in range(1, len(names) + 1) if k not in lines]
    if missing:
        raise ProgramError(f"CYCL DEF {cycle}.{missing[0]} is missing")
    found = {name: value for data in lines.values() for name, value in data.items()}
    clearance = abs(found["200"])
    found |= {"200": clearance, "201": -abs(found["201"]), "203": level - clearance,
              "204": clearance}  # fmt: skip
    if cycle == 5:
        found["223"] *= 2.0
    if cycle == 3 and abs(found["219"]) > abs(found["218"]):
        found |= {"218": found["219"], "219": found["218"], "374": 90.0}
    found |= {name: abs(found[name]) for name in ("218", "219") if name in found}
    return newer, found
