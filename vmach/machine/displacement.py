"""Displacement of the tool by the machine's geometric errors, first order.

One function serves both variants; they differ in the point that an arm is measured from:

* ``htm``: the usual practice with homogeneous matrices. The reading is taken as the error at the
  frame's origin, and the arm goes from there to the tip. Part of every angle is then counted
  twice, once through the arm and once in the reading.
* ``abbe``: the arm starts at the reflector that gave the reading, each component its own.

Source: KTH thesis, eq. 26, for the sum over the axes; the Abbe-consistent model (virtual
machining of free-form slots) for arms that start at the reflector.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from vmach.base.variant import Variant
from vmach.machine.component_errors import component_of
from vmach.machine.kernel import compile_errors, displace
from vmach.machine.machine import Machine
from vmach.machine.rotary_displacement import rotary_displacement
from vmach.machine.single_errors import single_errors
from vmach.machine.squareness import lean_direction, squareness_name

__all__ = ["RigidDisplacement", "contributions", "displacement"]


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
    machine: Machine,
    nose_mm: np.ndarray,
    tool_mm: np.ndarray,
    variant: Variant,
    *,
    direction: np.ndarray | None = None,
    rotary_rad: np.ndarray | None = None,
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
    direction : (P, 3) number, optional
        Sign of the last motion of every axis, kept while the axis stands still; zero where no
        motion is known. Chooses between forward and backward tables on machines that say so
        (`Machine.separate_directions`); without it, and elsewhere, their mean acts.
    rotary_rad : (P, 3) float64, optional
        Angles of A, B, C; zero by default. Machines without rotary axes do not look at them.

    Returns
    -------
    RigidDisplacement
        In the axes of the workpiece: those of the machine, turned with the workpiece where
        rotary axes carry it.

    Raises
    ------
    InputError
        `Variant.ABBE` and a reflector position is missing; a position beyond a table whose
        extrapolation is not set.

    Notes
    -----
    All component errors are turned to "tool relative to workpiece". The arms are
    r_j = T + mask_j q (`Chain.arm_masks`), the measuring points R_ij (zero in the conventional
    form). theta_j is the rotation vector of axis j, sigma_j that of its reference line:

        e_i = sum_j (E_ij + [theta_j x (r_j - R_ij)]_i) + sum_j q_j [sigma_j x e_j]_i

    Examples
    --------
    >>> import numpy as np
    >>> import vmach
    >>> machine = vmach.read_machine("samples/iso10791_7/machine.toml")
    >>> nose, tool = np.array([[-380.0, -230.0, -250.0]]), np.array([0.0, 0.0, -150.0])
    >>> moved = vmach.displacement(machine, nose, tool, vmach.Variant.ABBE)
    >>> moved.shift_mm.shape, moved.tilt_rad.shape
    ((1, 3), (1, 3))
    >>> bool(np.abs(moved.shift_mm).max() < 0.05)
    True
    """
    nose_mm = np.ascontiguousarray(nose_mm, dtype=float)
    if variant is Variant.NONE or len(nose_mm) == 0:
        return RigidDisplacement.zero(len(nose_mm))
    machine.check_covers(nose_mm)
    reference_mm, reference_travel = _reference(machine, variant)
    common = {
        "reference_mm": reference_mm,
        "reference_travel": reference_travel,
        "direction": _signs(machine, direction),
    }
    tool_mm = np.ascontiguousarray(np.atleast_2d(tool_mm), dtype=float)
    if machine.rotary:
        angles = np.zeros_like(nose_mm) if rotary_rad is None else np.asarray(rotary_rad)
        moved = rotary_displacement(machine, nose_mm, tool_mm, rotary_rad=angles, **common)
    else:
        moved = displace(_compiled(machine), nose_mm, tool_mm, **common)
    return RigidDisplacement(*moved)


def contributions(
    machine: Machine,
    nose_mm: np.ndarray,
    tool_mm: np.ndarray,
    variant: Variant,
    *,
    direction: np.ndarray | None = None,
    rotary_rad: np.ndarray | None = None,
    names: Collection[str] | None = None,
) -> Iterator[tuple[str, RigidDisplacement]]:
    """The share of every component error at P places, by its ISO 230-1 symbol; they add up.

    Parameters as in `displacement`; `names` are the symbols wanted, all where left out.
    """
    if variant is Variant.NONE:
        return
    reference_mm, reference_travel = _reference(machine, variant)
    if machine.rotary:
        common = {
            "rotary_rad": np.zeros_like(nose_mm) if rotary_rad is None else rotary_rad,
            "reference_mm": reference_mm,
            "reference_travel": reference_travel,
            "direction": _signs(machine, direction),
        }
        for name, one in single_errors(machine):
            if names is not None and name not in names:
                continue
            yield name, RigidDisplacement(*rotary_displacement(one, nose_mm, tool_mm, **common))
        return
    arms_mm = tool_mm + machine.chain.arm_masks[:, None, :] * nose_mm
    signs = _signs(machine, direction)
    for name, component in machine.components.items():
        if names is not None and name not in names:
            continue
        kind, axis, angular = component_of(name)
        way = None if signs is None else signs[:, axis]
        value = machine.component_sign(name) * component.evaluate(nose_mm[:, axis], way)
        if angular:
            own_mm = np.multiply.outer(reference_travel[:, axis], nose_mm[:, axis])
            starts_mm = own_mm[:, :, None] * np.eye(3)[axis] + reference_mm[:, None, axis]
            yield name, _turn(value, kind, arms_mm[axis], starts_mm)
        else:
            yield name, _push(value, kind)
    for name, part in _squareness(machine, nose_mm):
        if names is None or name in names:
            yield name, part


def _reference(machine: Machine, variant: Variant) -> tuple[np.ndarray, np.ndarray]:
    """Where the arm of E_ij starts, (3, 3, 3) mm, and how far that point travels with axis j."""
    if variant is Variant.HTM:
        return np.zeros((3, 3, 3)), np.zeros((3, 3))
    return machine.measuring_points_mm(), machine.measuring_point_travel


def _signs(machine: Machine, direction: np.ndarray | None) -> np.ndarray | None:
    """Signs of the last motion where the machine's tables are kept apart."""
    if direction is None or not machine.separate_directions:
        return None
    return np.ascontiguousarray(np.sign(direction), dtype=np.int8)


def _compiled(machine: Machine):
    """The machine's curves for the kernel, made once a machine."""
    if "_compiled_errors" not in machine.__dict__:
        machine.__dict__["_compiled_errors"] = compile_errors(machine)
    return machine.__dict__["_compiled_errors"]


def _push(value_mm: np.ndarray, direction: int) -> RigidDisplacement:
    """A positioning or straightness error along one direction."""
    part = RigidDisplacement.zero(len(value_mm))
    part.shift_mm[:, direction] = value_mm
    return part


def _turn(
    angle_rad: np.ndarray, rotation: int, arm_mm: np.ndarray, starts_mm: np.ndarray
) -> RigidDisplacement:
    """An angular error; ``starts_mm[i]`` (P, 3) is where the error along i was read."""
    part = RigidDisplacement.zero(len(angle_rad))
    part.tilt_rad[:, rotation] = angle_rad
    first, second = (rotation + 1) % 3, (rotation + 2) % 3
    part.shift_mm[:, first] = -angle_rad * (arm_mm - starts_mm[first])[:, second]
    part.shift_mm[:, second] = angle_rad * (arm_mm - starts_mm[second])[:, first]
    return part


def _squareness(machine: Machine, nose_mm: np.ndarray) -> Iterator[tuple[str, RigidDisplacement]]:
    """Reference lines out of square: they turn the direction of the axis' own travel only."""
    for axis in range(3):
        for rotation in range(3):
            angle = machine.squareness_rad[axis, rotation]
            if rotation == axis or angle == 0.0:
                continue
            shift = angle * nose_mm[:, axis, None] * lean_direction(axis, rotation)
            part = RigidDisplacement(shift, np.zeros_like(shift))
            yield squareness_name(axis, rotation), part
