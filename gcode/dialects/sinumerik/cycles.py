"""CYCLE81 to CYCLE85 and HOLES1, HOLES2 as plain moves.

SINUMERIK 840D sl/828D, Programming Manual Cycles, "Drilling" and "Drilling patterns".
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gcode.errors import ProgramError

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["CYCLES", "PATTERNS", "drill", "pattern_points"]

CYCLES = frozenset((81, 82, 83, 84, 85))
PATTERNS = frozenset(("HOLES1", "HOLES2"))
#: by which CYCLE83 draws back to break chips, mm
_CHIP_BREAK_MM = 1.0
_MOST_PECKS = 100_000
Arguments = list[float | None]


def _value(arguments: Arguments, index: int, default: float | None = None) -> float | None:
    found = arguments[index] if index < len(arguments) else None
    return default if found is None else found


def drill(reader: SinumerikReader, cycle: int, arguments: Arguments) -> None:
    """Do a cycle at the present place: RTP, RFP, SDIS, DP, DPR and its own arguments."""
    out, surface = _value(arguments, 0), _value(arguments, 1, 0.0)
    if out is None:
        raise ProgramError(f"CYCLE{cycle} without a retraction plane")
    clear = surface + abs(_value(arguments, 2, 0.0))
    bottom, relative = _value(arguments, 3), _value(arguments, 4)
    if bottom is None and relative is None:
        raise ProgramError(f"CYCLE{cycle} without a depth", accepted="DP or DPR")
    bottom = bottom if relative is None else surface - abs(relative)
    if not bottom < surface:
        raise ProgramError(f"CYCLE{cycle}: depth {bottom:g} is not below {surface:g}")
    modal = reader.controller.motion
    reader.go("g0", z=clear)
    if cycle == 83:
        _pecks(reader, arguments, surface=surface, clear=clear, bottom=bottom)
    else:
        reader.go("g1", z=bottom, feed=_value(arguments, 6) if cycle == 85 else _tap(
            reader, cycle, arguments))  # fmt: skip
    dwell = _value(arguments, 8 if cycle == 83 else 5, 0.0) if cycle != 81 else 0.0
    if dwell > 0.0:
        reader.execute(f"g4p{dwell!r}")
    if cycle in (84, 85):
        reader.go("g1", z=clear, feed=_value(arguments, 7) if cycle == 85 else _tap(
            reader, cycle, arguments))  # fmt: skip
    reader.go("g0", z=out)
    reader.controller.motion = modal


def _tap(reader: SinumerikReader, cycle: int, arguments: Arguments) -> float | None:
    """Feed of CYCLE84: pitch PIT times the speed SST."""
    if cycle != 84:
        return None
    pitch, speed = _value(arguments, 8), _value(arguments, 10, reader.controller.speed)
    if not pitch:
        raise ProgramError("CYCLE84 without a pitch PIT")
    return abs(pitch) * speed


def _pecks(
    reader: SinumerikReader, arguments: Arguments, *, surface: float, clear: float, bottom: float
) -> None:
    """CYCLE83 with equal pecks; VARI 0 breaks chips, 1 comes out."""
    first, relative = _value(arguments, 5), _value(arguments, 6)
    step = surface - first if relative is None and first is not None else abs(relative or 0.0)
    if _value(arguments, 7, 0.0):
        raise ProgramError("CYCLE83 with degression DAM is not read", accepted="DAM 0")
    if not step > 0.0 or (surface - bottom) / step > _MOST_PECKS:
        raise ProgramError(f"CYCLE83 with a first depth of {step:g}")
    comes_out = _value(arguments, 11, 0.0) == 1.0
    for count in range(1, math.ceil((surface - bottom) / step - 1e-9)):
        depth = surface - count * step
        reader.go("g1", z=depth)
        if comes_out:
            reader.go("g0", z=clear)
            reader.go("g0", z=min(depth + _CHIP_BREAK_MM, clear))
        else:
            reader.go("g0", z=depth + _CHIP_BREAK_MM)
    reader.go("g1", z=bottom)


def pattern_points(name: str, arguments: Arguments) -> list[tuple[float, float]]:
    """Places of HOLES1 (a row) and HOLES2 (a circle)."""
    values = [v or 0.0 for v in arguments] + [0.0] * 6
    count = int(values[5])
    if not 0 < count <= _MOST_PECKS:
        raise ProgramError(f"{name} with {values[5]:g} holes")
    if name == "HOLES1":
        x, y, angle, first, apart = values[:5]
        along = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        return [(x + (first + k * apart) * along[0], y + (first + k * apart) * along[1])
                for k in range(count)]  # fmt: skip
    x, y, radius, angle, step = values[:5]
    step = step or 360.0 / count
    angles = [math.radians(angle + k * step) for k in range(count)]
    return [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in angles]
