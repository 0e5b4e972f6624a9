"""Events of a stretch of lines as columns: what compiled code says beside the moves."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

__all__ = ["EVENT", "EVENT_NAMES", "WIDE", "StretchEvents"]

#: names by their numbers in the column ``name``
EVENT_NAMES = ("set_feed_rate", "spindle", "set_feed_mode", "set_plane", "change_tool",
               "set_xy_rotation", "path_control", "tool_offset", "set_g5x_offset",
               "set_g92_offset", "comment")  # fmt: skip
#: values of the events that have more than one; ``value`` is then a row of `StretchEvents.wide`
WIDE = {"path_control": 2, "tool_offset": 6, "set_g5x_offset": 7, "set_g92_offset": 6}
_WHOLE = frozenset(("set_feed_mode", "set_plane", "change_tool"))

#: one event; the value of a comment is the offset of its first byte
EVENT = np.dtype([("row", "i8"), ("value", "f8"), ("line", "i4"), ("name", "i4")])


@dataclass(frozen=True)
class StretchEvents:
    """Events of a stretch, in order; it iterates over the same tuples as `Record.events`.

    Attributes
    ----------
    table : (E,) EVENT
    wide : (W, 7) float64
        Values of events that have several.
    text : bytes
        The program, from which comments are taken.
    """

    table: np.ndarray
    wide: np.ndarray
    text: bytes

    def __len__(self) -> int:
        return len(self.table)

    def __iter__(self) -> Iterator[tuple]:
        for row, value, line, number in self.table.tolist():
            name = EVENT_NAMES[number]
            yield row, line, name, *self._values(name, value)

    def different(
        self, names: Collection[str]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[tuple]]:
        """Events of some names, in order: rows, lines and which of the different ones, (E,) each;
        and name and values of those.
        """
        wanted = np.array([name in names for name in EVENT_NAMES])
        events = self.table[wanted[self.table["name"]]]
        which, told = np.zeros(len(events), np.int64), []
        for number in np.unique(events["name"]).tolist():
            of_name, name = np.flatnonzero(events["name"] == number), EVENT_NAMES[number]
            bits = np.ascontiguousarray(events["value"][of_name]).view(np.int64)
            values, place = np.unique(bits, return_inverse=True)
            which[of_name] = place + len(told)
            told += [(name, *self._values(name, v)) for v in values.view(np.float64).tolist()]
        return events["row"], events["line"], which, told

    def _values(self, name: str, value: float) -> tuple:
        if name == "comment":
            start = int(value)
            return (self.text[start : self.text.index(b")", start)].decode("latin-1"),)
        if name not in WIDE:
            return (int(value) if name in _WHOLE else value,)
        values = self.wide[int(value), : WIDE[name]].tolist()
        return (int(values[0]), *values[1:]) if name == "set_g5x_offset" else tuple(values)

    def of(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Rows, (E,) int64, and values, (E, V) float64, of the events of one name."""
        if name not in EVENT_NAMES or name == "comment":
            return np.zeros(0, np.int64), np.zeros((0, 0))
        rows = self.table[self.table["name"] == EVENT_NAMES.index(name)]
        value = rows["value"]
        if name in WIDE:
            return rows["row"], self.wide[value.astype(np.int64), : WIDE[name]]
        return rows["row"], value[:, None]
