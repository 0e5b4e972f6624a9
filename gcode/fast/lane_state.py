"""What interpreter and compiled code hand to each other: one record, and what goes with it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcode.geometry.arcs import ZERO_RADIUS_MM
from gcode.state.codes import CODES
from gcode.state.controller import Controller, CycleMemory
from gcode.text.parameters import FIRST_SYSTEM, G92_APPLIED, system_base

__all__ = ["STATE", "Frames", "frames_of", "give_back", "give_back_cycle", "hand_over",
           "hand_over_cycle", "note"]  # fmt: skip

_AXES = ("f8", 6)
#: The state of a control as far as compiled code reads or changes it; lengths in program units
#: (``last``: mm), motion and path control as numbers times ten, -1 for none.
STATE = np.dtype([
    ("position", *_AXES), ("origin", *_AXES), ("g92", *_AXES), ("tool_offset", *_AXES),
    ("last", *_AXES), ("last_straight", *_AXES), ("rotation_deg", "f8"), ("system", "i8"),
    ("unit_mm", "f8"), ("machine_unit_mm", "f8"), ("plane", "i8"), ("motion", "i8"),
    ("absolute", "i8"), ("arc_absolute", "i8"), ("retract_to_initial", "i8"),
    ("path_control", "i8"), ("feed", "f8"), ("feed_mm_per_min", "f8"), ("speed", "f8"),
    ("spindle", "i8"), ("mist", "i8"), ("flood", "i8"), ("tool", "i8"), ("loaded", "i8"),
    ("selected_tool", "i8"), ("refresh", "i8"), ("preview", "i8"), ("straight_only", "i8"),
    # canned cycle: levels and times, NaN for none yet
    ("cycle_r", "f8"), ("cycle_bottom", "f8"), ("cycle_p", "f8"),
    ("cycle_q", "f8"), ("cycle_initial", "f8"),
    # of Fanuc's blocks
    ("cycle", "i8"), ("h", "f8"), ("length_sign", "i8"),
    ("increment", "f8"), ("degree_increment", "f8"),
    ("takes_pointless", "i8"), ("peck_clearance", "f8"), ("pointed_p_is_seconds", "i8"),
    ("dwell_p_s", "f8"), ("repeats_in_k", "i8"),
    # accepted radii of arcs, see `ArcTolerance`
    ("zero_radius", "f8"), ("allowed", "f8"), ("ceiling", "f8"), ("relative", "f8"),
    # what has been written so far
    ("line", "i8"), ("rows", "i8"), ("arcs", "i8"), ("dwells", "i8"), ("events", "i8"),
    ("wide", "i8"), ("notes", "i8"), ("is_full", "i8"),
])  # fmt: skip

_VECTORS = ("position", "origin", "g92", "tool_offset")
_WHOLE = ("plane", "tool", "loaded", "spindle", "system")
_FLAGS = ("absolute", "arc_absolute", "retract_to_initial", "mist", "flood", "straight_only",
          "refresh")  # fmt: skip
_NUMBERS = ("rotation_deg", "unit_mm", "feed", "speed")
_CYCLE = ("r", "bottom", "p", "q")
_SYSTEMS = 9


class Frames(NamedTuple):
    """Stored offsets, which compiled code only reads.

    Attributes
    ----------
    systems : (9, 7) float64
        Offset X Y Z A B C, machine units, and rotation, degrees, of G54 to G59.3.
    applied : (7,) float64
        1 where G92 is applied, and its offset, machine units.
    numbers : (T,) int64
        Of the offset memory, in order.
    offsets : (T, 6) float64
        X Y Z A B C of each, mm and degrees.
    magazine : (M,) int64
        Tools that may be called, in order; none where any may.
    """

    systems: np.ndarray
    applied: np.ndarray
    numbers: np.ndarray
    offsets: np.ndarray
    magazine: np.ndarray


def frames_of(c: Controller) -> Frames:
    """Stored offsets of a control."""
    numbered, systems = c.parameters.numbered, np.zeros((_SYSTEMS, 7))
    for system in range(_SYSTEMS):
        base = system_base(system + 1)
        systems[system, :6] = c.parameters.vector(base)
        systems[system, 6] = numbered.get(base + 9, 0.0)
    applied = [numbered.get(G92_APPLIED, 0.0), *c.parameters.vector(G92_APPLIED + 1)]
    known = sorted(c.offsets)
    offsets = [(e.x_mm, e.y_mm, e.offset_length_mm, *e.rotary_deg)
               for e in (c.offsets[number] for number in known)]  # fmt: skip
    return Frames(systems, np.array(applied), np.array(known, np.int64),
                  np.array(offsets, np.float64).reshape(-1, 6),
                  np.array(sorted(c.tools), np.int64))  # fmt: skip


def hand_over(c: Controller, state: np.ndarray, *, in_any_system: bool = False) -> bool:
    """Put the state of a control into a record, (1,) STATE; False where its modes forbid it.

    Lines that choose no work system can be obeyed `in_any_system`.
    """
    if c.side or c.feed_mode != "minute" or c.diameter_mode or c.queue.items:
        return False
    if c.record.rpm_of_feed is not None or c.starting:
        return False
    if c.system > _SYSTEMS and not in_any_system:
        return False
    if c.preview and c.offsets != c.first_offsets:
        return False
    s = state[0]
    for name in (*_VECTORS, *_NUMBERS, *_WHOLE, *_FLAGS):
        s[name] = getattr(c, name)
    s["motion"] = -1 if c.motion is None else round(10.0 * float(c.motion[1:]))
    s["path_control"] = round(10.0 * float(c.path_control[1:]))
    s["selected_tool"] = -1 if c.selected_tool is None else c.selected_tool
    s["machine_unit_mm"], s["preview"] = c.machine_unit_mm, c.preview
    s["last"], s["last_straight"] = c.record.last, c.record.last_straight
    s["feed_mm_per_min"] = c.record.feed_mm_per_min
    s["zero_radius"] = ZERO_RADIUS_MM / c.unit_mm
    s["allowed"] = c.tolerance.absolute(c.unit_mm)
    s["ceiling"], s["relative"] = c.tolerance.ceiling, c.tolerance.relative
    return True


def give_back(c: Controller, state: np.ndarray) -> None:
    """Put a record, (1,) STATE, into the control that it came from."""
    s = state[0]
    changed_tool = int(s["tool"]) != c.tool or (bool(s["refresh"]) and not c.refresh)
    changed_system = int(s["system"]) != c.system
    for name in _VECTORS:
        setattr(c, name, s[name].tolist())
    for name in _NUMBERS:
        setattr(c, name, float(s[name]))
    for name in _WHOLE:
        setattr(c, name, int(s[name]))
    for name in _FLAGS:
        setattr(c, name, bool(s[name]))
    motion, selected = int(s["motion"]), int(s["selected_tool"])
    c.motion = None if motion < 0 else f"G{motion / 10:g}"
    c.path_control = f"G{int(s['path_control']) / 10:g}"
    c.selected_tool = None if selected < 0 else selected
    c.record.feed_mm_per_min = float(s["feed_mm_per_min"])
    c.record.last = tuple(s["last"].tolist())
    c.record.last_straight = tuple(s["last_straight"].tolist())
    if changed_system:
        c.parameters.numbered[FIRST_SYSTEM] = float(c.system)
    if changed_tool:
        c.set_tool_parameters()


def hand_over_cycle(memory: CycleMemory, state: np.ndarray) -> None:
    """Put what a canned cycle has left into a record, (1,) STATE."""
    s = state[0]
    for name in _CYCLE:
        s["cycle_" + name] = getattr(memory, name)
    s["cycle_initial"] = math.nan if memory.initial is None else memory.initial


def give_back_cycle(memory: CycleMemory, state: np.ndarray) -> None:
    """Put it back from a record, (1,) STATE."""
    s = state[0]
    for name in _CYCLE:
        setattr(memory, name, float(s["cycle_" + name]))
    initial = float(s["cycle_initial"])
    memory.initial = None if math.isnan(initial) else initial


def note(c: Controller, line: int, tenths: int) -> None:
    """List an M code as irrelevant to geometry."""
    name = f"M{tenths // 10}"
    c.notes[(line, name)] = CODES[name].text
