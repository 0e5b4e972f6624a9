"""Reading the rotary axes of a machine file: travel, centre, component and location errors.

Source: ISO 230-7 and ISO 230-1 (names of the errors).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.machine.chain import ROTARY_AXES
from vmach.machine.files.machine_schema import CROSS_VALIDATION, MachineSchema, TableEntry
from vmach.machine.rotary import RotaryAxis, RotaryError, location_of
from vmach.machine.tables.error_table import (
    MM_PER,
    POSITION_RAD_PER,
    RAD_PER,
    read_error_table,
)
from vmach.machine.tables.interpolation import Extrapolation, Interpolation, Method

__all__ = ["is_rotary_error", "read_rotary_axes"]

_AT_CENTRE = (
    "its displacements hold at centre_mm",
    "no measuring point, no set_up, no slope_removed",
)
_OF_THE_AXIS = "its positions are those of the axis", "no position_zero_mm, no reverse"
_THROUGH_POINTS = "its curve has no order and no period", "linear, pchip, cubic, smoothing"
#: keys of a table of a linear axis alone: why, and what is accepted
_OUT_OF_PLACE = {
    **dict.fromkeys(
        ("measured_at_mm", "nose_at_mm", "stick_out_mm", "set_up", "slope_removed"), _AT_CENTRE
    ),
    **dict.fromkeys(("position_zero_mm", "reverse", "reverse_deviations"), _OF_THE_AXIS),
    **dict.fromkeys(("order", "period_mm"), _THROUGH_POINTS),
}
Fail = Callable[..., InputError]  #: keys, what, accepted -> the complaint with file and line


def is_rotary_error(name: str) -> bool:
    """Whether a component error belongs to a rotary axis: ``EXC``, ``ECC`` and the like."""
    return len(name) == 3 and name[0] == "E" and name[1] in "XYZABC" and name[2] in ROTARY_AXES


def read_rotary_axes(
    data: MachineSchema, axes: tuple[str, ...], *, folder: Path, fail: Fail
) -> dict[str, RotaryAxis]:
    """The rotary axes of the chain.

    Parameters
    ----------
    data : MachineSchema
    axes : tuple of str
        Rotary axes that the chain names.
    folder : Path
        That table files are relative to.
    fail : callable
        Makes the complaint about a key.

    Raises
    ------
    InputError
        An axis of the chain without travel or centre, an error of an axis that is not in the
        chain, a table that cannot be read.
    """
    for name in data.errors:
        if is_rotary_error(name) and name[2] not in axes:
            raise fail(["errors", name], f"{name}: there is no axis {name[2]} in the chain")
    locations = _locations(data, axes, fail)
    found = {}
    for axis in axes:
        entry = data.axes.get(axis)
        keys = ["axes", axis]
        if entry is None or entry.travel_deg is None or entry.centre_mm is None:
            raise fail(
                keys, f"rotary axis {axis} needs travel_deg and centre_mm",
                "travel_deg = [low, high], centre_mm = [x, y, z]: a point of its axis in machine "
                "coordinates with every axis at zero",
            )  # fmt: skip
        low, high = entry.travel_deg
        if low >= high:
            raise fail([*keys, "travel_deg"], f"travel {low} .. {high} deg", "[low, high]")
        components = {
            name: _component(name, table, data, folder=folder, fail=fail)
            for name, table in data.errors.items()
            if is_rotary_error(name) and name[2] == axis
        }
        found[axis] = RotaryAxis(
            math.radians(low), math.radians(high), np.array(entry.centre_mm), components,
            *locations[axis],
        )  # fmt: skip
    return found


def _locations(
    data: MachineSchema, axes: tuple[str, ...], fail: Fail
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Displacement in mm and tilt in rad of every axis line."""
    found = {axis: (np.zeros(3), np.zeros(3)) for axis in axes}
    for name, value in data.location.items():
        place = location_of(name)
        if place is None or place[0] not in axes:
            raise fail(
                ["location", name], f"location error '{name}'",
                "EX0C, EY0C, EA0C, EB0C (or XOC, YOC, AOC, BOC) of a rotary axis of the chain",
            )  # fmt: skip
        axis, direction, angular = place
        unit = data.convention.angle if angular else data.convention.length
        found[axis][angular][direction] = value * (RAD_PER if angular else MM_PER)[unit]
    return found


def _component(
    name: str, entry: TableEntry, data: MachineSchema, *, folder: Path, fail: Fail
) -> RotaryError:
    keys = ["errors", name]
    if entry.table is None:
        raise fail(keys, f"{name} has no table", 'table = "errors/NAME.csv"')
    for key in entry.model_dump(exclude_none=True):
        if key in _OUT_OF_PLACE:
            why, accepted = _OUT_OF_PLACE[key]
            raise fail([*keys, key], f"{name} belongs to a rotary axis: {why}", accepted)
    method = entry.interpolation or data.tables.interpolation or Method.LINEAR
    if method == CROSS_VALIDATION or (method in (Method.LEGENDRE, Method.FOURIER)):
        raise fail(keys, f"{name}: interpolation '{method}'", "linear, pchip, cubic, smoothing")
    angular = name[1] in ROTARY_AXES
    unit = entry.unit or (data.convention.angle if angular else data.convention.length)
    units = RAD_PER if angular else MM_PER
    if unit not in units:
        raise fail([*keys, "unit"], f"unit '{unit}' of {name}", ", ".join(units))
    if not (folder / entry.table).exists():
        raise fail([*keys, "table"], f"table = '{entry.table}': no such file")
    table = read_error_table(folder / entry.table, units, unit, positions=POSITION_RAD_PER)
    return RotaryError(
        name,
        table.position,
        0.5 * (table.forward + table.backward),
        Interpolation(Method(method)),
        entry.extrapolation or data.tables.extrapolation or Extrapolation.REFUSE,
        table.in_degrees,
    )
