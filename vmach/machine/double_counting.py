"""How much of every angular error a reading already holds.

A reflector at R, in the frame of the body, reads ``E = t + theta x R``: the conventional form
takes all of E as t and adds ``theta x r``, so that ``theta x R`` enters twice.

Source: the Abbe-consistent model (virtual machining of free-form slots); closed form derived
here: E - t = theta x R.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.machine.component_errors import component_of
from vmach.machine.machine import Machine

__all__ = ["DoubleCount", "double_counting"]


@dataclass(frozen=True)
class DoubleCount:
    """The share of angular errors in one reading.

    Attributes
    ----------
    component : str
        Positioning or straightness error that was read.
    reading_mm : float
        Peak to valley of the reading.
    share_mm : float
        Peak to valley of ``theta x R`` along it: what the conventional form counts twice.
    correlation : float
        Between reading and share along the axis; near 1 where the reading is mostly angle.
    """

    component: str
    reading_mm: float
    share_mm: float
    correlation: float


def double_counting(machine: Machine) -> tuple[DoubleCount, ...]:
    """The angular share in every reading whose measuring point is known, largest first."""
    found = []
    for name, component in machine.components.items():
        if component.is_angle or component.measured_at_mm is None:
            continue
        share = _share_mm(machine, name)
        spread = np.std(share) * np.std(component.mean)
        if np.ptp(share) == 0.0:
            continue
        correlation = 0.0 if spread == 0.0 else np.corrcoef(share, component.mean)[0, 1]
        found.append(
            DoubleCount(
                name, float(np.ptp(component.mean)), float(np.ptp(share)), float(correlation)
            )
        )
    return tuple(sorted(found, key=lambda one: -one.share_mm))


def _share_mm(machine: Machine, name: str) -> np.ndarray:
    """theta x R along the direction that was read, at the positions of the reading, as read."""
    direction, axis, _ = component_of(name)
    component = machine.components[name]
    position = component.position_mm
    point_mm = np.tile(component.measured_at_mm, (len(position), 1))
    point_mm[:, axis] += machine.measuring_point_travel[direction, axis] * position
    angle = np.zeros((len(position), 3))
    for letter, column in zip("ABC", range(3), strict=True):
        turning = machine.components.get(f"E{letter}{name[2]}")
        if turning is not None:
            angle[:, column] = machine.component_sign(turning.name) * turning.curves[0](position)
    return machine.component_sign(name) * np.cross(angle, point_mm)[:, direction]
