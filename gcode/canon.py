"""Canonical calls as text: what the program says to the machine, one call a line.

The format is that of LinuxCNC's canonical functions with all digits: source line, call,
arguments; lengths in mm, angles in degrees, nine axes of which U V W are zero. Positions are in
the active work system; offsets are calls of their own.
"""

from __future__ import annotations

from collections.abc import Iterator

from gcode.program import Program, read_program
from gcode.state.record import Call

__all__ = ["canon_calls", "canon_lines"]

CanonCall = tuple[int, str, tuple]

_NAMES = {Call.TRAVERSE: "straight_traverse", Call.FEED: "straight_feed", Call.ARC: "arc_feed",
          Call.DWELL: "dwell", Call.PROBE: "straight_probe", Call.TAP: "rigid_tap"}  # fmt: skip

#: Events that have a canonical call of their own name.
_SAID = frozenset(("set_g5x_offset", "set_g92_offset", "set_xy_rotation", "tool_offset",
                   "set_feed_rate", "set_plane", "change_tool", "comment", "message"))  # fmt: skip
_NINE_AXES = frozenset(("set_g5x_offset", "set_g92_offset", "tool_offset"))
_UVW = (0.0, 0.0, 0.0)


def canon_calls(program: Program) -> Iterator[CanonCall]:
    """Canonical calls (line, name, arguments) in the order in which they are made.

    Parameters
    ----------
    program : Program
        Read with `read_program`; it is read once more, block by block, with the position after
        a tool change taken as LinuxCNC's stand-alone interpreter takes it.
    """
    options = dict(program.options, dialect=program.dialect, fast=False, preview=True)
    record = read_program(program.source, **options).record
    path = record.path()
    arcs = {arc[0]: arc[2:] for arc in record.arcs}
    dwells = dict(record.dwells)
    events = iter([*record.events, (len(record) + 1, 0, "")])
    event = next(events)
    columns = (path.call.tolist(), path.line.tolist(), path.point_mm.tolist(),
               path.rotary_deg.tolist())  # fmt: skip
    for row, (call, line, point, rotary) in enumerate(zip(*columns, strict=True)):
        while event[0] <= row:
            yield from _event(event)
            event = next(events)
        if call == Call.CHANGE_TOOL:
            continue
        if call == Call.ARC:
            values = (*arcs[row], *rotary, *_UVW)
        elif call == Call.DWELL:
            values = (dwells[row],)
        elif call == Call.TAP:
            values = tuple(point)
        else:
            values = (*point, *rotary, *_UVW)
        yield line, _NAMES[call], values
    while event[0] <= len(record):
        yield from _event(event)
        event = next(events)


def _event(event: tuple) -> Iterator[CanonCall]:
    _, line, name, *values = event
    if name in _SAID:
        yield line, name, (*values, *_UVW) if name in _NINE_AXES else tuple(values)


def canon_lines(program: Program) -> Iterator[str]:
    """Canonical calls as text, for example ``12 straight_feed 10.0 0.0 -1.0 0.0 ...``."""
    for line, name, values in canon_calls(program):
        words = (repr(v + 0.0) if isinstance(v, float) else str(v) for v in values)
        yield " ".join([str(line), name, *words])
