"""Canonical calls as text: what the program says to the machine, one call a line.

The format is that of LinuxCNC's canonical functions with all digits: source line, call,
arguments; lengths in mm, angles in degrees, nine axes of which U V W are zero. Positions are in
the active work system; offsets are calls of their own.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gcode.program import Program, read_program
from gcode.state.record import Call, Path, Record

__all__ = ["canon_calls", "canon_lines", "canon_text"]

CanonCall = tuple[int, str, tuple]

_NAMES = {Call.TRAVERSE: "straight_traverse", Call.FEED: "straight_feed", Call.ARC: "arc_feed",
          Call.DWELL: "dwell", Call.PROBE: "straight_probe", Call.TAP: "rigid_tap"}  # fmt: skip

#: Events that have a canonical call of their own name.
_SAID = frozenset(("set_g5x_offset", "set_g92_offset", "set_xy_rotation", "tool_offset",
                   "set_feed_rate", "set_plane", "change_tool", "comment", "message"))  # fmt: skip
_NINE_AXES = frozenset(("set_g5x_offset", "set_g92_offset", "tool_offset"))
_UVW = (0.0, 0.0, 0.0)
#: rows that become text at once
_ROWS = 1 << 16


def _record(program: Program) -> Record:
    """Read once more, with the position after a tool change as LinuxCNC alone takes it."""
    return read_program(program.source, **dict(program.options, dialect=program.dialect,
                                               preview=True)).record  # fmt: skip


def canon_calls(program: Program) -> Iterator[CanonCall]:
    """Canonical calls (line, name, arguments) in the order in which they are made.

    Parameters
    ----------
    program : Program
        Read with `read_program`; it is read once more, with the position after a tool change
        taken as LinuxCNC's stand-alone interpreter takes it.
    """
    record = _record(program)
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
        yield line, name, (*values, *_UVW) if name in _NINE_AXES else tuple(values)


def canon_lines(program: Program) -> Iterator[str]:
    """Canonical calls as text, for example ``12 straight_feed 10.0 0.0 -1.0 0.0 ...``."""
    for text in canon_text(program):
        yield from text.split("\n")[:-1]


def canon_text(program: Program) -> Iterator[str]:
    """The lines of `canon_lines`, each with its end, many at once."""
    record = _record(program)
    path = record.path()
    event_row, events = _lines_of_events(record)
    for first in range(0, max(len(record), 1), _ROWS):
        last = first + _ROWS if first + _ROWS < len(record) else len(record) + 1
        begin, end = np.searchsorted(event_row, [first, last])
        rows, said = _lines_of_rows(record, path, slice(first, last))
        lines = np.full(len(rows) + end - begin, "", object)
        place = event_row[begin:end] - first
        lines[np.arange(end - begin) + place] = events[begin:end]
        shown = np.arange(len(rows))
        lines[shown + np.searchsorted(place, shown, side="right")] = np.where(said, rows, "")
        yield "".join(lines.tolist())


def _lines_of_events(record: Record) -> tuple[np.ndarray, np.ndarray]:
    """Row and line of every event that is said, (E,) int64 and (E,) object."""
    rows, texts = [], []
    for row, *event in record.said_events(_SAID):
        for line, name, values in _event((row, *event)):
            words = (repr(v + 0.0) if isinstance(v, float) else str(v) for v in values)
            rows.append(row)
            texts.append(" ".join([str(line), name, *words]) + "\n")
    found = np.empty(len(texts), object)
    found[:] = texts
    return np.array(rows, np.int64), found


def _lines_of_rows(record: Record, path: Path, part: slice) -> tuple[np.ndarray, np.ndarray]:
    """Lines of some rows, (R,) object, and which of them are said, (R,) bool."""
    call, line = path.call[part], path.line[part]
    lines = np.full(len(call), "", object)
    arcs, dwells = (_of_rows(table, part) for table in (record.arcs, record.dwells))
    numbers = np.column_stack([path.point_mm[part], path.rotary_deg[part], np.zeros_like(
        path.rotary_deg[part])])  # fmt: skip
    for kind, name in _NAMES.items():
        rows = np.flatnonzero(call == kind)
        if not len(rows):
            continue
        if kind == Call.ARC:
            turns = [str(n) for n in arcs[:, 6].astype(np.int64).tolist()]
            texts = [f"{ends} {n} {rest}" for ends, n, rest in
                     zip(_words(arcs[:, 2:6]), turns,
                         _words(np.column_stack([arcs[:, 7], numbers[rows, 3:]])),
                         strict=True)]  # fmt: skip
        elif kind == Call.DWELL:
            texts = _words(dwells[:, 1:])
        else:
            texts = _words(numbers[rows, :3] if kind == Call.TAP else numbers[rows])
        lines[rows] = [f"{n} {name} {text}\n"
                       for n, text in zip(line[rows].tolist(), texts, strict=True)]  # fmt: skip
    return lines, call != Call.CHANGE_TOOL


def _of_rows(table: np.ndarray, part: slice) -> np.ndarray:
    """The rows of a table of a record whose first column is in a range."""
    return table[slice(*np.searchsorted(table[:, 0], [part.start, part.stop]))]


def _words(values: np.ndarray) -> list[str]:
    """Numbers of every row, (R, V), with a blank between them and all digits."""
    if not len(values):
        return []
    moved = np.flatnonzero(values.any(axis=0))
    told = int(moved[-1]) + 1 if len(moved) else 1  # behind it are zeros alone
    tail = " 0.0" * (values.shape[1] - told)
    rows = repr((values[:, :told] + 0.0).tolist())[2:-2].replace(",", "").split("] [")
    return [row + tail for row in rows] if tail else rows
