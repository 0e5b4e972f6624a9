"""CYCLE81 to CYCLE89, CYCLE840 and HOLES1, HOLES2, CYCLE801 as plain moves.

SINUMERIK 840D sl/828D, Programming Manual Cycles, "Drilling" and "Drilling patterns".
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gcode.errors import ProgramError
from gcode.language.translate import number

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["CYCLES", "PATTERNS", "drill", "pattern_points"]

CYCLES = frozenset(f"CYCLE{number}" for number in (81, 82, 83, 84, 85, 86, 87, 88, 89, 840))
PATTERNS = frozenset(("HOLES1", "HOLES2", "CYCLE801"))
#: by which CYCLE83 draws back to break chips, mm
_CHIP_BREAK_MM = 1.0
_MOST_PECKS = 10_000  #: more is a slip of the decimal point, and would take seconds a hole
Arguments = list[float | None]


def _value(arguments: Arguments, index: int, default: float | None = None) -> float | None:
    found = arguments[index] if index < len(arguments) else None
    return default if found is None else found


def drill(reader: SinumerikReader, name: str, arguments: Arguments) -> None:
    """Do a cycle at the present place: RTP, RFP, SDIS, DP, DPR and its own arguments."""
    cycle = int(name.removeprefix("CYCLE"))
    out, surface = _value(arguments, 0), _value(arguments, 1, 0.0)
    if out is None:
        raise ProgramError(f"{name} without a retraction plane")
    clear = surface + abs(_value(arguments, 2, 0.0))
    bottom, relative = _value(arguments, 3), _value(arguments, 4)
    if bottom is None and not relative:
        raise ProgramError(f"{name} without a depth", accepted="DP or DPR")
    bottom = bottom if not relative else surface - abs(relative)
    if not bottom < surface:
        raise ProgramError(f"{name}: depth {bottom:g} is not below {surface:g}")
    modal = reader.controller.motion
    if cycle in (84, 840, 86):  # the spindle turns back or stops
        reader.keep("tapping" if cycle != 86 else "boring with a stopped spindle")
    reader.go("g0", z=clear)
    if cycle == 83:
        _pecks(reader, arguments, surface=surface, clear=clear, bottom=bottom)
    else:
        reader.go("g1", z=bottom, feed=_feed_in(reader, cycle, arguments))
    dwell = _value(arguments, 8 if cycle == 83 else 5, 0.0) if cycle not in (81, 87) else 0.0
    if dwell > 0.0:
        reader.execute(f"g4p{number(dwell)}")
    if cycle in (84, 840, 85, 89):
        back = _value(arguments, 7) if cycle == 85 else _feed_in(reader, cycle, arguments)
        reader.go("g1", z=clear, feed=back)
    if cycle == 86:
        _off_the_wall(reader, arguments, bottom=bottom, out=out)
    reader.go("g0", z=out)
    reader.controller.motion = modal


def _feed_in(reader: SinumerikReader, cycle: int, arguments: Arguments) -> float | None:
    """FFR of CYCLE85; of CYCLE84 and CYCLE840 the pitch PIT times the speed."""
    if cycle == 85:
        return _value(arguments, 6)
    if cycle not in (84, 840):
        return None
    pitch = _value(arguments, 8 if cycle == 84 else 10)
    speed = reader.controller.speed
    if cycle == 84:
        speed = _value(arguments, 10) or speed
    elif not pitch:
        return None  # CYCLE840 with the feed of the program
    if not pitch:
        raise ProgramError("CYCLE84 without a pitch PIT")
    return reader.units.said(abs(pitch) * speed)


def _off_the_wall(
    reader: SinumerikReader, arguments: Arguments, *, bottom: float, out: float
) -> None:
    """CYCLE86: RPA, RPO and RPAP take the edge from the wall, then out and back."""
    x, y, *_ = reader.here()
    aside = x + _value(arguments, 7, 0.0), y + _value(arguments, 8, 0.0)
    reader.place("g0", aside[0], aside[1], bottom + _value(arguments, 9, 0.0))
    reader.go("g0", z=out)
    reader.place("g0", x, y, out)


def _pecks(
    reader: SinumerikReader, arguments: Arguments, *, surface: float, clear: float, bottom: float
) -> None:
    """CYCLE83 with equal pecks; VARI 0 breaks chips, 1 comes out."""
    first, relative = _value(arguments, 5), _value(arguments, 6)
    step = surface - first if relative is None and first is not None else abs(relative or 0.0)
    less = abs(_value(arguments, 7, 0.0))
    if not step > 0.0 or (surface - bottom) / min(step, less or step) > _MOST_PECKS:
        raise ProgramError(f"CYCLE83 with a first depth of {step:g}")
    comes_out = _value(arguments, 11, 0.0) == 1.0
    depth = surface - step
    while depth > bottom + 1e-9:
        reader.go("g1", z=depth)
        if comes_out:
            reader.go("g0", z=clear)
            reader.go("g0", z=min(depth + _CHIP_BREAK_MM, clear))
        else:
            reader.go("g0", z=depth + _CHIP_BREAK_MM)
        step = max(step - less, less) if less else step
        depth -= step
    reader.go("g1", z=bottom)


def pattern_points(name: str, arguments: Arguments) -> list[tuple[float, float]]:
    """Places of HOLES1 (a row) and HOLES2 (a circle)."""
    values = [v or 0.0 for v in arguments] + [0.0] * 7
    if name == "CYCLE801":
        return _grid(values)
    count = int(values[5])
    if not 0 < count <= _MOST_PECKS:
        raise ProgramError(f"{name} with {values[5]:g} holes")
    if name == "HOLES1":
        x, y, angle, first, apart = values[:5]
        along = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        return [
            (x + (first + k * apart) * along[0], y + (first + k * apart) * along[1])
            for k in range(count)
        ]
    x, y, radius, angle, step = values[:5]
    step = step or 360.0 / count
    angles = [math.radians(angle + k * step) for k in range(count)]
    return [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in angles]


def _grid(values: list[float]) -> list[tuple[float, float]]:
    """CYCLE801(SPCA, SPCO, STA, DIS1, DIS2, NUM1, NUM2): columns and lines, there and back."""
    x, y, angle, along, across = values[:5]
    columns, lines = int(values[5]), int(values[6])
    if not 0 < columns * lines <= _MOST_PECKS:
        raise ProgramError(f"CYCLE801 with {values[5]:g} times {values[6]:g} places")
    cosine, sine = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    found = []
    for line in range(lines):
        order = range(columns) if line % 2 == 0 else range(columns - 1, -1, -1)
        for column in order:
            u, v = column * along, line * across
            found.append((x + u * cosine - v * sine, y + u * sine + v * cosine))
    return found
