"""Measuring points: far from any place where the tip can be on that body."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vmach.base.note import Kind, Level, Note
from vmach.machine.chain import LINEAR_AXES
from vmach.machine.component_errors import SetUp, component_of
from vmach.machine.machine import Machine

__all__ = ["place_notes"]

#: how far beyond the tip's places on a body, and below the nose, a reflector may be put
_REACH_BEYOND_ARMS_MM = 500.0
_LONGEST_TOOL_MM = 500.0
#: further beyond these places than this, nothing of the machine is left to hold a reflector
_NOWHERE_MM = 10_000.0
#: a point so near the spindle nose at home, on a machine with a travel so long, is in metres
_AT_THE_NOSE_MM, _LONG_TRAVEL_MM = 1.0, 100.0


def place_notes(machine: Machine) -> Iterator[Note]:
    """A note on every measuring point beyond the reach of its body."""
    for name, component in machine.components.items():
        if component.is_angle or component.measured_at_mm is None:
            continue
        _, axis, _ = component_of(name)
        corners = machine.chain.arm_masks[axis] * machine.travel_mm
        if component.set_up is SetUp.INDICATOR:
            corners[:, axis] = 0.0
        low = corners.min(axis=0) - _REACH_BEYOND_ARMS_MM - [0.0, 0.0, _LONGEST_TOOL_MM]
        high = corners.max(axis=0) + _REACH_BEYOND_ARMS_MM
        at = component.measured_at_mm
        if at.any() and np.abs(at).max() < _AT_THE_NOSE_MM and _is_long(machine):
            yield Note(
                Level.DOUBT,
                Kind.PLACE,
                name,
                f"measured {np.linalg.norm(at):.2g} mm from the spindle nose at home",
                size=float(np.linalg.norm(at)),
                unit="mm",
                hint="is measured_at_mm in metres?",
            )
        for k in np.flatnonzero((at < low) | (at > high)):
            beyond = max(low[k] - at[k], at[k] - high[k])
            turned = low[k] <= -at[k] <= high[k]
            yield Note(
                Level.REFUSED if beyond > _NOWHERE_MM else Level.DOUBT,
                Kind.PLACE,
                name,
                f"measured at {LINEAR_AXES[k]} = {at[k]:g} mm of the body",
                size=float(at[k]),
                unit="mm",
                accepted=f"{low[k]:g} .. {high[k]:g} mm",
                hint="is its sign turned?" if turned else "is it in mm?",
            )


def _is_long(machine: Machine) -> bool:
    return bool(np.ptp(machine.travel_mm, axis=0).max() > _LONG_TRAVEL_MM)
