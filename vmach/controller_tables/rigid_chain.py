"""Error tables of three rigid bodies in a row, and how a control takes them back.

A control that is given the component errors of ISO 230-1 carries the tool through the chain with
homogeneous matrices. The form used here has the axes in the order from the workpiece to the tool.
All errors are motions of the tool side relative to the workpiece side. They are stated at the
origin of the frame that moves with the axis, the spindle nose with every axis at home:

    tip = S_1 E_1 S_2 E_2 S_3 E_3 (0, 0, -L)

with S_j the travel along the axis' line (its squareness turns the line), E_j the six component
errors. Which side of the bed an axis is on does not matter in this form: the arms of an axis that
carries the workpiece differ only by its own position, and that part goes into its tables.

Source: ISO 230-1 (errors); Beckhoff/ISG "Volumetric compensation" (FCT-C26).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from vmach.controller_tables.knots import Knots
from vmach.machine import Machine, Variant
from vmach.machine.component_errors import component_of
from vmach.volumetric.field import measured_volume

__all__ = ["RigidChain", "chain_of"]


@dataclass(frozen=True)
class RigidChain:
    """Component errors of a chain of three linear axes.

    Attributes
    ----------
    order : str
        Axes from the workpiece to the tool, such as ``XYZ``.
    tables : dict of ISO 230-1 symbol to (position_mm, forward, backward)
        Values in mm or rad.
    squareness_rad : dict of ``EC0Y`` and the like to float
    """

    order: str
    tables: dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]] = field(default_factory=dict)
    squareness_rad: dict[str, float] = field(default_factory=dict)

    def applied_correction(
        self, nose_mm: np.ndarray, direction: np.ndarray, tool_mm: np.ndarray
    ) -> np.ndarray:
        """What is added to the commanded positions, (P, 3) mm: minus the tip's displacement."""
        tip = np.broadcast_to(tool_mm, nose_mm.shape).copy()
        for axis in reversed(self.order):
            tip = self._moved(axis, tip, nose_mm, direction)
        return nose_mm + tool_mm - tip

    def _moved(
        self, axis: str, tip: np.ndarray, nose_mm: np.ndarray, direction: np.ndarray
    ) -> np.ndarray:
        """A point of the body that the axis carries, seen from the body before it."""
        j = "XYZ".index(axis)
        shift, angle = np.zeros((2, len(tip), 3))
        for kind in "XYZABC":
            if (name := f"E{kind}{axis}") in self.tables:
                position, *ways = self.tables[name]
                up, down = (np.interp(nose_mm[:, j], position, way) for way in ways)
                share = 0.5 * (1.0 + np.sign(direction[:, j]))
                target = angle if kind in "ABC" else shift
                target[:, "XYZABC".index(kind) % 3] = share * up + (1.0 - share) * down
        lean = [self.squareness_rad.get(f"E{kind}0{axis}", 0.0) for kind in "ABC"]
        line = Rotation.from_rotvec(lean).apply(np.eye(3)[j])
        return nose_mm[:, j, None] * line + shift + Rotation.from_rotvec(angle).apply(tip)


def chain_of(machine: Machine, knots: tuple[Knots, Knots, Knots], variant: Variant) -> RigidChain:
    """The machine's errors in the form of this module, at given positions.

    Measuring points and set-ups are worked into the tables:

        E'_ij(q) = E_ij(q) + [theta_j(q) x (a_j q - R_ij - t_ij q)]_i

    with a_j q the own part of the arm of a work-side axis, R_ij the measuring point and t_ij q
    its travel (`vmach.machine.displacement`); the last two are zero in the conventional variant.
    """
    work, tool = machine.chain.work_side[::-1], machine.chain.tool_side[::-1]
    found = RigidChain("".join((*work, *tool)))
    reference, travel = np.zeros((3, 3, 3)), np.zeros((3, 3))
    if variant is Variant.ABBE:
        reference, travel = machine.measuring_points_mm(), machine.measuring_point_travel
    volume = measured_volume(machine, (2, 2, 2))
    for j, axis in enumerate("XYZ"):
        at = knots[j].position_mm
        inside = np.clip(at, volume.low_mm[j], volume.high_mm[j])
        ways = [
            _body_errors(machine, axis, inside, way, (reference[:, j], travel[:, j]))
            for way in ((1.0, -1.0) if machine.separate_directions else (0.0, 0.0))
        ]
        for k, kind in enumerate("XYZABC"):
            if any(np.any(way[k]) for way in ways):
                found.tables[f"E{kind}{axis}"] = (at, ways[0][k], ways[1][k])
        for k, kind in enumerate("ABC"):
            if k != j and machine.squareness_rad[j, k]:
                found.squareness_rad[f"E{kind}0{axis}"] = float(machine.squareness_rad[j, k])
    return found


def _body_errors(
    machine: Machine,
    axis: str,
    at_mm: np.ndarray,
    way: float,
    measured: tuple[np.ndarray, np.ndarray],
) -> np.ndarray:
    """The six errors of an axis at the frame's origin, (6, K), mm and rad.

    `measured` holds the measuring point of each linear error, (3, 3) mm, and its travel, (3,).
    """
    reference_mm, travel = measured
    j = "XYZ".index(axis)
    errors = np.zeros((6, len(at_mm)))
    for name, component in machine.components.items():
        if name[2] == axis:
            kind, _, angular = component_of(name)
            value = machine.component_sign(name) * component.evaluate(
                at_mm, np.full(len(at_mm), way)
            )
            errors[kind + 3 * angular] = value
    own = machine.chain.arm_masks[j, j]
    for i in range(3):
        arm = np.tile(-reference_mm[i], (len(at_mm), 1))
        arm[:, j] += (own - travel[i]) * at_mm
        errors[i] += np.cross(errors[3:].T, arm)[:, i]
    return errors
