"""Displacement by the exact product of homogeneous matrices: the oracle of the first-order form.

Slow and literal on purpose. Frames: bed, then one body an axis outwards on either side; every
body's frame has its origin at the spindle nose with all axes at home. ``A2B`` in a comment means
the matrix that takes coordinates in A to coordinates in B.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from vmach.machine.chain import LINEAR_AXES
from vmach.machine.component_errors import component_of
from vmach.machine.displacement import RigidDisplacement, Variant
from vmach.machine.machine import Machine

__all__ = ["body_motion", "exact_displacement"]


def exact_displacement(
    machine: Machine, nose_mm: np.ndarray, tool_mm: np.ndarray, variant: Variant
) -> RigidDisplacement:
    """Displacement of the tool with no term left out.

    Parameters as in `vmach.machine.displacement`.

    Notes
    -----
    ``H_tool = prod (bed to tool) S_j Tr(q_j) S_j^-1 E_j``, ``H_work`` the same with ``-q_j``;
    the tip in workpiece coordinates is ``H_work^-1 H_tool (T, 1)`` and nominally ``T + q``.
    The tilt is the rotation vector of ``H_work^-1 H_tool``.
    """
    tool2bed = _side(machine, nose_mm, variant, machine.chain.tool_side[::-1])
    work2bed = _side(machine, nose_mm, variant, machine.chain.work_side)
    tool2work = np.linalg.inv(work2bed) @ tool2bed
    tip = np.broadcast_to(np.asarray(tool_mm, dtype=float), nose_mm.shape)
    actual = np.einsum("pij,pj->pi", tool2work[:, :3, :3], tip) + tool2work[:, :3, 3]
    tilt = Rotation.from_matrix(tool2work[:, :3, :3]).as_rotvec()
    return RigidDisplacement(actual - tip - nose_mm, tilt)


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
    machine: Machine, nose_mm: np.ndarray, variant: Variant, axes: tuple[str, ...]
) -> np.ndarray:
    """Matrices from the outermost body of one side of the bed to the bed, (P, 4, 4)."""
    body2bed = np.tile(np.eye(4), (len(nose_mm), 1, 1))
    for axis in axes:
        body2bed = body2bed @ _travel(machine, axis, nose_mm)
        body2bed = body2bed @ _matrix(*body_motion(machine, axis, nose_mm, variant))
    return body2bed


def _travel(machine: Machine, axis: str, nose_mm: np.ndarray) -> np.ndarray:
    """S_j Tr(q_j) S_j^-1: travel along the axis' own, perhaps not square, reference line."""
    j = LINEAR_AXES.index(axis)
    line = Rotation.from_rotvec(machine.squareness_rad[j]).apply(np.eye(3)[j])
    way_mm = nose_mm[:, j] if machine.chain.carries_tool(axis) else -nose_mm[:, j]
    return _matrix(way_mm[:, None] * line, np.zeros((len(nose_mm), 3)))


def _matrix(shift_mm: np.ndarray, rotation_rad: np.ndarray) -> np.ndarray:
    """Homogeneous matrices of rigid motions, (P, 4, 4)."""
    matrix = np.tile(np.eye(4), (len(shift_mm), 1, 1))
    matrix[:, :3, :3] = Rotation.from_rotvec(rotation_rad).as_matrix()
    matrix[:, :3, 3] = shift_mm
    return matrix
