"""Canonical calls as text, by compiled code: rows of a record, and what is said before them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcode.fast.compiled import njit_kernel, njit_part
from gcode.state.record import Call
from gcode.writing.shortest_decimal import WIDEST, write_float, write_whole

__all__ = ["Rows", "Said", "room_for", "write_calls"]

_ARC, _DWELL, _TAP = int(Call.ARC), int(Call.DWELL), int(Call.TAP)
_BLANK, _NEW_LINE = ord(" "), ord("\n")
#: numbers behind the longest call, an arc: six of its own, six angles and zeros
_NUMBERS = 12


class Rows(NamedTuple):
    """Some rows of a record in order.

    Attributes
    ----------
    call : (N,) int8
    line : (N,) int32
    point_mm, rotary_deg : (N, 3) float64
    arcs : (A, 8) float64
        Of the arcs among them, as `Record.arcs`.
    dwells : (D, 2) float64
        Of the pauses among them, as `Record.dwells`.
    """

    call: np.ndarray
    line: np.ndarray
    point_mm: np.ndarray
    rotary_deg: np.ndarray
    arcs: np.ndarray
    dwells: np.ndarray


class Said(NamedTuple):
    """Events in order, each a source line and a text that stands in `letters`.

    Attributes
    ----------
    row : (E,) int64
        Counted from the first of the rows: the event stands before that row.
    line : (E,) int64
    begin, size : (E,) int64
        Where in `letters` its text with the new line lies.
    letters : (L,) uint8
    """

    row: np.ndarray
    line: np.ndarray
    begin: np.ndarray
    size: np.ndarray
    letters: np.ndarray


def room_for(rows: Rows, said: Said, names: np.ndarray) -> np.ndarray:
    """Bytes enough for the text of rows and events."""
    row = (_NUMBERS + 1) * (WIDEST + 1) + names.shape[1] + 2
    return np.empty(len(rows.call) * row + len(said.row) * (WIDEST + 1) + int(said.size.sum()),
                    np.uint8)  # fmt: skip


@njit_part
def _write_number(text, at, value):  # pragma: no cover - compiled
    """A number behind a blank; zero has no sign."""
    text[at] = _BLANK
    return write_float(text, at + 1, value + 0.0)


@njit_part
def _write_arc(text, at, arc):  # pragma: no cover - compiled
    """Ends, centre, turns and axial end."""
    for k in range(2, 6):
        at = _write_number(text, at, arc[k])
    text[at] = _BLANK
    at = write_whole(text, at + 1, np.int64(arc[6]))
    return _write_number(text, at, arc[7])


@njit_part
def _write_event(text, at, said, event):  # pragma: no cover - compiled
    """An event's line and text."""
    at = write_whole(text, at, np.int64(said.line[event]))
    text[at] = _BLANK
    at += 1
    for k in range(said.begin[event], said.begin[event] + said.size[event]):
        text[at] = said.letters[k]
        at += 1
    return at


@njit_part
def _write_name(text, at, line, name):  # pragma: no cover - compiled
    """A source line and the name of a call."""
    at = write_whole(text, at, np.int64(line))
    text[at] = _BLANK
    at += 1
    for letter in name:
        if letter:
            text[at] = letter
            at += 1
    return at


@njit_kernel
def write_calls(text, rows, said, names):  # pragma: no cover - compiled
    """Write rows and events, one call a line.

    Parameters
    ----------
    text : (bytes,) uint8
        From `room_for`.
    rows : Rows
    said : Said
    names : (calls, letters) uint8
        Name of each `Call`, filled up with zeros; a row without one is left out.

    Returns
    -------
    int
        Bytes written.
    """
    at = event = arc = dwell = 0
    for row in range(rows.call.shape[0] + 1):
        while event < said.row.shape[0] and said.row[event] <= row:
            at = _write_event(text, at, said, event)
            event += 1
        if row == rows.call.shape[0] or names[rows.call[row], 0] == 0:
            continue
        call = rows.call[row]
        at = _write_name(text, at, rows.line[row], names[call])
        if call == _DWELL:
            at = _write_number(text, at, rows.dwells[dwell, 1])
            dwell += 1
        elif call == _ARC:
            at = _write_arc(text, at, rows.arcs[arc])
            arc += 1
        else:
            for axis in range(3):
                at = _write_number(text, at, rows.point_mm[row, axis])
        if call not in (_DWELL, _TAP):
            for axis in range(3):
                at = _write_number(text, at, rows.rotary_deg[row, axis])
            for _ in range(3):
                at = _write_number(text, at, 0.0)
        text[at] = _NEW_LINE
        at += 1
    return at
