"""Canonical calls as text: what the program says to the machine, one call a line.

The format is that of LinuxCNC's canonical functions with all digits: source line, call,
arguments; lengths in mm, angles in degrees, nine axes of which U V W are zero. Positions are in
the active work system; offsets are calls of their own.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from gcode.program import Program, read_program
from gcode.state.record import Call, Record

__all__ = ["canon_calls", "canon_lines", "canon_text"]

CanonCall = tuple[int, str, tuple]

_NAMES = {Call.TRAVERSE: "straight_traverse", Call.FEED: "straight_feed", Call.ARC: "arc_feed",
          Call.DWELL: "dwell", Call.PROBE: "straight_probe", Call.TAP: "rigid_tap"}  # fmt: skip

#: Events that have a canonical call of their own name.
_SAID = frozenset(("set_g5x_offset", "set_g92_offset", "set_xy_rotation", "tool_offset",
                   "set_feed_rate", "set_plane", "change_tool", "comment", "message"))  # fmt: skip
_NINE_AXES = frozenset(("set_g5x_offset", "set_g92_offset", "tool_offset"))
_UVW = (0.0, 0.0, 0.0)
#: rows that become text at once, and from how many on compiled code is worth loading
_ROWS, _COMPILED_FROM = 1 << 14, 4_000


def _record(program: Program) -> Record:
    """The record with the position after a tool change as LinuxCNC alone takes it."""
    if program.options["preview"]:
        return program.record
    return read_program(program.source, **dict(program.options, dialect=program.dialect,
                                               preview=True)).record  # fmt: skip


def canon_calls(program: Program) -> Iterator[CanonCall]:
    """Canonical calls (line, name, arguments) in the order in which they are made.

    Parameters
    ----------
    program : Program
        Read with `read_program`. Unless that was a ``preview`` it is read once more, with the
        position after a tool change taken as LinuxCNC's stand-alone interpreter takes it.
    """
    return _calls(_record(program))


def _calls(record: Record) -> Iterator[CanonCall]:
    path = record.path()
    arcs = {int(arc[0]): (*arc[2:6], int(arc[6]), arc[7]) for arc in record.arcs.tolist()}
    dwells = {int(row): seconds for row, seconds in record.dwells.tolist()}
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
        yield line, name, _said(name, values)


def _said(name: str, values: Sequence) -> tuple:
    """The arguments of an event's call."""
    return (*values, *_UVW) if name in _NINE_AXES else tuple(values)


def canon_lines(program: Program) -> Iterator[str]:
    """Canonical calls as text, for example ``12 straight_feed 10.0 0.0 -1.0 0.0 ...``."""
    for text in canon_text(program):
        yield from text.split("\n")[:-1]


def canon_text(program: Program) -> Iterator[str]:
    """The lines of `canon_lines`, each with its end, many at once."""
    record = _record(program)
    if len(record) < _COMPILED_FROM:
        yield "".join(f"{line} {_words(name, values)}" for line, name, values in _calls(record))
    else:
        yield from _compiled_text(record)


def _words(name: str, values: tuple) -> str:
    """A name and its values, with all digits; zero has no sign."""
    words = (repr(v + 0.0) if isinstance(v, float) else str(v) for v in values)
    return " ".join([name, *words]) + "\n"


def _compiled_text(record: Record) -> Iterator[str]:
    """The text of a long record, some thousand rows at a time."""
    from gcode.fast.canon_rows import Rows, Said, room_for, write_calls

    path, events = record.path(), record.said_events(_SAID)
    texts = [_words(name, _said(name, values)).encode() for name, *values in events.told]
    size = np.fromiter(map(len, texts), np.int64, len(texts))
    begin = np.cumsum(size) - size
    letters = np.frombuffer(b"".join(texts) or b" ", np.uint8)
    names = np.array([_NAMES.get(call, "") for call in Call], bytes)
    names = names.view(np.uint8).reshape(len(Call), -1)
    for first in range(0, max(len(record), 1), _ROWS):
        last = first + _ROWS if first + _ROWS < len(record) else len(record) + 1
        part, told = slice(first, last), slice(*np.searchsorted(events.row, [first, last]))
        arcs, dwells = (_of_rows(table, part) for table in (record.arcs, record.dwells))
        rows = Rows(path.call[part], path.line[part], path.point_mm[part], path.rotary_deg[part],
                    arcs, dwells)  # fmt: skip
        which = events.which[told]
        said = Said(events.row[told] - first, events.line[told], begin[which], size[which], letters)
        text = room_for(rows, said, names)
        yield text[: write_calls(text, rows, said, names)].tobytes().decode()


def _of_rows(table: np.ndarray, part: slice) -> np.ndarray:
    """The rows of a table of a record whose first column is in a range."""
    return table[slice(*np.searchsorted(table[:, 0], [part.start, part.stop]))]
