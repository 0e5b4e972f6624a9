"""Displacements on a workpiece that has turned, in the axes of the machine.

Source: closed form derived here: the nominal pose of the workpiece turns its axes into those of
the bed (`vmach.machine.nominal_motion`).
"""

from __future__ import annotations

import numpy as np

from vmach.machine.displacement import RigidDisplacement
from vmach.machine.machine import Machine
from vmach.machine.nominal_motion import BED, Pose, nominal_joints

__all__ = ["in_machine_axes", "workpiece_pose"]


def workpiece_pose(machine: Machine, nose_mm: np.ndarray, rotary_rad: np.ndarray) -> Pose:
    """Nominal pose of the workpiece in the bed at P states; both arrays are (P, 3), mm and rad."""
    work_side = nominal_joints(machine, nose_mm, rotary_rad)[1]
    return work_side[-1].body if work_side else BED


def in_machine_axes(
    machine: Machine, moved: RigidDisplacement, nose_mm: np.ndarray, rotary_rad: np.ndarray
) -> RigidDisplacement:
    """The same displacement with its components along X, Y and Z of the machine.

    Parameters
    ----------
    machine : Machine
    moved : RigidDisplacement
        At P states, in the axes of the workpiece.
    nose_mm, rotary_rad : (P, 3) float64
        Positions of X, Y, Z and angles of A, B, C.
    """
    if not machine.rotary or not rotary_rad.any():
        return moved
    pose = workpiece_pose(machine, nose_mm, rotary_rad)
    shift, tilt = (pose.vectors_to_bed(v) for v in (moved.shift_mm, moved.tilt_rad))
    return RigidDisplacement(shift, tilt)
