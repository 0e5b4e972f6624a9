"""Displacement of the tool by the machine's geometric errors, first order.

One function serves both variants; they differ in the point that an arm is measured from:

* ``htm``: the usual practice with homogeneous matrices. The reading is taken as the error at the
  frame's origin, and the arm goes from there to the tip. Part of every angle is then counted
  twice, once through the arm and once in the reading.
* ``abbe``: the arm starts at the reflector that gave the reading, each component its own.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from vmach.machine.component_errors import component_of
from vmach.machine.machine import Machine

__all__ = ["RigidDisplacement", "Variant", "contributions", "displacement"]


class Variant(StrEnum):
    """How the arms of angular errors are measured."""

    NONE = "none"  #: no machine error at all
    HTM = "htm"  #: from the origin of the machine
    ABBE = "abbe"  #: from the reflector of each measurement


@dataclass(frozen=True)
class RigidDisplacement:
    """Small rigid motion of the tool relative to the workpiece at P states.

    Attributes
    ----------
    shift_mm : (P, 3) float64
        Displacement of the tool tip, actual minus nominal, in machine axes.
    tilt_rad : (P, 3) float64
        Rotation vector of the tool, right-handed. A tool point at c from the tip is displaced
        by ``shift + tilt x c``.
    """

    shift_mm: np.ndarray
    tilt_rad: np.ndarray

    def __add__(self, other: RigidDisplacement) -> RigidDisplacement:
        return RigidDisplacement(self.shift_mm + other.shift_mm, self.tilt_rad + other.tilt_rad)

    def at(self, contact_mm: np.ndarray) -> np.ndarray:
        """Displacement of the tool points at `contact_mm` (P, 3) from the tip, (P, 3) mm."""
        return self.shift_mm + np.cross(self.tilt_rad, contact_mm)

    @classmethod
    def zero(cls, count: int) -> RigidDisplacement:
        """No displacement at `count` states."""
        return cls(np.zeros((count, 3)), np.zeros((count, 3)))


def displacement(
    machine: Machine, nose_mm: np.ndarray, tool_mm: np.ndarray, variant: Variant
) -> RigidDisplacement:
    """Displacement of the tool by all geometric errors of the machine.

    Parameters
    ----------
    machine : Machine
    nose_mm : (P, 3) float64
        Axis positions q: the spindle nose in machine coordinates.
    tool_mm : (P, 3) or (3,) float64
        Vector T from nose to tip.
    variant : Variant

    Returns
    -------
    RigidDisplacement

    Raises
    ------
    InputError
        `Variant.ABBE` and a reflector position is missing.

    Notes
    -----
    With arms r_j = T + mask_j q (`Chain.arm_masks`), reflectors R_ij (zero in the conventional
    form) and s_j = +1 or, for bodies that carry the workpiece, -1:

        e_i = sum_j s_j (E_ij + [theta_j x (r_j - R_ij)]_i) + sum_j q_j [sigma_j x e_j]_i
    """
    total = RigidDisplacement.zero(len(nose_mm))
    for _, part in contributions(machine, nose_mm, tool_mm, variant):
        total = total + part
    return total


def contributions(
    machine: Machine, nose_mm: np.ndarray, tool_mm: np.ndarray, variant: Variant
) -> Iterator[tuple[str, RigidDisplacement]]:
    """The share of every component error, by its ISO 230-1 symbol; they add up to the whole.

    Parameters as in `displacement`.
    """
    if variant is Variant.NONE:
        return
    if variant is Variant.ABBE:
        reference_mm = machine.measuring_points_mm()
    else:
        reference_mm = np.zeros((3, 3, 3))
    arms_mm = tool_mm + machine.chain.arm_masks[:, None, :] * nose_mm
    for name, component in machine.components.items():
        direction, axis, angular = component_of(name)
        value = machine.axis_sign(name[2]) * component.evaluate(nose_mm[:, axis])
        if angular:
            yield name, _turn(value, direction, arms_mm[axis], reference_mm[:, axis])
        else:
            yield name, _push(value, direction)
    yield from _squareness(machine, nose_mm)


def _push(value_mm: np.ndarray, direction: int) -> RigidDisplacement:
    """A positioning or straightness error along one direction."""
    part = RigidDisplacement.zero(len(value_mm))
    part.shift_mm[:, direction] = value_mm
    return part


def _turn(
    angle_rad: np.ndarray, direction: int, arm_mm: np.ndarray, reference_mm: np.ndarray
) -> RigidDisplacement:
    """An angular error; row i of `reference_mm` (3, 3) is where the error along i was read."""
    part = RigidDisplacement.zero(len(angle_rad))
    part.tilt_rad[:, direction] = angle_rad
    first, second = (direction + 1) % 3, (direction + 2) % 3
    part.shift_mm[:, first] = -angle_rad * (arm_mm[:, second] - reference_mm[first, second])
    part.shift_mm[:, second] = angle_rad * (arm_mm[:, first] - reference_mm[second, first])
    return part


def _squareness(
    machine: Machine, nose_mm: np.ndarray
) -> Iterator[tuple[str, RigidDisplacement]]:
    """Reference lines out of square: they turn the direction of the axis' own travel only."""
    for axis in range(3):
        for rotation in range(3):
            angle = machine.squareness_rad[axis, rotation]
            if rotation == axis or angle == 0.0:
                continue
            across = np.cross(np.eye(3)[rotation], np.eye(3)[axis])
            shift = angle * nose_mm[:, axis, None] * across
            name = f"E{'ABC'[rotation]}0{'XYZ'[axis]}"
            yield name, RigidDisplacement(shift, np.zeros_like(shift))
