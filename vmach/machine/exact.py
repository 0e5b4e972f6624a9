"""Displacement by the exact product of homogeneous matrices: the oracle of the first-order form.

Slow and literal on purpose. Frames: bed, then one body an axis outwards on either side; every
body's frame has its origin at the spindle nose with all axes at home. ``A2B`` in a comment means
the matrix that takes coordinates in A to coordinates in B.

Source: A. Slocum, Precision Machine Design (1992), homogeneous transformation matrices;
Bhattacharyya, Adv. Ind. Manuf. Eng. 5 (2022) 100089.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from vmach.base.variant import Variant
from vmach.machine.chain import LINEAR_AXES, ROTARY_AXES
from vmach.machine.component_errors import component_of
from vmach.machine.displacement import RigidDisplacement
from vmach.machine.machine import Machine

__all__ = ["body_motion", "exact_displacement"]


def exact_displacement(
    machine: Machine,
    nose_mm: np.ndarray,
    tool_mm: np.ndarray,
    variant: Variant,
    *,
    rotary_rad: np.ndarray | None = None,
) -> RigidDisplacement:
    """Displacement of the tool with no term left out.

    Parameters as in `vmach.machine.displacement`.

    Notes
    -----
    ``H_tool = prod (bed to tool) S_j Tr(q_j) S_j^-1 E_j``, and ``H_work`` is the same with
    ``-q_j``. A rotary axis with centre c, location error D and angle ``+-phi_j`` has the factor
    ``Tr(c) E_j D Rot(phi_j) D^-1 Tr(-c)``. The tip in workpiece coordinates is
    ``H_work^-1 H_tool (T, 1)``; its nominal place is the same product without errors.
    """
    if rotary_rad is None:
        rotary_rad = np.zeros_like(nose_mm)
    tip = np.broadcast_to(np.asarray(tool_mm, dtype=float), nose_mm.shape)
    states = (machine, nose_mm, rotary_rad)
    actual = np.linalg.inv(_side(*states, variant, side="work")) @ _side(
        *states, variant, side="tool"
    )
    nominal = np.linalg.inv(_side(*states, Variant.NONE, side="work")) @ _side(
        *states, Variant.NONE, side="tool"
    )
    difference = actual - nominal
    shift = np.einsum("pij,pj->pi", difference[:, :3, :3], tip) + difference[:, :3, 3]
    turn = actual[:, :3, :3] @ nominal[:, :3, :3].transpose(0, 2, 1)
    return RigidDisplacement(shift, Rotation.from_matrix(turn).as_rotvec())


def body_motion(
    machine: Machine, axis: str, nose_mm: np.ndarray, variant: Variant
) -> tuple[np.ndarray, np.ndarray]:
    """Error motion of the body that an axis carries, at the origin of the body's frame.

    Returns
    -------
    shift_mm, rotation_rad : (P, 3) float64
        Motion of the body in the bed's frame. Readings taken at a reflector R give
        ``t = E - theta x R`` there in `Variant.ABBE`; in `Variant.HTM` they are taken as they
        are. Readings of the tool relative to the workpiece change sign on the work side.
    """
    j = LINEAR_AXES.index(axis)
    shift, rotation = np.zeros((2, len(nose_mm), 3))
    for name, component in machine.components.items():
        direction, index, angular = component_of(name)
        if index == j:
            value = machine.component_sign(name) * component.evaluate(nose_mm[:, j])
            (rotation if angular else shift)[:, direction] = value
    if variant is Variant.ABBE:
        for i, reflector_mm in enumerate(machine.measuring_points_mm()[:, j]):
            at_mm = np.tile(reflector_mm, (len(nose_mm), 1))
            at_mm[:, j] += machine.measuring_point_travel[i, j] * nose_mm[:, j]
            shift[:, i] -= np.cross(rotation, at_mm)[:, i]
    # so far as displacement of the tool; the body of a work-side axis moves the other way
    sign = 1.0 if machine.chain.carries_tool(axis) else -1.0
    return sign * shift, sign * rotation


def _side(
    machine: Machine, nose_mm: np.ndarray, rotary_rad: np.ndarray, variant: Variant, *, side: str
) -> np.ndarray:
    """Matrices from the outermost body of one side of the bed to the bed, (P, 4, 4)."""
    chain = machine.chain
    body2bed = np.tile(np.eye(4), (len(nose_mm), 1, 1))
    for axis in chain.tool_side[::-1] if side == "tool" else chain.work_side:
        if axis in ROTARY_AXES:
            body2bed = body2bed @ _turn(machine, axis, rotary_rad, variant)
            continue
        body2bed = body2bed @ _travel(machine, axis, nose_mm, variant)
        if variant is not Variant.NONE:
            body2bed = body2bed @ _matrix(*body_motion(machine, axis, nose_mm, variant))
    return body2bed


def _travel(machine: Machine, axis: str, nose_mm: np.ndarray, variant: Variant) -> np.ndarray:
    """S_j Tr(q_j) S_j^-1: travel along the axis' own, perhaps not square, reference line."""
    j = LINEAR_AXES.index(axis)
    lean = np.zeros(3) if variant is Variant.NONE else machine.squareness_rad[j]
    line = Rotation.from_rotvec(lean).apply(np.eye(3)[j])
    travel_mm = nose_mm[:, j] if machine.chain.carries_tool(axis) else -nose_mm[:, j]
    return _matrix(travel_mm[:, None] * line, np.zeros((len(nose_mm), 3)))


def _turn(machine: Machine, axis: str, rotary_rad: np.ndarray, variant: Variant) -> np.ndarray:
    """Tr(c) E_j D Rot(phi_j) D^-1 Tr(-c): turn about the axis' own, perhaps misplaced, line."""
    k = ROTARY_AXES.index(axis)
    rotary = machine.rotary[axis]
    tool_side = machine.chain.carries_tool(axis)
    angle = rotary_rad[:, k] if tool_side else -rotary_rad[:, k]
    none = np.zeros((len(angle), 3))
    turn = _matrix(none, np.multiply.outer(angle, np.eye(3)[k]))
    if variant is not Variant.NONE:
        place = _matrix(none + rotary.location_mm, none + rotary.location_rad)
        sign = machine.component_sign(f"EX{axis}") * (1.0 if tool_side else -1.0)
        shift, rotation = rotary.motion(rotary_rad[:, k])
        turn = _matrix(sign * shift, sign * rotation) @ place @ turn @ np.linalg.inv(place)
    return _matrix(none + rotary.centre_mm, none) @ turn @ _matrix(none - rotary.centre_mm, none)


def _matrix(shift_mm: np.ndarray, rotation_rad: np.ndarray) -> np.ndarray:
    """Homogeneous matrices of rigid motions, (P, 4, 4)."""
    matrix = np.tile(np.eye(4), (len(shift_mm), 1, 1))
    matrix[:, :3, :3] = Rotation.from_rotvec(rotation_rad).as_matrix()
    matrix[:, :3, 3] = shift_mm
    return matrix
