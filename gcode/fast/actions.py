"""What words make a control do, in compiled code: the same operations in the same order.

Each function is the counterpart of one in `gcode.control.interpreter`, `gcode.motion.frames` or
`gcode.motion.interpolation`. Those that can be refused tell whether they were obeyed; what they
have changed until then is taken back by the caller, and the interpreter finds the words to say.
"""

from __future__ import annotations

import math

import numpy as np

from gcode.fast.compiled import njit_part
from gcode.fast.lane_output import write_dwell, write_event, write_note, write_row, write_vector
from gcode.fast.line_words import bit
from gcode.geometry import arc_centre
from gcode.state.record import Call
from gcode.state.stretch_events import EVENT_NAMES

__all__ = ["after_tool_change", "change_tool", "coolant", "feed_per_minute", "go", "letters_fit",
           "move", "pause", "select_plane", "select_system", "select_tool", "set_feed",
           "set_path_control", "set_speed", "set_tool_length", "spindle"]  # fmt: skip

_TRAVERSE, _FEED, _ARC, _DWELL, _CHANGE = (
    int(Call.TRAVERSE), int(Call.FEED), int(Call.ARC), int(Call.DWELL), int(Call.CHANGE_TOOL)
)  # fmt: skip
(_SET_FEED, _SPINDLE, _FEED_MODE, _PLANE, _TOOL, _ROTATION, _CONTROL, _TOOL_OFFSET, _G5X,
 _G92) = range(EVENT_NAMES.index("comment"))  # fmt: skip

_X, _Y, _A, _P, _R, _I = (ord(letter) - ord("a") for letter in "xyapri")
_LINEAR, _AXES, _IJK, _RADIUS, _TURNS = (bit(w) for w in ("xyz", "xyzabc", "ijk", "r", "p"))
#: letters that stand only beside a code that takes them
_OPTIONAL = bit("dhijklpqr")

_distance = njit_part(arc_centre.distance)
_radii_differ = njit_part(arc_centre.radii_differ)
_centre_of_radius = njit_part(arc_centre.centre_of_radius)


@njit_part
def _letter_of_axis(axis):  # pragma: no cover - compiled
    return _X + axis if axis < 3 else _A + axis - 3


@njit_part
def rotate(point, angle_deg):  # pragma: no cover - compiled
    """Turn X and Y of `point`, (6,), in place about Z."""
    angle = math.radians(angle_deg)
    cosine, sine = math.cos(angle), math.sin(angle)
    x, y = point[0], point[1]
    point[0], point[1] = x * cosine - y * sine, x * sine + y * cosine


@njit_part
def after_tool_change(s):  # pragma: no cover - compiled
    """What the block behind a tool change finds."""
    if s.refresh:
        s.refresh = 0
        s.loaded = s.tool
        if s.preview:
            for axis in range(6):
                s.position[axis] = s.last_straight[axis]


@njit_part
def set_feed(s, out, feed):  # pragma: no cover - compiled
    """F."""
    s.feed = feed
    s.feed_mm_per_min = feed * s.unit_mm
    write_event(s, out, _SET_FEED, s.feed_mm_per_min)


@njit_part
def feed_per_minute(s, out):  # pragma: no cover - compiled
    """G94."""
    write_event(s, out, _FEED_MODE, 0.0)
    set_feed(s, out, 0.0)


@njit_part
def _say_spindle(s, out):  # pragma: no cover - compiled
    write_event(s, out, _SPINDLE, s.spindle * s.speed)


@njit_part
def set_speed(s, out, speed):  # pragma: no cover - compiled
    """S."""
    s.speed = speed
    _say_spindle(s, out)


@njit_part
def _place_of(numbers, number):  # pragma: no cover - compiled
    """Index of a number among others, -1 for none."""
    place = np.searchsorted(numbers, number)
    return place if place < numbers.shape[0] and numbers[place] == number else -1


@njit_part
def select_tool(s, frames, number):  # pragma: no cover - compiled
    """T."""
    if number < 0.0 or number != math.floor(number):
        return False
    if (
        number != 0.0
        and frames.magazine.shape[0]
        and (_place_of(frames.magazine, np.int64(number)) < 0)
    ):
        return False
    s.selected_tool = np.int64(number)
    return True


@njit_part
def change_tool(s, out):  # pragma: no cover - compiled
    """M6."""
    if s.selected_tool < 0:
        return False
    s.spindle = 0
    _say_spindle(s, out)
    write_event(s, out, _TOOL, s.selected_tool)
    write_row(s, out, _CHANGE)
    s.tool = s.selected_tool
    s.refresh = 1
    return True


@njit_part
def spindle(s, out, code):  # pragma: no cover - compiled
    """M3, M4, M5."""
    s.spindle = 1 if code == 3 else -1 if code == 4 else 0
    _say_spindle(s, out)


@njit_part
def coolant(s, out, code):  # pragma: no cover - compiled
    """M7, M8, M9."""
    write_note(s, out, 10 * code)
    s.mist = 1 if code == 7 else 0 if code == 9 else s.mist
    s.flood = 1 if code == 8 else 0 if code == 9 else s.flood


@njit_part
def pause(s, out, seconds):  # pragma: no cover - compiled
    """G4."""
    write_dwell(s, out, _DWELL, seconds)


@njit_part
def select_plane(s, out, tenths):  # pragma: no cover - compiled
    """G17, G18, G19: 1, 3, 2."""
    s.plane = 1 if tenths == 170 else 3 if tenths == 180 else 2
    write_event(s, out, _PLANE, s.plane)


@njit_part
def set_path_control(s, out, tenths, tolerance):  # pragma: no cover - compiled
    """G61, G61.1, G64."""
    if s.wide == out.wide.shape[0]:
        s.is_full = 1
        return
    s.path_control = tenths
    out.wide[s.wide, 0] = tenths / 10.0
    out.wide[s.wide, 1] = tolerance * s.unit_mm
    write_event(s, out, _CONTROL, s.wide)
    s.wide += 1


@njit_part
def set_tool_length(s, frames, out, number):  # pragma: no cover - compiled
    """G43 with a number of the offset memory, or G49 with -1."""
    place = _place_of(frames.numbers, s.loaded if number == 0 else number)
    if number > 0 and place < 0:
        return False
    scale = s.machine_unit_mm / s.unit_mm
    change = s.last  # room: what is there is put back
    before = (change[0], change[1], change[2], change[3], change[4], change[5])
    for axis in range(6):
        offset = frames.offsets[place, axis] if number >= 0 and place >= 0 else 0.0
        if number >= 0 and axis < 3:
            offset = offset / s.machine_unit_mm * scale
        change[axis] = s.tool_offset[axis] - offset
        s.tool_offset[axis] = offset
    rotate(change, -s.rotation_deg)
    for axis in range(6):
        s.position[axis] += change[axis]
        change[axis] = before[axis]
    write_vector(s, out, _TOOL_OFFSET, 0, s.tool_offset)
    return True


@njit_part
def select_system(s, frames, out, system):  # pragma: no cover - compiled
    """G54 to G59.3: 1 to 9."""
    if system == s.system:
        return
    scale = s.machine_unit_mm / s.unit_mm
    stored, point = frames.systems[system - 1], s.position
    for axis in range(6):
        point[axis] = point[axis] + s.g92[axis]
    rotate(point, s.rotation_deg)
    for axis in range(6):
        origin = stored[axis] * scale if axis < 3 else stored[axis]
        point[axis] = point[axis] + s.origin[axis] + 0.0 - origin
        s.origin[axis] = origin
    rotate(point, -stored[6])
    if frames.applied[0] != 0.0:
        for axis in range(6):
            applied = frames.applied[axis + 1]
            point[axis] = point[axis] - (applied * scale if axis < 3 else applied)
    s.system = system
    s.rotation_deg = stored[6]
    write_vector(s, out, _G5X, system, s.origin)
    write_vector(s, out, _G92, 0, s.g92)
    write_event(s, out, _ROTATION, s.rotation_deg)


@njit_part
def letters_fit(letters, taken):  # pragma: no cover - compiled
    """Whether no letter stands there without a code that takes it."""
    return letters & _OPTIONAL & ~taken == 0


@njit_part
def go(s, out, call):  # pragma: no cover - compiled
    """A move whose end is already the position."""
    for axis in range(6):
        s.last[axis] = s.position[axis] * (s.unit_mm if axis < 3 else 1.0)
    if call != _ARC:
        for axis in range(6):
            s.last_straight[axis] = s.position[axis]
    write_row(s, out, call)


@njit_part
def _block_end(w, s):  # pragma: no cover - compiled
    """Move the position to where the block ends."""
    for axis in range(6):
        letter = _letter_of_axis(axis)
        said = w.seen & (1 << letter) != 0
        if s.absolute:
            s.position[axis] = w.value[letter] if said else s.position[axis]
        else:
            s.position[axis] = s.position[axis] + (w.value[letter] if said else 0.0)


@njit_part
def move(w, s, out, motion):  # pragma: no cover - compiled
    """G0 to G3, by their numbers times ten; tells whether it was obeyed."""
    s.cycle_initial = np.nan
    if motion >= 20:
        return _arc(w, s, out, motion)
    s.straight_only = 0
    if motion == 10 and s.feed == 0.0:
        return False
    s.motion = motion
    _block_end(w, s)
    go(s, out, _FEED if motion == 10 else _TRAVERSE)
    return True


@njit_part
def _arc(w, s, out, motion):  # pragma: no cover - compiled
    first = 0 if s.plane == 1 else 1 if s.plane == 2 else 2
    second, axial = (first + 1) % 3, (first + 2) % 3
    by_radius, by_centre = w.seen & _RADIUS != 0, w.seen & _IJK != 0
    if s.straight_only or by_radius == by_centre or s.feed == 0.0 or w.seen & (1 << (_I + axial)):
        return False
    missing = not (w.seen & (1 << (_I + first)) and w.seen & (1 << (_I + second)))
    if by_centre and missing and s.arc_absolute:
        return False
    if by_radius and not w.seen & ((1 << (_X + first)) | (1 << (_X + second))):
        return False
    turns = w.value[_P] if w.seen & _TURNS else 1.0
    if turns != math.floor(turns) or turns < 1.0:
        return False
    x0, y0 = s.position[first], s.position[second]
    _block_end(w, s)
    s.motion = motion
    x1, y1 = s.position[first], s.position[second]
    if by_radius:
        radius, half = w.value[_R], _distance((x1 + x0) / 2.0 - x1, (y1 + y0) / 2.0 - y1)
        if (x0 == x1 and y0 == y1) or half - abs(radius) > s.zero_radius or radius == 0.0:
            return False
        cx, cy = _centre_of_radius(x0, y0, x1, y1, half, radius, motion == 20)
    else:
        cx = w.value[_I + first] if w.seen & (1 << (_I + first)) else 0.0
        cy = w.value[_I + second] if w.seen & (1 << (_I + second)) else 0.0
        if not s.arc_absolute:
            cx, cy = x0 + cx, y0 + cy
        start, end = _distance(cx - x0, cy - y0), _distance(cx - x1, cy - y1)
        if min(start, end) < s.zero_radius:
            return False
        if _radii_differ(start, end, s.allowed, s.ceiling, s.relative):
            return False
    if s.arcs == out.arcs.shape[0]:
        s.is_full = 1
        return False
    arc, unit = out.arcs[s.arcs], s.unit_mm
    arc[0], arc[1], arc[2], arc[3] = s.rows, s.plane, x1 * unit, y1 * unit
    arc[4], arc[5], arc[6] = cx * unit, cy * unit, -turns if motion == 20 else turns
    arc[7] = s.position[axial] * unit
    s.arcs += 1
    go(s, out, _ARC)
    return True
