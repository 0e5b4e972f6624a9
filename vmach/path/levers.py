"""Levers: how far the machine's component errors move the tool where it stands.

Source: closed form derived here: one unit of a component error moves the tip by e_i, of an angle
by e_i x arm (`vmach.machine.displacement`).
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from vmach.machine import COMPONENT_NAMES, ComponentError, Machine, RigidDisplacement, Variant
from vmach.machine.component_errors import component_of
from vmach.machine.displacement import contributions

__all__ = ["levers", "tilts_of_axes_rad"]

_EVERYWHERE_MM = np.array([-1e6, 1e6])


def levers(
    machine: Machine,
    nose_mm: np.ndarray,
    tool_mm: np.ndarray,
    variant: Variant = Variant.ABBE,
) -> dict[str, RigidDisplacement]:
    """Displacement of the tool by one unit (mm or rad) of each component error everywhere.

    Parameters
    ----------
    machine : Machine
    nose_mm, tool_mm : (P, 3) float64
        Axis positions, and the vector from nose to tip.
    variant : Variant
        From where the arms of angular errors count.
    """
    units = {}
    for name in COMPONENT_NAMES:
        # read nowhere, or at a place that no angle of the machine asked for: the frame's origin
        known = machine.components.get(name)
        at = None if known is None else known.measured_at_mm
        units[name] = _unit(name, (0.0, 0.0, 0.0) if at is None else tuple(at.tolist()))
    changed = replace(machine, components=units)
    return dict(contributions(changed, nose_mm, tool_mm, variant))


@lru_cache(maxsize=4 * len(COMPONENT_NAMES))
def _unit(name: str, measured_at_mm: tuple[float, float, float]) -> ComponentError:
    """A component error of 1 everywhere; kept, as points are looked at in many batches."""
    one = np.ones(2)
    return ComponentError(name, _EVERYWHERE_MM, one, one, measured_at_mm=np.array(measured_at_mm))


def tilts_of_axes_rad(machine: Machine, nose_mm: np.ndarray, tool_mm: np.ndarray) -> np.ndarray:
    """Rotation of the tool by the angular tables of each axis, (3 axes, P, 3) rad.

    Parameters
    ----------
    machine : Machine
    nose_mm, tool_mm : (P, 3) float64
        Axis positions, and the vector from nose to tip.
    """
    tilt = np.zeros((3, len(nose_mm), 3))
    for name, part in contributions(machine, nose_mm, tool_mm, Variant.ABBE):
        if name in COMPONENT_NAMES:
            tilt[component_of(name)[1]] += part.tilt_rad
    return tilt
