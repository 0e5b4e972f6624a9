"""Machine data in What if: a table drawn by hand, a reflector that stood elsewhere."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vmach.base.finite_number import is_number
from vmach.base.units import mm_from_um, rad_from_urad, um_from_mm, urad_from_rad
from vmach.errors import InputError
from vmach.machine import Machine, Variant
from vmach.machine.component_errors import COMPONENT_NAMES, ComponentError, component_of
from vmach.prediction.error_budget import budget_at
from vmach.workbench.model.point_set import PointSet

__all__ = ["HANDLES", "MachineChange", "changed_machine", "drawn_table_text", "machine_cards"]

#: places of a table that are drawn, evenly over the travel of its axis
HANDLES = 13
#: positions between which a drawn table runs straight where the machine's own is curved
_FINE = 400
_MOST = 1e5


@dataclass(frozen=True)
class MachineChange:
    """A machine with other tables or measuring points.

    Attributes
    ----------
    now, before : Machine
    components : tuple of str
        Symbols of the components whose share differs: those that were drawn, and the angles of an
        axis whose measuring points are elsewhere.
    """

    now: Machine
    before: Machine
    components: tuple[str, ...]

    def moved_mm(self, points: PointSet, variant: Variant) -> np.ndarray:
        """What the change does to the deviations, (C,) mm, to first order."""
        if variant is Variant.NONE:
            return np.zeros(len(points))
        key = ("tables", self.components, variant)  # the points are those of one job
        if key not in points.kept:
            points.kept[key] = self._share(self.before, points, variant)
        return self._share(self.now, points, variant) - points.kept[key]

    def _share(self, machine: Machine, points: PointSet, variant: Variant) -> np.ndarray:
        turning = {name[2] for name in self.components if component_of(name)[2]}
        some = {  # an angle needs the places where its axis was read
            name: component
            for name, component in machine.components.items()
            if name in self.components or (name[2] in turning and not component.is_angle)
        }
        nothing = np.zeros(len(points))
        job = replace(points.job, machine=replace(machine, components=some))
        budget = budget_at(points.states, points.normal, nothing, job=job, variant=variant)
        columns = [k for k, source in enumerate(budget.sources) if source in self.components]
        return budget.share_mm[:, columns].sum(axis=1)


def changed_machine(machine: Machine, wanted: Sequence[Mapping[str, Any]]) -> MachineChange:
    """The machine with what the page says.

    Parameters
    ----------
    machine : Machine
    wanted : sequence of mapping
        ``component``; ``offset``: what is added to its table at `HANDLES` places, um or urad;
        ``measured_at_mm``: X, Y, Z of the measuring point.

    Raises
    ------
    InputError
    """
    components, differing = dict(machine.components), set()
    for one in wanted:
        name = one.get("component")
        if name not in COMPONENT_NAMES:
            raise InputError(f"component {name!r}", accepted=", ".join(COMPONENT_NAMES))
        found = components.get(name)
        if one.get("offset") is not None:
            found = _drawn(machine, name, found, _numbers(one, "offset", HANDLES))
            differing.add(name)
        if one.get("measured_at_mm") is not None and found is not None:
            place = np.array(_numbers(one, "measured_at_mm", 3))
            found = replace(found, measured_at_mm=place)
            differing |= {f"E{angle}{name[2]}" for angle in "ABC"}
        if found is not None:
            components[name] = found
    names = tuple(name for name in COMPONENT_NAMES if name in differing)
    return MachineChange(replace(machine, components=components), machine, names)


def drawn_table_text(machine: Machine, wanted: Mapping[str, Any]) -> str:
    """A drawn table as a file of errors, over machine coordinates.

    Raises
    ------
    InputError
    """
    found = changed_machine(machine, [wanted]).now.components[wanted["component"]]
    unit, in_unit = ("urad", urad_from_rad) if found.is_angle else ("um", um_from_mm)
    columns = found.position_mm, in_unit(found.forward), in_unit(found.backward)
    rows = (",".join(f"{value:.6f}" for value in row) for row in zip(*columns, strict=True))
    return "\n".join([f"position_mm,forward_{unit},backward_{unit}", *rows, ""])


def _numbers(one: Mapping[str, Any], key: str, count: int) -> list[float]:
    values = one[key]
    is_list = isinstance(values, list) and len(values) == count
    if not is_list or not all(is_number(value, _MOST) for value in values):
        raise InputError(f"{key} of {one['component']}", accepted=f"{count} numbers")
    return [float(value) for value in values]


def _handles_mm(machine: Machine, name: str) -> np.ndarray:
    """Places that are drawn, (HANDLES,), over the travel and over the table."""
    axis = machine.axes[name[2]]
    return np.linspace(axis.travel_min_mm, axis.travel_max_mm, HANDLES)


def _drawn(
    machine: Machine, name: str, found: ComponentError | None, offset: Sequence[float]
) -> ComponentError:
    """A table with what was drawn added to it; the differences of direction stay.

    One that was not there is taken to be read at the frame's origin.
    """
    handles = _handles_mm(machine, name)
    own = [] if found is None else found.position_mm
    is_straight = found is None or found.interpolation == ComponentError.interpolation
    fine = [] if is_straight else np.linspace(*handles[[0, -1]], _FINE)
    position = np.unique(np.concatenate((fine, handles, own)))
    added = np.interp(position, handles, offset)
    added = rad_from_urad(added) if component_of(name)[2] else mm_from_um(added)
    if found is None:
        place = None if component_of(name)[2] else np.zeros(3)
        return ComponentError(name, position, added, added, place)
    forward, backward = (curve + added for curve in _both_ways(found, position))
    bare = replace(found, runs=None, evidence=())
    return replace(bare, position_mm=position, forward=forward, backward=backward,
                   interpolation=ComponentError.interpolation)  # fmt: skip


def _both_ways(found: ComponentError, position_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A table at positions, its ends held, in both directions of motion."""
    inside = np.clip(position_mm, *found.range_mm)
    way = np.ones(len(inside))
    return found.evaluate(inside, way), found.evaluate(inside, -way)


def machine_cards(machine: Machine) -> list[dict[str, Any]]:
    """Every component error for the page: its curve, where it can be drawn, and its place.

    Components with a table come first.
    """
    cards = [_card(machine, name) for name in COMPONENT_NAMES]
    return sorted(cards, key=lambda card: not card["has_table"])


def _card(machine: Machine, name: str) -> dict[str, Any]:
    found, handles = machine.components.get(name), _handles_mm(machine, name)
    is_angle = component_of(name)[2]
    value = np.zeros(HANDLES)
    if found is not None:
        value = np.mean(_both_ways(found, handles), axis=0)
    place = None if found is None or is_angle else found.measured_at_mm
    return {
        "name": name,
        "axis": name[2],
        "unit": "urad" if is_angle else "um",
        "has_table": found is not None,
        "position_mm": handles.tolist(),
        "value": (urad_from_rad(value) if is_angle else um_from_mm(value)).tolist(),
        "measured_at_mm": None if place is None else np.asarray(place).tolist(),
    }
