"""Variables of custom macro B: local, common, and those of the system."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from gcode.errors import ProgramError
from gcode.state.controller import Controller
from gcode.state.tools import ToolEntry
from gcode.text.parameters import system_base

__all__ = ["LOCALS", "MacroVariables", "OffsetColumn", "OffsetColumns"]

LOCALS = range(1, 34)
_COMMON = (range(100, 200), range(500, 1000))
_FIRST_SYSTEM = 5221  #: #5221 to #5226 are G54
_AXES = "xyzabc"
_SYSTEMS = 6  #: G54 to G59 have variables of their own


@dataclass(frozen=True)
class OffsetColumn:
    """Variables of one column of the offset memory.

    Attributes
    ----------
    first : int
        Variable of number 1.
    name : str
        Attribute of `gcode.ToolEntry`.
    count : int
    """

    first: int
    name: str
    count: int = 200


OffsetColumns = tuple[OffsetColumn, ...]


class MacroVariables:
    """Values by number; NaN is <null>.

    Parameters
    ----------
    controller : Controller
    columns : tuple of OffsetColumn
        Where the offset memory is found.
    radius_in_d : bool
        D holds radii.
    counters : range
        Variables of times and tool life, which read as zero.
    common_again : range
        Further numbers of the common variables: its first one is that of #0.
    """

    def __init__(
        self, controller: Controller, columns: OffsetColumns, *, radius_in_d: bool,
        counters: range = range(0), common_again: range = range(0),
    ) -> None:  # fmt: skip
        self.controller, self.columns, self.radius_in_d = controller, columns, radius_in_d
        self.counters, self._again = counters, common_again
        self.locals: dict[int, float] = {}
        self.common: dict[int, float] = {}
        self.external_mm = [0.0] * 6
        self.modal: dict[int, Callable[[], float]] = {}
        #: writes an axis of a work offset: its number, the letter, program units
        self.write_offset: Callable[[int, str, float], None] | None = None

    def get(self, key: int | str) -> float:
        """Read a variable."""
        if key == 0:
            return math.nan
        if key in LOCALS:
            return self.locals.get(key, math.nan)
        if any(key in some for some in _COMMON):
            return self.common.get(key, math.nan)
        if key in self._again:
            return self.common.get(key - self._again.start, math.nan)
        return self._system(int(key))

    def set(self, key: int, value: float) -> None:
        """Write a variable; raises ProgramError for one that cannot be written."""
        if key in LOCALS:
            self._put(self.locals, key, value)
        elif any(key in some for some in _COMMON):
            self._put(self.common, key, value)
        elif key in self._again:
            self._put(self.common, key - self._again.start, value)
        elif key == 3000:
            raise ProgramError(f"the program raises alarm {value:g} (#3000)")
        elif 3001 <= key <= 3902:
            self.controller.note(f"#{key}", "clock, counters and messages of the control")
        elif not self._set_offset(key, value):
            raise ProgramError(
                f"system variable #{key} cannot be written",
                accepted="#1 to #33, #100 to #199, #500 to #999, offsets",
            )

    @staticmethod
    def _put(values: dict[int, float], key: int, value: float) -> None:
        if math.isnan(value):
            values.pop(key, None)
        else:
            values[key] = value

    def _system(self, key: int) -> float:
        if key in self.modal:
            return self.modal[key]()
        place = self._place(key)
        if place is not None:
            return place
        column = self._column(key)
        if column is not None:
            entry = self.controller.offsets.get(key - column.first + 1, ToolEntry())
            return getattr(entry, column.name) * self._factor(column) / self.controller.unit_mm
        if key in self.counters:
            self.controller.note(f"#{key}", "counter of times and tool life, taken as zero")
            return 0.0
        raise ProgramError(
            f"system variable #{key} is not read",
            accepted="positions #5001 ..., work offsets #5201 ..., tool offsets, modes #4001 ...",
        )

    def _factor(self, column: OffsetColumn) -> float:
        return 0.5 if self.radius_in_d and column.name.startswith("diameter") else 1.0

    def _column(self, key: int) -> OffsetColumn | None:
        return next((c for c in self.columns if c.first <= key < c.first + c.count), None)

    def _place(self, key: int) -> float | None:
        """Positions and work offsets, X Y Z."""
        c = self.controller
        for first, values in (
            (5001, c.position), (5041, c.position), (5061, c.position),
            (5021, c.machine_position()), (5201, c.to_program(self.external_mm)),
            (5081, c.tool_offset),
        ):  # fmt: skip
            if first <= key < first + 6:
                return values[key - first]
        system, axis = divmod(key - _FIRST_SYSTEM, 20)
        if 0 <= system < _SYSTEMS and axis < 6:
            stored = c.to_program(c.parameters.vector(system_base(system + 1)))
            return stored[axis] - c.to_program(self.external_mm)[axis]
        return None

    def _set_offset(self, key: int, value: float) -> bool:
        system, axis = divmod(key - _FIRST_SYSTEM, 20)
        if -1 <= system < _SYSTEMS and axis < len(_AXES) and self.write_offset is not None:
            self.write_offset(system + 1, _AXES[axis], value)
            return True
        column = self._column(key)
        if column is None:
            return False
        c, number = self.controller, key - column.first + 1
        entry = c.offsets.get(number, ToolEntry())
        size = value * c.unit_mm / self._factor(column)
        c.offsets[number] = replace(entry, **{column.name: size})
        return True
