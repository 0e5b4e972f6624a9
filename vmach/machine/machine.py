"""A machine as vmach knows it: chain, travel, motion, component errors, squareness."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.machine.chain import LINEAR_AXES, Chain
from vmach.machine.component_errors import ComponentError, component_of

__all__ = ["Axis", "Machine", "Motion", "SignConvention"]


class SignConvention(StrEnum):
    """What an error of an axis that carries the workpiece is the motion of."""

    #: of the tool relative to the workpiece: every term adds
    RELATIVE = "relative"
    #: of the body itself in the bed's frame: terms of work-side axes subtract
    BODY = "body"


@dataclass(frozen=True)
class Axis:
    """Travel of a linear axis in machine coordinates, mm."""

    travel_min_mm: float
    travel_max_mm: float


@dataclass(frozen=True)
class Motion:
    """How the machine moves, for the clock."""

    rapid_mm_per_min: float
    tool_change_s: float = 0.0
    acceleration_mm_per_s2: float | None = None


@dataclass(frozen=True)
class Machine:
    """A three-axis machine and its 21 geometric errors.

    Attributes
    ----------
    name : str
    chain : Chain
    axes : mapping of axis name to Axis
    motion : Motion
    components : mapping of ISO 230-1 symbol to ComponentError
        Those of the 18 that were measured; the others are taken as zero.
    squareness_rad : (3, 3) float64
        Row j holds the rotation vector sigma_j of axis j's reference line; only the components
        across the axis act.
    sign : SignConvention
    files : tuple of Path
        The machine file and the tables that it names, for the record of what was run.
    """

    name: str
    chain: Chain
    axes: Mapping[str, Axis]
    motion: Motion
    components: Mapping[str, ComponentError]
    squareness_rad: np.ndarray
    sign: SignConvention = SignConvention.RELATIVE
    files: tuple[Path, ...] = ()

    def axis_sign(self, axis: str) -> float:
        """+1, or -1 for the errors of a work-side axis recorded as motion of the body."""
        body = self.sign is SignConvention.BODY and not self.chain.carries_tool(axis)
        return -1.0 if body else 1.0

    @property
    def travel_mm(self) -> np.ndarray:
        """(2, 3) float64: lower and upper ends of the travel of X, Y, Z."""
        ends = [(self.axes[a].travel_min_mm, self.axes[a].travel_max_mm) for a in LINEAR_AXES]
        return np.array(ends).T

    def measuring_points_mm(self) -> np.ndarray:
        """Reflector positions R[i, j] = where E_ij was read, (3, 3, 3) float64, mm.

        First index the direction measured, second the axis moved. A linear component without a
        table has no reading that could hold a share of an angle; its point is the frame's origin.

        Raises
        ------
        InputError
            A linear component has a table but no `measured_at_mm`, while its axis has angular
            errors: the arm is then unknown.
        """
        points = np.zeros((3, 3, 3))
        turning = {name[2] for name in self.components if component_of(name)[2]}
        for name, component in self.components.items():
            direction, axis, angular = component_of(name)
            if angular:
                continue
            if component.measured_at_mm is not None:
                points[direction, axis] = component.measured_at_mm
            elif name[2] in turning:
                raise InputError(
                    f"machine '{self.name}': {name} has no measured_at_mm",
                    accepted="three numbers: where the reflector stood, in the frame of the body "
                    "that the axis carries",
                    hint="the Abbe-consistent model needs it; '--model htm' does not",
                )
        return points
