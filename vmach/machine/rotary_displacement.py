"""First-order displacement on chains with rotary axes, in NumPy.

Every axis contributes a small screw motion of the tool relative to the workpiece, written in the
frame of one body; the nominal poses carry it to the workpiece. Without rotary axes, and with them
at zero, this is the form of `vmach.machine.displacement`.
"""

from __future__ import annotations

import numpy as np

from vmach.machine.chain import LINEAR_AXES
from vmach.machine.component_errors import component_of
from vmach.machine.machine import Machine
from vmach.machine.nominal_motion import BodyPose, nominal_poses
from vmach.machine.rotary import ROTARY_AXES

__all__ = ["rotary_displacement"]


def rotary_displacement(
    machine: Machine,
    nose_mm: np.ndarray,
    tool_mm: np.ndarray,
    *,
    rotary_rad: np.ndarray,
    reference_mm: np.ndarray,
    reference_travel: np.ndarray,
    direction: np.ndarray | None,
) -> tuple[np.ndarray, np.ndarray]:
    """Shift and tilt of the tool in the axes of the workpiece, (P, 3) mm and rad each.

    Parameters as in `vmach.machine.kernel.displace`, and

    rotary_rad : (P, 3) float64
        Angles of A, B, C.
    """
    poses = nominal_poses(machine, nose_mm, rotary_rad)
    bed = np.tile(np.eye(4), (len(nose_mm), 1, 1))
    holder = poses[machine.chain.tool_side[0]].body2bed if machine.chain.tool_side else bed
    work = poses[machine.chain.work_side[-1]].body2bed if machine.chain.work_side else bed
    tip_mm = _points(holder, np.broadcast_to(tool_mm, nose_mm.shape))
    shift, tilt = np.zeros((2, len(nose_mm), 3))
    for axis, pose in poses.items():
        if axis in LINEAR_AXES:
            frame = pose.body2bed
            part = _linear(
                machine, axis, nose_mm, _points(np.linalg.inv(frame), tip_mm),
                reference_mm=reference_mm, reference_travel=reference_travel, direction=direction,
            )  # fmt: skip
        else:
            frame = pose.carrier2bed
            arm = _points(np.linalg.inv(frame), tip_mm) - machine.rotary[axis].centre_mm
            part = _rotary(machine, axis, rotary_rad, arm, pose=pose)
        shift += _vectors(frame, part[0])
        tilt += _vectors(frame, part[1])
    bed2work = np.linalg.inv(work)
    return _vectors(bed2work, shift), _vectors(bed2work, tilt)


def _linear(
    machine: Machine, axis: str, nose_mm: np.ndarray, arm_mm: np.ndarray, *,
    reference_mm: np.ndarray, reference_travel: np.ndarray, direction: np.ndarray | None,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Shift at the tip and rotation by a linear axis, in the frame of its body."""
    j = LINEAR_AXES.index(axis)
    shift, rotation = np.zeros((2, len(nose_mm), 3))
    way = None if direction is None else direction[:, j]
    for name, component in machine.components.items():
        kind, index, angular = component_of(name)
        if index == j:
            value = machine.component_sign(name) * component.evaluate(nose_mm[:, j], way)
            (rotation if angular else shift)[:, kind] = value
    for i in range(3):
        start = np.tile(reference_mm[i, j], (len(nose_mm), 1))
        start[:, j] += reference_travel[i, j] * nose_mm[:, j]
        shift[:, i] += np.cross(rotation, arm_mm - start)[:, i]
    lean = np.cross(machine.squareness_rad[j], np.eye(3)[j])
    return shift + nose_mm[:, j, None] * lean, rotation


def _rotary(
    machine: Machine, axis: str, rotary_rad: np.ndarray, arm_mm: np.ndarray, *, pose: BodyPose
) -> tuple[np.ndarray, np.ndarray]:
    """Shift at the tip and rotation by a rotary axis, in the frame of its carrier.

    A turn R about a line that is displaced by d and tilted by s differs from the turn about the
    nominal line by the screw motion ``(I - R) d`` and ``(I - R) s``.
    """
    rotary = machine.rotary[axis]
    shift, rotation = rotary.motion(rotary_rad[:, ROTARY_AXES.index(axis)])
    body_to_tool = 1.0 if machine.chain.carries_tool(axis) else -1.0
    one_minus_turn = body_to_tool * (np.eye(3) - pose.own_rotation)
    sign = machine.component_sign(f"EX{axis}")
    shift = sign * shift + one_minus_turn @ rotary.location_mm
    rotation = sign * rotation + one_minus_turn @ rotary.location_rad
    return shift + np.cross(rotation, arm_mm), rotation


def _points(matrix: np.ndarray, points_mm: np.ndarray) -> np.ndarray:
    return np.einsum("pij,pj->pi", matrix[:, :3, :3], points_mm) + matrix[:, :3, 3]


def _vectors(matrix: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    return np.einsum("pij,pj->pi", matrix[:, :3, :3], vectors)
