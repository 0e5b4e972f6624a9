"""Where every body of a machine is when nothing is wrong: chains with rotary axes included.

Every body has a frame; all frames coincide, at the spindle nose, with every axis at zero. A body
is carried by the next one towards the bed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from vmach.machine.chain import LINEAR_AXES
from vmach.machine.machine import Machine
from vmach.machine.rotary import ROTARY_AXES

__all__ = ["BodyPose", "nominal_poses", "turned"]


@dataclass(frozen=True)
class BodyPose:
    """Pose of the body that an axis carries.

    Attributes
    ----------
    carrier2bed, body2bed : (P, 4, 4) float64
        Matrices from the frames of the carrying body and of the body itself to the bed.
    own_rotation : (P, 3, 3) float64
        Nominal rotation of this axis alone, from body to carrier; ones for a linear axis.
    """

    carrier2bed: np.ndarray
    body2bed: np.ndarray
    own_rotation: np.ndarray


def nominal_poses(
    machine: Machine, nose_mm: np.ndarray, rotary_rad: np.ndarray
) -> dict[str, BodyPose]:
    """Nominal poses of all bodies, by the axis that carries them.

    Parameters
    ----------
    machine : Machine
    nose_mm : (P, 3) float64
        Positions of X, Y, Z.
    rotary_rad : (P, 3) float64
        Angles of A, B, C. An axis that carries the workpiece moves the other way, as ISO 841 has
        it: positive is the motion of the tool relative to the workpiece.
    """
    poses = {}
    for axes, sense in ((machine.chain.tool_side[::-1], 1.0), (machine.chain.work_side, -1.0)):
        carrier = np.tile(np.eye(4), (len(nose_mm), 1, 1))
        for axis in axes:
            own = np.tile(np.eye(4), (len(nose_mm), 1, 1))
            if axis in LINEAR_AXES:
                j = LINEAR_AXES.index(axis)
                own[:, j, 3] = sense * nose_mm[:, j]
            else:
                k = ROTARY_AXES.index(axis)
                own[:, :3, :3] = turned(k, sense * rotary_rad[:, k])
                centre = machine.rotary[axis].centre_mm
                own[:, :3, 3] = centre - own[:, :3, :3] @ centre
            poses[axis] = BodyPose(carrier, carrier @ own, own[:, :3, :3])
            carrier = poses[axis].body2bed
    return poses


def turned(axis: int, angle_rad: np.ndarray) -> np.ndarray:
    """Rotations about a machine axis, right-handed, (P, 3, 3)."""
    return Rotation.from_rotvec(np.multiply.outer(angle_rad, np.eye(3)[axis])).as_matrix()
