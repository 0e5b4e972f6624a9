"""CYCLE81 to CYCLE89, CYCLE840 and HOLES1, HOLES2, CYCLE801 as plain moves.

SINUMERIK 840D sl/828D, Programming Manual Cycles, "Drilling" and "Drilling patterns". Distances and
radii of patterns have no sign, and F is behind a cycle what it was before, as in the control's own
cycles (4.000, V06.02.09), which PDubovikov/SinumerikLanguage on GitHub shows.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.cycles.modes import Modes
from gcode.errors import ProgramError
from gcode.language.translate import number

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["CYCLES", "PATTERNS", "drill", "pattern_points"]

CYCLES = frozenset(f"CYCLE{number}" for number in (81, 82, 83, 84, 85, 86, 87, 88, 89, 840))
PATTERNS = frozenset(("HOLES1", "HOLES2", "CYCLE801"))
#: by which CYCLE83 draws back to break chips, mm
_CHIP_BREAK_MM = 1.0
#: ISO 261, coarse pitch of each metric thread, mm
_COARSE_MM = {
    3.0: 0.5, 4.0: 0.7, 5.0: 0.8, 6.0: 1.0, 8.0: 1.25, 10.0: 1.5, 12.0: 1.75, 14.0: 2.0, 16.0: 2.0,
    18.0: 2.5, 20.0: 2.5, 22.0: 2.5, 24.0: 3.0, 27.0: 3.0, 30.0: 3.5, 33.0: 3.5, 36.0: 4.0,
    39.0: 4.0, 42.0: 4.5, 45.0: 4.5, 48.0: 5.0,
}  # fmt: skip
_ROUNDED = 1e-9  #: lengths nearer than this are one
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
    modes = Modes.of(name, arguments, reader.cycle_plane)
    bottom, relative = _value(arguments, 3), _value(arguments, 4)
    if modes.depth == 2:
        relative = None
    if (bottom is None or modes.depth == 1) and not relative:
        raise ProgramError(f"{name} without a depth", accepted="DP or DPR")
    bottom = bottom if not relative else surface - abs(relative)
    if not bottom < surface:
        raise ProgramError(f"{name}: depth {bottom:g} is not below {surface:g}")
    modal, feed = reader.controller.motion, reader.controller.feed
    if cycle in (84, 840, 86):  # the spindle turns back or stops
        reader.keep("tapping" if cycle != 86 else "boring with a stopped spindle")
    reader.go("g0", z=clear)
    if cycle == 83:
        _Pecks(reader, arguments, modes, surface, clear).go_to(bottom)
    elif cycle == 84 and _value(arguments, 15, 0.0):
        _tap_in_steps(reader, arguments, surface=surface, clear=clear, bottom=bottom)
    else:
        reader.go("g1", z=bottom, feed=_feed_in(reader, cycle, arguments))
    _dwell(reader, cycle, arguments, modes)
    if cycle in (84, 840, 85, 89):
        back = _feed_in(reader, cycle, arguments, back=True) if cycle != 85 else None
        back = _value(arguments, 7) if cycle == 85 else back
        reader.go("g1", z=clear, feed=back)
    if cycle == 86:
        _off_the_wall(reader, arguments, bottom=bottom, out=out)
    reader.go("g0", z=out)
    if feed and feed != reader.controller.feed:
        reader.execute(f"f{number(reader.units.said(feed))}")
    reader.controller.motion = modal


def _dwell(reader: SinumerikReader, cycle: int, arguments: Arguments, modes: Modes) -> None:
    """DTB, or DTD of CYCLE83: seconds, or turns of the spindle (negative, or by AMODE)."""
    dwell = _value(arguments, 8 if cycle == 83 else 5, 0.0) if cycle not in (81, 87) else 0.0
    if cycle == 83:
        dwell = _value(arguments, 15, 0.0) or dwell
    dwell = _seconds(reader, dwell, in_turns=modes.in_turns)
    if dwell > 0.0:
        reader.execute(f"g4p{number(dwell)}")


def _tap_in_steps(
    reader: SinumerikReader, arguments: Arguments, *, surface: float, clear: float, bottom: float
) -> None:
    """VARI of CYCLE84: 1 breaks chips and goes back by VRT, 2 comes out, behind every DAM."""
    step, kind = abs(_value(arguments, 16, 0.0)), _value(arguments, 15)
    if kind not in (1.0, 2.0) or not step or (surface - bottom) / step > _MOST_PECKS:
        raise ProgramError(f"CYCLE84 with VARI {kind:g} and DAM {step:g}",
                           accepted="VARI 0; 1 or 2 with a step DAM")  # fmt: skip
    feed, out = (_feed_in(reader, 84, arguments, back=b) for b in (False, True))
    back = abs(_value(arguments, 17, 0.0)) or _CHIP_BREAK_MM / reader.controller.unit_mm
    depth = surface - step
    while depth > bottom + _ROUNDED:
        reader.go("g1", z=depth, feed=feed)
        reader.go("g1", z=clear if kind == 2.0 else min(depth + back, clear), feed=out)
        depth = _shared_depth(depth, bottom, step, step)
    reader.go("g1", z=bottom, feed=feed)


def _feed_in(
    reader: SinumerikReader, cycle: int, arguments: Arguments, *, back: bool = False
) -> float | None:
    """FFR of CYCLE85; of CYCLE84 and CYCLE840 the pitch times the speed, SST1 on the way back."""
    if cycle == 85:
        return _value(arguments, 6)
    if cycle not in (84, 840):
        return None
    speed = reader.controller.speed
    if cycle == 84:
        speed = _value(arguments, 10) or speed
        speed = (_value(arguments, 11) if back else 0.0) or speed
    at = 7 if cycle == 84 else 9
    size, pitch = _value(arguments, at, 0.0), _value(arguments, at + 1, 0.0)
    counted = _value(arguments, 13 if cycle == 84 else 12, 0.0)
    if not pitch and not (size and not counted):
        if cycle == 840:
            return None  # the feed of the program
        raise ProgramError("CYCLE84 without a pitch", accepted="MPIT or PIT")
    lead = _pitch(reader, abs(pitch), counted) if pitch else 0.0
    if size and not counted:
        coarse = _coarse_pitch(f"CYCLE{cycle}", abs(size)) / reader.controller.unit_mm
        if pitch and abs(coarse - lead) > _ROUNDED:
            raise ProgramError(f"CYCLE{cycle} with MPIT {size:g} and PIT {pitch:g}, which differ",
                               accepted="one of them")  # fmt: skip
        lead = coarse
    return reader.units.said(lead * speed)


def _coarse_pitch(name: str, size: float) -> float:
    """MPIT: the coarse pitch of the metric thread M3 to M48 in mm, after ISO 261."""
    pitch = _COARSE_MM.get(size)
    if pitch is None:
        raise ProgramError(f"{name} with MPIT {size:g}",
                           accepted=", ".join(f"{known:g}" for known in _COARSE_MM))  # fmt: skip
    return pitch


def _pitch(reader: SinumerikReader, pitch: float, unit: float) -> float:
    """PIT in the lengths of the program: PITA 0 as it stands, 1 mm, 2 threads an inch, 3 inch."""
    if unit not in (0.0, 1.0, 2.0, 3.0):
        raise ProgramError(f"pitch with PITA {unit:g}", accepted="0 to 3")
    length = {0.0: pitch * reader.controller.unit_mm, 1.0: pitch, 2.0: 25.4 / pitch,
              3.0: pitch * 25.4}[unit]  # fmt: skip
    return length / reader.controller.unit_mm


def _off_the_wall(
    reader: SinumerikReader, arguments: Arguments, *, bottom: float, out: float
) -> None:
    """CYCLE86: RPA, RPO and RPAP take the edge from the wall, then out and back."""
    x, y, *_ = reader.here()
    aside = x + _value(arguments, 7, 0.0), y + _value(arguments, 8, 0.0)
    reader.place("g0", aside[0], aside[1], bottom + _value(arguments, 9, 0.0))
    reader.go("g0", z=out)
    reader.place("g0", x, y, out)


def _seconds(reader: SinumerikReader, dwell: float, *, in_turns: bool) -> float:
    """A dwell in seconds; below 0, or by AMODE, it counts turns of the spindle."""
    if dwell < 0.0 or (dwell and in_turns):
        speed = reader.controller.speed
        return abs(dwell) * 60.0 / speed if speed else 0.0
    return dwell


def _shared_depth(depth: float, bottom: float, step: float, least: float) -> float:
    """The depth behind this one, where no two steps at the end differ by much.

    As the control's own CYCLE83 and CYCLE84 have it: ``least`` is left for the last step, and a
    rest below twice of it is shared by two equal steps.
    """
    rest = depth - bottom
    if rest <= step + _ROUNDED:
        return bottom
    if rest > 2.0 * least + _ROUNDED:
        return max(depth - step, bottom + least)
    return depth - rest / 2.0


class _Pecks:
    """CYCLE83: VARI 0 breaks chips, 1 comes out; steps shrink by DAM down to MDEP.

    Checked against the program of the control's own cycle (4.000, V06.02.09), which
    PDubovikov/SinumerikLanguage on GitHub shows.
    """

    def __init__(
        self,
        reader: SinumerikReader,
        arguments: Arguments,
        modes: Modes,
        surface: float,
        clear: float,
    ) -> None:
        self.reader, self.surface, self.clear = reader, surface, clear
        first, relative = _value(arguments, 5), _value(arguments, 6)
        given = surface - first if not relative and first is not None else abs(relative or 0.0)
        self.step, self.less = given, _value(arguments, 7, 0.0)
        if modes.in_percent and not 0.0 <= self.less <= 100.0:
            raise ProgramError(f"CYCLE83 with DAM {self.less:g} percent", accepted="0 to 100")
        least = abs(_value(arguments, 13, 0.0)) * (given / 100.0 if modes.least_in_percent else 1.0)
        self.factor: float | None = None  #: each step by the one before it; none: DAM is an amount
        if not self.less:
            self.factor, least = 1.0, given
        elif modes.in_percent:
            self.factor = self.less / 100.0
        elif self.less < 0.0:
            self.factor = -self.less
        self.least = self.less if self.factor is None else least
        self.back = abs(_value(arguments, 14, 0.0)) or _CHIP_BREAK_MM / reader.controller.unit_mm
        self.ahead = abs(_value(arguments, 16, 0.0))
        self.comes_out = _value(arguments, 11, 0.0) == 1.0
        slower = _value(arguments, 10, 0.0)  # a factor, or a percentage
        self.first_feed = slower / 100.0 if slower > 1.0 else slower
        dwells = _value(arguments, 8, 0.0), _value(arguments, 9, 0.0)
        self.dwells = [_seconds(reader, dwell, in_turns=modes.in_turns) for dwell in dwells]

    def _deeper(self, depth: float, bottom: float) -> float:
        """The end of the next step."""
        if self.factor is None:
            self.step = max(self.step - self.less, self.less)
            return _shared_depth(depth, bottom, self.step, self.least)
        self.step = max(self.step * self.factor, self.least)
        rest = depth - self.step - bottom
        if rest < -_ROUNDED:
            return bottom
        if rest >= self.least - _ROUNDED:
            return depth - self.step
        return (depth + bottom) / 2.0

    def _ahead(self, depth: float) -> float:
        """DIS1, or what the cycle takes without it: 0.6 mm to 30 mm deep, then 2 percent, <= 7."""
        if self.ahead:
            return self.ahead
        unit_mm = self.reader.controller.unit_mm
        deep_mm = (self.surface - depth) * unit_mm
        return (0.6 if deep_mm <= 30.0 else min(deep_mm / 50.0, 7.0)) / unit_mm

    def _wait(self, seconds: float) -> None:
        if seconds > 0.0:
            self.reader.execute(f"g4p{number(seconds)}")

    def go_to(self, bottom: float) -> None:
        """All infeeds, the last one ends at the depth."""
        shortest = min(self.step, self.least if self.factor not in (None, 1.0) else self.step)
        shortest = min(shortest, self.less) if self.factor is None else shortest
        if not shortest > 0.0 or (self.factor or 0.0) > 1.0:
            raise ProgramError(
                f"CYCLE83 with a first depth of {self.step:g} and DAM {self.less:g}",
                accepted="a first depth, and MDEP beside DAM in percent or as a factor -0 to -1",
            )
        if (self.surface - bottom) / shortest > _MOST_PECKS:
            raise ProgramError(f"CYCLE83 with steps of {shortest:g}")
        reader, feed = self.reader, self.reader.units.said(self.reader.controller.feed)
        slow = feed * self.first_feed if feed and 0.0 < self.first_feed < 1.0 else None
        depth = self.surface - self.step
        while depth > bottom + _ROUNDED:
            reader.go("g1", z=depth, feed=slow)
            if slow is not None:
                reader.execute(f"f{number(feed)}")
                slow = None
            self._wait(self.dwells[0])
            if self.comes_out:
                reader.go("g0", z=self.clear)
                self._wait(self.dwells[1])
            up = self._ahead(depth) if self.comes_out else self.back
            reader.go("g0", z=min(depth + up, self.clear))
            depth = self._deeper(depth, bottom)
        reader.go("g1", z=bottom)


def pattern_points(name: str, arguments: Arguments) -> list[tuple[float, float]]:
    """Places of HOLES1 (a row) and HOLES2 (a circle)."""
    values = [v or 0.0 for v in arguments] + [0.0] * 7
    if name == "CYCLE801":
        if any(values[7:]):
            raise ProgramError("CYCLE801 with a frame, a shear or places left out",
                               accepted="seven arguments")  # fmt: skip
        return _grid(values)
    count = int(values[5])
    if not 0 < count <= _MOST_PECKS:
        raise ProgramError(f"{name} with {values[5]:g} holes")
    if name == "HOLES1":
        x, y, angle = values[:3]
        first, apart = abs(values[3]), abs(values[4])
        along = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        return [
            (x + (first + k * apart) * along[0], y + (first + k * apart) * along[1])
            for k in range(count)
        ]
    x, y, radius, angle, step = *values[:2], abs(values[2]), *values[3:5]
    if not step or int(values[6]) // 1000 % 10 == 1:  # VARI: a whole circle, whatever INDA says
        step = 360.0 / count
    angles = [math.radians(angle + k * step) for k in range(count)]
    return [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in angles]


def _grid(values: list[float]) -> list[tuple[float, float]]:
    """CYCLE801(SPCA, SPCO, STA, DIS1, DIS2, NUM1, NUM2): columns and lines, there and back."""
    x, y, angle = values[:3]
    along, across = abs(values[3]), abs(values[4])
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
