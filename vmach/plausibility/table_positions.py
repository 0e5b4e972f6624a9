"""Where a table lies along its axis: outside the travel, beyond its ends, or in a corner of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from vmach.base.note import Kind, Level, Note
from vmach.machine.component_errors import ComponentError, component_of
from vmach.machine.machine import Machine
from vmach.machine.tables.interpolation import Extrapolation

__all__ = ["position_notes"]

#: an axis may go a little beyond the travel that is stated; share of the travel, and mm
_BEYOND_SHARE, _BEYOND_MM = 0.05, 5.0
#: but no reading is made half a travel beyond its end
_IMPOSSIBLE_SHARE = 0.5
#: a table over less of the travel may be in metres or inches
_LEAST_COVERED_SHARE = 0.1
#: rounding of positions at the ends
_SLACK_MM = 1e-6

_BEYOND = {
    Extrapolation.REFUSE: "positions beyond are refused",
    Extrapolation.HOLD: "the end values hold beyond",
    Extrapolation.LINEAR: "the tangents go on beyond",
}


def position_notes(machine: Machine) -> Iterator[Note]:
    """A note on every table that does not span the travel of its axis, or goes beyond it."""
    for name, component in machine.components.items():
        axis = component_of(name)[1]
        low, high = machine.travel_mm[:, axis]
        found = _place_of(component, float(low), float(high))
        if found is not None:
            yield found
        if component.reverse and component.reverse_deviations is None and _has_sense(component):
            yield _unsaid_sense(name)


def _place_of(component: ComponentError, low: float, high: float) -> Note | None:
    first, last = component.range_mm
    travel = high - low
    overlap = min(last, high) - max(first, low)
    beyond = max(low - first, last - high)
    where = f"table {first:g} .. {last:g} mm, travel {low:g} .. {high:g} mm"
    common: dict[str, Any] = {"size": beyond, "unit": "mm"}
    subject = component.name
    if overlap <= _SLACK_MM or beyond > max(_IMPOSSIBLE_SHARE * travel, _BEYOND_MM):
        return Note(
            Level.REFUSED, Kind.POSITION, subject,
            f"{where}: the axis was never there",
            accepted="positions within the travel, in machine coordinates",
            hint=_remedy(component, low, high), **common,
        )  # fmt: skip
    if beyond > max(_BEYOND_SHARE * travel, _BEYOND_MM):
        return Note(
            Level.DOUBT, Kind.POSITION, subject, f"{where}: how did the axis get there?",
            hint=_remedy(component, low, high), **common,
        )  # fmt: skip
    if overlap < _LEAST_COVERED_SHARE * travel:
        return Note(
            Level.DOUBT, Kind.POSITION, subject,
            f"{where}: {100 * overlap / travel:.2g} % of it; {_BEYOND[component.extrapolation]}",
            hint="are the positions in mm? position_m and position_inch head others", **common,
        )  # fmt: skip
    if first > low or last < high:
        said = f"{where}: {_BEYOND[component.extrapolation]}"
        return Note(Level.NOTE, Kind.POSITION, subject, said, **common)
    return None


def _remedy(component: ComponentError, low: float, high: float) -> str:
    """The keys that put the table into the travel, with their values where it would fit."""
    first, last = component.range_mm
    length, slack = last - first, max(_BEYOND_SHARE * (high - low), _BEYOND_MM)
    keys = f"in [errors.{component.name}] of the machine file"
    if length > high - low + slack:
        return "are the positions in mm, and one row not a slip?"
    if low - slack <= -last and -first <= high + slack:
        return f"{keys}: reverse = true where they count against the axis, position_zero_mm = " \
               f"{low - first:g} where they count from the lower end"  # fmt: skip
    return f"{keys}: position_zero_mm says where the axis was at position 0, such as " \
           f"{low - first:g}; reverse = true where they count against the axis"  # fmt: skip


def _has_sense(component: ComponentError) -> bool:
    """Whether it matters which way deviations and approaches were counted."""
    direction, axis, angular = component_of(component.name)
    is_positioning = not angular and direction == axis
    return is_positioning or bool((component.forward != component.backward).any())


def _unsaid_sense(name: str) -> Note:
    return Note(
        Level.DOUBT,
        Kind.POSITION,
        name,
        "its positions count against the axis; deviations and forward and backward are taken as "
        "those of the axis",
        accepted="reverse_deviations = true or false beside reverse",
        hint="true where the instrument counted them, too, against the axis",
    )
