"""Levers: how far the machine's component errors move the tool where it stands.

Source: closed form derived here: one unit of a component error moves the tip by e_i, of an angle
by e_i x arm (`vmach.machine.displacement`).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import lru_cache

import numpy as np

from vmach.machine import (
    COMPONENT_NAMES,
    ComponentError,
    Machine,
    RigidDisplacement,
    Variant,
    in_machine_axes,
)
from vmach.machine.component_errors import component_of
from vmach.machine.displacement import contributions

__all__ = ["levers", "location_levers", "tilts_of_axes_rad"]

_EVERYWHERE_MM = np.array([-1e6, 1e6])


def levers(
    machine: Machine,
    nose_mm: np.ndarray,
    tool_mm: np.ndarray,
    variant: Variant = Variant.ABBE,
    *,
    rotary_rad: np.ndarray | None = None,
    names: Collection[str] = COMPONENT_NAMES,
) -> dict[str, RigidDisplacement]:
    """Displacement of the tool by one unit (mm or rad) of each component error everywhere.

    Parameters
    ----------
    machine : Machine
    nose_mm, tool_mm : (P, 3) float64
        Axis positions, and the vector from nose to tip.
    variant : Variant
        From where the arms of angular errors count.
    rotary_rad : (P, 3) float64, optional
        Angles of A, B and C; zero without them.
    names : collection of str
        The component errors wanted.
    """
    units = {}
    for name in COMPONENT_NAMES:
        # read nowhere, or at a place that no angle of the machine asked for: the frame's origin
        known = machine.components.get(name)
        at = None if known is None else known.measured_at_mm
        units[name] = _unit(name, (0.0, 0.0, 0.0) if at is None else tuple(at.tolist()))
    changed = replace(machine, components=units)
    angles = np.zeros_like(nose_mm) if rotary_rad is None else rotary_rad
    own = contributions(changed, nose_mm, tool_mm, variant, rotary_rad=angles, names=names)
    return {name: in_machine_axes(machine, moved, nose_mm, angles) for name, moved in own}


def location_levers(
    machine: Machine, nose_mm: np.ndarray, tool_mm: np.ndarray, rotary_rad: np.ndarray
) -> dict[str, RigidDisplacement]:
    """Displacement of the tool by one unit (mm or rad) of each location error of a rotary axis.

    Parameters
    ----------
    machine : Machine
    nose_mm, tool_mm : (P, 3) float64
        Axis positions, and the vector from nose to tip.
    rotary_rad : (P, 3) float64
        Angles of A, B and C.

    Returns
    -------
    dict of ``EX0C`` and the like to RigidDisplacement
        In machine axes.
    """
    unit = {
        name: replace(axis, components={}, location_mm=np.ones(3), location_rad=np.ones(3))
        for name, axis in machine.rotary.items()
    }
    changed = replace(machine, components={}, squareness_rad=np.zeros((3, 3)), rotary=unit)
    own = contributions(changed, nose_mm, tool_mm, Variant.HTM, rotary_rad=rotary_rad)
    return {name: in_machine_axes(machine, moved, nose_mm, rotary_rad) for name, moved in own}


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
