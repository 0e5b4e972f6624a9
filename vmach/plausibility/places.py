"""Measuring points: out of reach of the tip on that body, or too near the spindle nose at home."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vmach.base.note import Kind, Level, Note
from vmach.machine.chain import LINEAR_AXES
from vmach.machine.component_errors import ComponentError, SetUp, component_of
from vmach.machine.machine import Machine
from vmach.plausibility.tools import doubtful_length

__all__ = ["place_notes"]

#: how far beyond the tip's places on a body, and below the nose, a reflector may be put
_REACH_BEYOND_ARMS_MM = 500.0
_LONGEST_TOOL_MM = 500.0
#: further beyond these places than this, nothing of the machine is left to hold a reflector
_NOWHERE_MM = 10_000.0
#: optics and their holder are longer than this, so no point is so near the nose; on a machine with
#: a travel so long
_AT_THE_NOSE_MM, _LONG_TRAVEL_MM = 10.0, 100.0
#: nobody sets optics up so near the end of every travel, in shares of it; a place in the travel
#: that was divided by 25.4 always lies there
_CORNER_SHARE = 0.05


def place_notes(machine: Machine) -> Iterator[Note]:
    """A note on every measuring point where no optics can stand, or where nobody puts them."""
    for name, component in machine.components.items():
        at = component.measured_at_mm
        if component.is_angle or at is None:
            continue
        near = _near_the_nose(machine, name, at) or _in_the_corner(machine, component, at)
        if near is not None:
            yield near
        if component.nose_at_mm is not None:
            arm = machine.chain.arm_masks[component_of(name)[1]] * component.nose_at_mm
            yield from _stick_out(name, float((arm - at)[2]))
        yield from _out_of_reach(machine, component, at)


def _near_the_nose(machine: Machine, name: str, at: np.ndarray) -> Note | None:
    distance = float(np.linalg.norm(at))
    is_long = np.ptp(machine.travel_mm, axis=0).max() > _LONG_TRAVEL_MM
    if not 0.0 < distance < _AT_THE_NOSE_MM or not is_long:
        return None
    return Note(
        Level.DOUBT, Kind.PLACE, name,
        f"measured {distance:.2g} mm from the spindle nose at home",
        size=distance, unit="mm", hint="is measured_at_mm in metres or inches?",
    )  # fmt: skip


def _in_the_corner(
    machine: Machine, component: ComponentError, measured_at: np.ndarray
) -> Note | None:
    """Near home along every axis that the place counts along; a 0 is one that does not matter."""
    _, axis, _ = component_of(component.name)
    by_nose = component.nose_at_mm is not None
    at = measured_at if component.nose_at_mm is None else component.nose_at_mm
    span = np.ptp(machine.travel_mm, axis=0)
    home_at_end = np.abs(machine.travel_mm).min(axis=0) <= _CORNER_SHARE * span
    counts = (machine.chain.arm_masks[axis] > 0.0) & home_at_end & (at != 0.0)
    if span.max() <= _LONG_TRAVEL_MM or not counts.any():
        return None
    if (np.abs(at) > _CORNER_SHARE * span)[counts].any():
        return None
    where = ", ".join(f"{LINEAR_AXES[k]} = {at[k]:.3g}" for k in np.flatnonzero(counts))
    key = "nose_at_mm" if by_nose else "measured_at_mm"
    return Note(
        Level.DOUBT, Kind.PLACE, component.name,
        f"{key} at {where} mm, within {100 * _CORNER_SHARE:g} % of the travel from home",
        size=float(np.abs(at[counts]).max()), unit="mm", hint="is it in metres or inches?",
    )  # fmt: skip


def _stick_out(name: str, length_mm: float) -> Iterator[Note]:
    """The length from nose to optics, which is that of a tool."""
    said = doubtful_length("stick_out_mm", round(length_mm, 9)) if length_mm else None
    if said is not None:
        yield Note(Level.DOUBT, Kind.PLACE, name, said, size=length_mm, unit="mm")


def _out_of_reach(machine: Machine, component: ComponentError, at: np.ndarray) -> Iterator[Note]:
    _, axis, _ = component_of(component.name)
    corners = machine.chain.arm_masks[axis] * machine.travel_mm
    if component.set_up is SetUp.INDICATOR:
        corners[:, axis] = 0.0
    low = corners.min(axis=0) - _REACH_BEYOND_ARMS_MM - [0.0, 0.0, _LONGEST_TOOL_MM]
    high = corners.max(axis=0) + _REACH_BEYOND_ARMS_MM
    for k in np.flatnonzero((at < low) | (at > high)):
        beyond = max(low[k] - at[k], at[k] - high[k])
        turned = low[k] <= -at[k] <= high[k]
        yield Note(
            Level.REFUSED if beyond > _NOWHERE_MM else Level.DOUBT, Kind.PLACE, component.name,
            f"measured at {LINEAR_AXES[k]} = {at[k]:g} mm of the body",
            size=float(at[k]), unit="mm", accepted=f"{low[k]:g} .. {high[k]:g} mm",
            hint="is its sign turned?" if turned else "is it in mm?",
        )  # fmt: skip
