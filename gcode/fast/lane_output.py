"""What compiled code writes: moves, arcs, pauses, events and notes of a stretch of lines."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcode.fast.compiled import njit_part
from gcode.state.record import Path, Record
from gcode.state.stretch_events import EVENT, StretchEvents

__all__ = ["Output", "new_output", "put_into", "write_dwell", "write_event", "write_note",
           "write_row", "write_vector"]  # fmt: skip

#: one move, in mm and degrees
ROW = np.dtype([("point", "f8", 3), ("rotary", "f8", 3), ("feed", "f8"),
                ("line", "i4"), ("call", "i4")])  # fmt: skip
#: rows, and events of several values, that are written before the interpreter takes them
_ROWS, _WIDE = 1 << 15, 1 << 12


class Output(NamedTuple):
    """Room for a stretch.

    Attributes
    ----------
    rows : (R,) ROW
    arcs : (R, 8) float64
        As `Record.arcs`.
    dwells : (R, 2) float64
    events : (2 R,) EVENT
    wide : (W, 7) float64
    notes : (R, 2) int64
        Line, and ten times the number of the M code.
    """

    rows: np.ndarray
    arcs: np.ndarray
    dwells: np.ndarray
    events: np.ndarray
    wide: np.ndarray
    notes: np.ndarray


def new_output() -> Output:
    """Empty room."""
    return Output(np.empty(_ROWS, ROW), np.empty((_ROWS, 8)), np.empty((_ROWS, 2)),
                  np.empty(2 * _ROWS, EVENT), np.empty((_WIDE, 7)),
                  np.empty((_ROWS, 2), np.int64))  # fmt: skip


def put_into(record: Record, output: Output, state: np.ndarray, text: bytes) -> None:
    """Append what has been written to a record."""
    s = state[0]
    rows, events = output.rows[: s["rows"]], output.events[: s["events"]].copy()
    if not len(rows) and not len(events):
        return
    path = Path(rows["call"].astype(np.int8), rows["line"].copy(), rows["point"].copy(),
                rows["rotary"].copy(), rows["feed"].copy())  # fmt: skip
    said = StretchEvents(events, output.wide[: s["wide"]].copy(), text)
    arcs, dwells = output.arcs[: s["arcs"]].copy(), output.dwells[: s["dwells"]].copy()
    record.stretch(path, arcs, dwells, said)


@njit_part
def write_row(s, out, call):  # pragma: no cover - compiled
    """A row that ends where the tool is."""
    if s.rows == out.rows.shape[0]:
        s.is_full = 1
        return
    row = out.rows[s.rows]
    for axis in range(3):
        row.point[axis] = s.last[axis]
        row.rotary[axis] = s.last[axis + 3]
    row.feed = s.feed_mm_per_min
    row.line = s.line
    row.call = call
    s.rows += 1


@njit_part
def write_dwell(s, out, call, seconds):  # pragma: no cover - compiled
    """A pause."""
    if s.dwells == out.dwells.shape[0]:
        s.is_full = 1
        return
    out.dwells[s.dwells, 0] = s.rows
    out.dwells[s.dwells, 1] = seconds
    s.dwells += 1
    write_row(s, out, call)


@njit_part
def write_event(s, out, name, value):  # pragma: no cover - compiled
    """An event with one value."""
    if s.events == out.events.shape[0]:
        s.is_full = 1
        return
    event = out.events[s.events]
    event.row = s.rows
    event.line = s.line
    event.name = name
    event.value = value
    s.events += 1


@njit_part
def write_vector(s, out, name, head, vector):  # pragma: no cover - compiled
    """An offset: three lengths and three angles, behind a number where `head` is not 0."""
    if s.wide == out.wide.shape[0]:
        s.is_full = 1
        return
    first = 1 if head else 0
    out.wide[s.wide, 0] = head
    for axis in range(6):
        out.wide[s.wide, first + axis] = vector[axis] * (s.unit_mm if axis < 3 else 1.0)
    write_event(s, out, name, s.wide)
    s.wide += 1


@njit_part
def write_note(s, out, tenths):  # pragma: no cover - compiled
    """An M code that changes no path."""
    if s.notes == out.notes.shape[0]:
        s.is_full = 1
        return
    out.notes[s.notes, 0] = s.line
    out.notes[s.notes, 1] = tenths
    s.notes += 1
