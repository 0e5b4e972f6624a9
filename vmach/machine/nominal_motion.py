"""Where every body of a machine is when nothing is wrong: chains with rotary axes included.

Every body has a frame; all frames coincide, at the spindle nose, with every axis at zero. A body
is carried by the next one towards the bed.

Source: ISO 841 (axes and right-handed rotations); closed form derived here: a rotation about a
line through c is R, moved by c - R c.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.machine.chain import LINEAR_AXES, ROTARY_AXES
from vmach.machine.machine import Machine

__all__ = ["BED", "Joint", "Pose", "nominal_joints", "tip_on_workpiece", "turned"]


@dataclass(frozen=True)
class Pose:
    """Pose of a frame in the frame of the bed at P states.

    Attributes
    ----------
    origin_mm : (P, 3) or (3,) float64
    rotation : (P, 3, 3) float64 or None
        From the frame to the bed; None for a frame that has not turned, which saves most of the
        work on machines with few rotary axes.
    """

    origin_mm: np.ndarray
    rotation: np.ndarray | None = None

    def vectors_to_bed(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (P, 3) of this frame in the axes of the bed."""
        if self.rotation is None:
            return vectors
        return np.einsum("pij,pj->pi", self.rotation, vectors)

    def vectors_from_bed(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (P, 3) of the bed in the axes of this frame."""
        if self.rotation is None:
            return vectors
        return np.einsum("pji,pj->pi", self.rotation, vectors)

    def points_to_bed(self, points_mm: np.ndarray) -> np.ndarray:
        """Points (P, 3) of this frame in the frame of the bed."""
        return self.origin_mm + self.vectors_to_bed(points_mm)

    def points_from_bed(self, points_mm: np.ndarray) -> np.ndarray:
        """Points (P, 3) of the bed in this frame."""
        return self.vectors_from_bed(points_mm - self.origin_mm)


BED = Pose(np.zeros(3))


@dataclass(frozen=True)
class Joint:
    """An axis between two bodies.

    Attributes
    ----------
    axis : str
    carrier, body : Pose
        Of the body towards the bed, and of the one that the axis carries.
    turn : (P, 3, 3) float64 or None
        Nominal rotation from body to carrier; None for a linear axis.
    """

    axis: str
    carrier: Pose
    body: Pose
    turn: np.ndarray | None


def nominal_joints(
    machine: Machine, nose_mm: np.ndarray, rotary_rad: np.ndarray
) -> tuple[list[Joint], list[Joint]]:
    """The joints of the tool side and of the work side, each from the bed outwards.

    Parameters
    ----------
    machine : Machine
    nose_mm : (P, 3) float64
        Positions of X, Y, Z.
    rotary_rad : (P, 3) float64
        Angles of A, B, C. An axis that carries the workpiece moves the other way, as ISO 841 has
        it: positive is the motion of the tool relative to the workpiece.
    """
    sides = []
    for axes, sense in ((machine.chain.tool_side[::-1], 1.0), (machine.chain.work_side, -1.0)):
        carrier, joints = BED, []
        for axis in axes:
            if axis in LINEAR_AXES:
                j = LINEAR_AXES.index(axis)
                travel = np.zeros_like(nose_mm)
                travel[:, j] = sense * nose_mm[:, j]
                turn, body = None, Pose(carrier.points_to_bed(travel), carrier.rotation)
            else:
                k = ROTARY_AXES.index(axis)
                turn = turned(k, sense * rotary_rad[:, k])
                body = _turned_pose(carrier, turn, machine.rotary[axis].centre_mm)
            joints.append(Joint(axis, carrier, body, turn))
            carrier = body
        sides.append(joints)
    return sides[0], sides[1]


def tip_on_workpiece(
    machine: Machine, nose_mm: np.ndarray, tool_mm: np.ndarray, rotary_rad: np.ndarray
) -> np.ndarray:
    """Nominal place of the tool tip in the frame of the workpiece, (P, 3) mm.

    Parameters
    ----------
    machine : Machine
    nose_mm, rotary_rad : (P, 3) float64
        Positions of X, Y, Z and angles of A, B, C.
    tool_mm : (3,) or (P, 3) float64
        Vector from nose to tip.
    """
    tool_side, work_side = nominal_joints(machine, nose_mm, rotary_rad)
    spindle = tool_side[-1].body if tool_side else BED
    workpiece = work_side[-1].body if work_side else BED
    tip = spindle.points_to_bed(np.broadcast_to(tool_mm, nose_mm.shape))
    return workpiece.points_from_bed(tip)


def _turned_pose(carrier: Pose, turn: np.ndarray, centre_mm: np.ndarray) -> Pose:
    """Pose of a body that is turned about a centre, the same point in both frames."""
    origin = carrier.points_to_bed(centre_mm - turn @ centre_mm)
    return Pose(origin, turn if carrier.rotation is None else carrier.rotation @ turn)


def turned(axis: int, angle_rad: np.ndarray) -> np.ndarray:
    """Rotations about a machine axis, right-handed, (P, 3, 3)."""
    b, c = (axis + 1) % 3, (axis + 2) % 3
    rotation = np.zeros((len(angle_rad), 3, 3))
    rotation[:, axis, axis] = 1.0
    rotation[:, b, b] = rotation[:, c, c] = np.cos(angle_rad)
    rotation[:, c, b] = np.sin(angle_rad)
    rotation[:, b, c] = -rotation[:, c, b]
    return rotation
