"""Canonical record: what the interpreter says to the machine, in order.

Positions are in the active work system, mm and degrees: machine point = R (point + G92) + G5x
+ tool offset. Moves are rows; everything else that the machine is told (offsets, feed, spindle,
modes) is an event that takes effect before the row with the same index.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from gcode.state.stretch_events import StretchEvents
from gcode.state.table import Table

__all__ = ["Call", "Path", "Record", "SaidEvents"]


class Call(IntEnum):
    """Canonical calls that take time."""

    TRAVERSE = 0
    FEED = 1
    ARC = 2
    DWELL = 3
    CHANGE_TOOL = 4
    PROBE = 5
    TAP = 6


@dataclass(frozen=True)
class Path:
    """Rows of a record as arrays, in the active work system.

    Attributes
    ----------
    call : (N,) int8
        A `Call`.
    line : (N,) int32
        1-based source line.
    point_mm : (N, 3) float64
        X Y Z of the end.
    rotary_deg : (N, 3) float64
        A B C of the end.
    feed_mm_per_min : (N,) float64
        Feed in force.
    """

    call: np.ndarray
    line: np.ndarray
    point_mm: np.ndarray
    rotary_deg: np.ndarray
    feed_mm_per_min: np.ndarray


@dataclass(frozen=True)
class SaidEvents:
    """Some events of a record, in order.

    Attributes
    ----------
    row, line : (E,) int64
        The row that they stand before, and the source line.
    which : (E,) int64
        Index into `told`.
    told : list of tuple
        Name and values; events that say the same may share one.
    """

    row: np.ndarray
    line: np.ndarray
    which: np.ndarray
    told: list[tuple]


class Record:
    """Rows and events of one program, made one by one or a stretch at a time."""

    def __init__(self) -> None:
        self.line = 0  #: line being obeyed
        self.unit_mm = 1.0
        self.feed_mm_per_min = 0.0
        self.rpm_of_feed: float | None = None  #: spindle speed where the feed is per revolution
        self.last = (0.0,) * 6  #: end of the last move in mm and degrees, in its own frame
        self.last_straight = (0.0,) * 6  #: the same of the last straight move, program units
        self._parts: list[Path] = []  # settled rows
        self._rows: list[tuple] = []  # rows since then: call, line, x, y, z, a, b, c, feed
        self._settled = 0
        self._arcs, self._dwells = Table(8), Table(2)
        self._events: list[list[tuple] | StretchEvents] = [[]]

    def __len__(self) -> int:
        """Return the number of rows."""
        return self._settled + len(self._rows)

    @property
    def arcs(self) -> np.ndarray:
        """All arcs, (A, 8) float64.

        Row, plane, first end, second end, first centre, second centre, turns, axial end; first
        and second axis X Y in G17, Z X in G18, Y Z in G19; turns negative clockwise.
        """
        return self._arcs.whole()

    @property
    def last_arc(self) -> np.ndarray | None:
        """The row of `arcs` of the last move, (8,); None where that is no arc."""
        arcs = self.arcs
        return arcs[-1] if len(arcs) and arcs[-1, 0] == len(self) - 1 else None

    @property
    def dwells(self) -> np.ndarray:
        """All pauses, (D, 2) float64: row, seconds."""
        return self._dwells.whole()

    @property
    def events(self) -> Iterator[tuple]:
        """All events in order: (row, line, name, values...)."""
        for part in self._events:
            yield from part

    def said_events(self, names: Collection[str]) -> SaidEvents:
        """Events of some names in order, each of the different ones told once."""
        row, line, which = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
        told: list[tuple] = []
        for part in self._events:
            if isinstance(part, StretchEvents):
                found = part.different(names)
            else:
                said = [event for event in part if event[2] in names]
                found = ([e[0] for e in said], [e[1] for e in said], range(len(said)),
                         [e[2:] for e in said])  # fmt: skip
            for column, values in zip((row, line), found[:2], strict=True):
                column.append(np.array(values, np.int64))
            which.append(np.array(found[2], np.int64) + len(told))
            told += found[3]
        return SaidEvents(*map(np.concatenate, (row, line, which)), told)

    def events_of(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Rows, (E,) int64, and values, (E, V) float64, of all events of one name."""
        rows, values = [np.zeros(0, np.int64)], []
        for part in self._events:
            if isinstance(part, StretchEvents):
                found = part.of(name)
            else:
                told = [event for event in part if event[2] == name]
                found = [event[0] for event in told], [event[3:] for event in told]
            if len(found[0]):
                rows.append(np.array(found[0], np.int64))
                values.append(np.array(found[1], np.float64))
        return np.concatenate(rows), np.concatenate(values) if values else np.zeros((0, 0))

    def straight(self, call: Call, position: list[float], *, line: int | None = None) -> None:
        """Append a straight move to `position`, program units and degrees."""
        unit = self.unit_mm
        x, y, z, a, b, c = position
        self.last = (x * unit, y * unit, z * unit, a, b, c)
        if call is not Call.ARC and call is not Call.TAP:
            self.last_straight = (x, y, z, a, b, c)
        self._row(call, self.line if line is None else line)

    def _row(self, call: Call, line: int) -> None:
        feed = self.feed_mm_per_min
        if self.rpm_of_feed is not None:
            feed *= self.rpm_of_feed
        self._rows.append((call, line, *self.last, feed))

    def _settle(self) -> None:
        if self._rows:
            table = np.array(self._rows, np.float64)
            self._parts.append(Path(table[:, 0].astype(np.int8), table[:, 1].astype(np.int32),
                                    table[:, 2:5], table[:, 5:8], table[:, 8]))  # fmt: skip
            self._settled += len(self._rows)
            self._rows = []

    def stretch(self, path: Path, arcs: np.ndarray, dwells: np.ndarray,
                events: StretchEvents) -> None:  # fmt: skip
        """Append what a stretch of lines has made: rows, arcs, dwells, events, counted from its own
        first row.
        """
        first = len(self)
        if len(path.call):
            self._settle()
            self._parts.append(path)
            self._settled += len(path.call)
        for table, part in (self._arcs, arcs), (self._dwells, dwells):
            part[:, 0] += first
            table.extend(part)
        if len(events):
            events.table["row"] += first
            self._events += [events, []]

    def path(self) -> Path:
        """All rows as arrays."""
        self._settle()
        if not self._parts:
            empty = np.zeros((0, 3))
            return Path(np.zeros(0, np.int8), np.zeros(0, np.int32), empty, empty, np.zeros(0))
        if len(self._parts) > 1:
            names = ("call", "line", "point_mm", "rotary_deg", "feed_mm_per_min")
            self._parts = [Path(*(_joined([getattr(part, name) for part in self._parts])
                                  for name in names))]  # fmt: skip
        return self._parts[0]

    def arc(
        self, plane: int, numbers: tuple, *, position: list[float], line: int | None = None
    ) -> None:
        """Append an arc.

        Parameters
        ----------
        plane : int
            1 XY, 2 YZ, 3 XZ.
        numbers : tuple
            First end, second end, first centre, second centre, turns, axial end.
        position : list of float
            The end once more as X Y Z A B C.
        line : int, optional
            Source line, where it is not the one being obeyed.
        """
        unit = self.unit_mm
        first, second, centre1, centre2, turns, axial = numbers
        self._arcs.append((len(self), plane, first * unit, second * unit, centre1 * unit,
                           centre2 * unit, turns, axial * unit))  # fmt: skip
        self.straight(Call.ARC, position, line=line)

    def dwell(self, seconds: float) -> None:
        """Append a pause."""
        self._dwells.append((len(self), seconds))
        self._row(Call.DWELL, self.line)

    def change_tool(self, number: int) -> None:
        """Append a tool change."""
        self.event("change_tool", number)
        self._row(Call.CHANGE_TOOL, self.line)

    def event(self, name: str, *values: object) -> None:
        """Append something that takes no time."""
        self._events[-1].append((len(self), self.line, name, *values))

    def offset(self, name: str, *head: int, values: list[float]) -> None:
        """Append an event with three lengths and three angles."""
        unit = self.unit_mm
        self.event(name, *head, *(v * unit for v in values[:3]), *values[3:])

    def set_feed(self, feed: float) -> None:
        """Append a feed in program units a minute (or a revolution)."""
        self.feed_mm_per_min = feed * self.unit_mm
        self.event("set_feed_rate", self.feed_mm_per_min)


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    """The parts as one; memory that nobody writes to, as for axes that stand, takes no room."""
    if any(part.any() or np.signbit(part).any() for part in parts):  # -0 is a number of its own
        return np.concatenate(parts)
    return np.zeros((sum(map(len, parts)), *parts[0].shape[1:]), parts[0].dtype)
