"""First-order displacement on chains with rotary axes, in NumPy.

Every axis contributes a small screw motion of the tool relative to the workpiece, written in the
frame of one body; the nominal poses carry it to the workpiece. Without rotary axes, and with them
at zero, this is the form of `vmach.machine.displacement`.

Source: closed form derived here: the errors (t, w) of a body move a tip at r from its origin by t
+ w x r, to first order; the nominal pose R turns the sum into the workpiece frame.
"""

from __future__ import annotations

import numpy as np

from vmach.machine.chain import LINEAR_AXES, ROTARY_AXES
from vmach.machine.component_errors import component_of
from vmach.machine.machine import Machine
from vmach.machine.nominal_motion import BED, Joint, nominal_joints

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
    tool_side, work_side = nominal_joints(machine, nose_mm, rotary_rad)
    spindle = tool_side[-1].body if tool_side else BED
    workpiece = work_side[-1].body if work_side else BED
    tip_mm = spindle.points_to_bed(np.broadcast_to(tool_mm, nose_mm.shape))
    shift, tilt = np.zeros((2, len(nose_mm), 3))
    for joint in (*tool_side, *work_side):
        if joint.turn is None:
            frame = joint.body
            part = _linear(
                machine, joint.axis, nose_mm, frame.points_from_bed(tip_mm),
                reference_mm=reference_mm, reference_travel=reference_travel, direction=direction,
            )  # fmt: skip
        else:
            frame = joint.carrier
            part = _rotary(machine, joint, rotary_rad, frame.points_from_bed(tip_mm))
        shift += frame.vectors_to_bed(part[0])
        tilt += frame.vectors_to_bed(part[1])
    return workpiece.vectors_from_bed(shift), workpiece.vectors_from_bed(tilt)


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
        b, c = (i + 1) % 3, (i + 2) % 3
        from_b, from_c = (
            arm_mm[:, k]
            - reference_mm[i, j, k]
            - (reference_travel[i, j] * nose_mm[:, j] if k == j else 0.0)
            for k in (b, c)
        )
        shift[:, i] += rotation[:, b] * from_c - rotation[:, c] * from_b
    lean = np.cross(machine.squareness_rad[j], np.eye(3)[j])
    return shift + nose_mm[:, j, None] * lean, rotation


def _rotary(
    machine: Machine, joint: Joint, rotary_rad: np.ndarray, tip_mm: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Shift at the tip and rotation by a rotary axis, in the frame of its carrier.

    Let the line of a turn R be displaced by d and tilted by s. The turn then differs from that
    about the nominal line by the screw motion ``(1 - R) d`` and ``(1 - R) s``.
    """
    rotary = machine.rotary[joint.axis]
    shift, rotation = rotary.motion(rotary_rad[:, ROTARY_AXES.index(joint.axis)])
    body_to_tool = 1.0 if machine.chain.carries_tool(joint.axis) else -1.0
    one_minus_turn = body_to_tool * (np.eye(3) - joint.turn)
    sign = machine.component_sign(f"EX{joint.axis}")
    shift = sign * shift + one_minus_turn @ rotary.location_mm
    rotation = sign * rotation + one_minus_turn @ rotary.location_rad
    return shift + _cross(rotation, tip_mm - rotary.centre_mm), rotation


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross products of rows; `numpy.cross` takes four times as long."""
    out = np.empty_like(a)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        out[:, i] = a[:, j] * b[:, k] - a[:, k] * b[:, j]
    return out
