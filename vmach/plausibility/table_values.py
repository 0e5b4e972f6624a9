"""The values of error tables: sizes no machine has, odd ones out, slopes, and copies."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Any

import numpy as np

from vmach.base.note import Kind, Level, Note
from vmach.base.units import um_from_mm, urad_from_rad
from vmach.machine.component_errors import ComponentError, component_of
from vmach.machine.machine import Machine
from vmach.machine.squareness import squareness_name
from vmach.machine.tables.error_table import LARGEST_MM, LARGEST_RAD

__all__ = ["value_notes"]

#: an error, or its range along an axis, that is larger is hardly one of a machine tool in use:
#: ISO 10791-4 accepts 0.02 to 0.05 mm, ISO 10791-1 0.06 mm/m
_USUAL_MM, _USUAL_RAD = 0.1, 5e-4
#: a smaller range along an axis is below what laser, straightedge and level tell
_LEAST_MM = {True: 5e-4, False: 1e-4}  # of positioning, of straightness
_LEAST_RAD = 5e-7
#: between a table and one in inches or in another thousand lies the root of 25.4
_ODD_FACTOR = 5.04
#: so many of a kind are needed to call one odd
_LEAST_PEERS = 3
#: of fewer others the middle one is too uncertain, and is taken of all
_ENOUGH_OTHERS = 4
#: a slope of less over the whole table is rounding, or the noise of the readings
_SLOPE_OVER_TABLE_MM = 1e-3
#: and one that is a smaller share of the table's range belongs to the shape of its curve
_SLOPE_SHARE = 0.25


def value_notes(machine: Machine) -> Iterator[Note]:
    """What cannot be, or is unlikely, of the values of a machine's tables."""
    sizes = tuple(_sizes(machine))
    yield from sizes
    yield from _odd_ones_out(machine, {note.subject for note in sizes})
    yield from _slopes(machine)
    yield from _copies(machine)


def _range(component: ComponentError) -> float:
    return float(np.ptp([component.forward, component.backward]))


def _largest(component: ComponentError) -> float:
    return float(np.abs([component.forward, component.backward]).max())


def _is_positioning(component: ComponentError) -> bool:
    direction, axis, angular = component_of(component.name)
    return not angular and direction == axis


def _sizes(machine: Machine) -> Iterator[Note]:
    for name, component in machine.components.items():
        angle = component.is_angle
        largest, spread = _largest(component), _range(component)
        usual, most = (_USUAL_RAD, LARGEST_RAD) if angle else (_USUAL_MM, LARGEST_MM)
        least = _LEAST_RAD if angle else _LEAST_MM[_is_positioning(component)]
        if largest <= usual and not 0.0 < spread < least:
            continue
        scale, unit = (urad_from_rad, "urad") if angle else (um_from_mm, "um")
        is_possible = largest <= most
        yield Note(
            Level.DOUBT if is_possible else Level.REFUSED, Kind.SIZE, name,
            f"up to {scale(largest):.3g} {unit}, range {scale(spread):.3g} {unit}",
            size=scale(largest), unit=unit,
            accepted=f"a range from {scale(least):g}, up to "
            f"{scale(usual if is_possible else most):g} {unit}",
            hint="is it in the unit that the table, unit or [convention] says?",
        )  # fmt: skip


def _odd_ones_out(machine: Machine, noted: set[str]) -> Iterator[Note]:
    """A table whose range is far from those of its kind: positioning, straightness or angle."""
    kinds: dict[tuple[bool, bool], dict[str, float]] = {}
    for name, component in machine.components.items():
        if spread := _range(component):
            kind = (component.is_angle, _is_positioning(component))
            kinds.setdefault(kind, {})[name] = spread
    for (angle, _), ranges in kinds.items():
        scale, unit = (urad_from_rad, "urad") if angle else (um_from_mm, "um")
        if len(ranges) < _LEAST_PEERS:
            continue
        for name, spread in ranges.items():
            # a wrong one has no say in what is usual, where others enough can tell
            others = [other for peer, other in ranges.items() if peer != name]
            # but a short axis is often as good as five times better: small is small among all
            is_large = spread > np.median(list(ranges.values()))
            can_tell = is_large and len(others) >= _ENOUGH_OTHERS
            peers = others if can_tell else list(ranges.values())
            usual = float(np.median(peers))
            if usual / _ODD_FACTOR <= spread <= usual * _ODD_FACTOR or name in noted:
                continue
            yield Note(
                Level.DOUBT, Kind.SIZE, name,
                f"range {scale(spread):.3g} {unit}; the middle one of {len(peers)} of its kind "
                f"is {scale(usual):.3g} {unit}",
                size=scale(spread), unit=unit,
                hint="is it in the unit that the table, unit or [convention] says?",
            )  # fmt: skip


def _slopes(machine: Machine) -> Iterator[Note]:
    """A straightness with a slope beside a squareness of the same two axes."""
    for name, component in machine.components.items():
        direction, axis, angular = component_of(name)
        if angular or direction == axis:
            continue
        position = component.position_mm
        slope = np.polyfit(position, component.mean, 1)[0]
        over_table_mm = abs(slope) * np.ptp(position)
        if over_table_mm < max(_SLOPE_OVER_TABLE_MM, _SLOPE_SHARE * _range(component)):
            continue
        slope_um_per_m, over_table_um = urad_from_rad(slope), um_from_mm(over_table_mm)
        amount = f"a slope of {slope_um_per_m:.3g} um/m, {over_table_um:.3g} um over the table"
        square = squareness_name(axis, 3 - direction - axis)
        found: dict[str, Any] = {"size": float(slope_um_per_m), "unit": "um/m"}
        if component.slope_removed:
            said = f"slope_removed, but there is {amount}"
            yield Note(Level.CONTRADICTION, Kind.SLOPE, name, said, **found)
        elif machine.squareness_rad[axis, 3 - direction - axis]:
            said = f"{amount}, beside {square}: both act; is the slope counted twice?"
            yield Note(Level.NOTE, Kind.SLOPE, name, said, **found)


def _copies(machine: Machine) -> Iterator[Note]:
    for (name, one), (other_name, other) in combinations(machine.components.items(), 2):
        if (
            one.is_angle == other.is_angle
            and one.mean.any()
            and (np.array_equal(one.mean, other.mean) or np.array_equal(one.mean, -other.mean))
        ):
            said = f"the same values as {other_name}, copied by mistake?"
            yield Note(Level.DOUBT, Kind.COPY, name, said)
