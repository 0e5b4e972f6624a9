"""Mistakes in the error tables of a machine, put right one at a time.

Source: ISO 230-1, symbols of error motions; closed forms derived here: a table that counts from
the other end is mirrored, one arcsecond is pi / 648,000 rad.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from vmach.machine import LINEAR_AXES, ComponentError, Machine
from vmach.measurements.plausibility.alternatives import Mistake

__all__ = ["TableMistake", "exchanged_directions", "mistaken_tables"]

#: urad of one arcsecond: by so much angles are too small that were taken for urad
_ARCSECOND = 1e6 * math.pi / 648_000.0


@dataclass(frozen=True)
class TableMistake(Mistake):
    """What may have gone wrong with the error tables.

    Attributes
    ----------
    machine : Machine
        As it is where that is so.
    """

    machine: Machine


def mistaken_tables(machine: Machine) -> Iterator[TableMistake]:
    """The machine with its tables as they would be if a mistake had been made, one at a time.

    Beside exchanged directions, and signs, which `vmach.effects.laws.geometry.error_tables` weighs.
    """
    yield from _ends(machine)
    yield from _names(machine)
    yield from _units(machine)


def exchanged_directions(machine: Machine) -> Iterator[TableMistake]:
    """Forward and backward exchanged, in one axis or in all; none where the mean of both acts."""
    if not machine.separate_directions:
        return
    for axes in (*LINEAR_AXES, LINEAR_AXES):
        of_axes = {n: t for n, t in machine.components.items() if n[-1] in axes}
        yield TableMistake(
            f"forward and backward of {' and '.join(axes)} exchanged",
            "is approach the sign of the last motion, and are the columns of the error tables in "
            "their order?",
            _with(machine, {n: replace(t, forward=t.backward, backward=t.forward)
                            for n, t in of_axes.items()}),
        )  # fmt: skip


def _ends(machine: Machine) -> Iterator[TableMistake]:
    """One table that counts from the other end of its axis, its deviations too or not."""
    for name, table in machine.components.items():
        low, high = table.range_mm
        forward, backward = table.backward[::-1], table.forward[::-1]
        mirrored = replace(
            table, position_mm=(low + high) - table.position_mm[::-1],
            forward=forward, backward=backward,
        )  # fmt: skip
        question = f"did the instrument count with the axis? See reverse of [errors.{name}]"
        yield TableMistake(
            f"{name} counted from the other end", question, _with(machine, {name: mirrored})
        )
        turned = replace(mirrored, forward=-forward, backward=-backward)
        yield TableMistake(
            f"{name} counted from the other end, its deviations too",
            f"{question}, and reverse_deviations",
            _with(machine, {name: turned}),
        )


def _names(machine: Machine) -> Iterator[TableMistake]:
    """Two tables of one kind that are exchanged."""
    for one, other in itertools.combinations(machine.components.values(), 2):
        if one.is_angle != other.is_angle:
            continue
        tables = {one.name: _values_of(other, one), other.name: _values_of(one, other)}
        yield TableMistake(
            f"{one.name} and {other.name} exchanged",
            "are both tables under their own names? The second letter is the direction of the "
            "error, the third the axis that moves",
            _with(machine, tables),
        )


def _values_of(table: ComponentError, place: ComponentError) -> ComponentError:
    """A table that stands under another name, measured where that was."""
    return replace(
        place, position_mm=table.position_mm, forward=table.forward, backward=table.backward
    )


def _units(machine: Machine) -> Iterator[TableMistake]:
    """Angles that are arcseconds."""
    angles = {
        n: replace(t, forward=_ARCSECOND * t.forward, backward=_ARCSECOND * t.backward)
        for n, t in machine.components.items()
        if t.is_angle
    }
    if angles:
        yield TableMistake(
            "all angles in arcseconds", "is [convention] angle right?", _with(machine, angles)
        )


def _with(machine: Machine, tables: dict[str, ComponentError]) -> Machine:
    return replace(machine, components={**machine.components, **tables})
