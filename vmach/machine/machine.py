"""A machine as vmach knows it: chain, travel, motion, component errors, squareness."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from vmach.base.note import Note
from vmach.errors import InputError
from vmach.machine.chain import LINEAR_AXES, Chain
from vmach.machine.component_errors import ComponentError, SetUp, component_of
from vmach.machine.measuring_uncertainty import MeasuringUncertainty
from vmach.machine.rotary import RotaryAxis
from vmach.machine.sign_convention import SignConvention, sign_to_relative

__all__ = ["Axis", "Machine", "Motion", "SignConvention"]


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
    """A machine with three linear axes, perhaps rotary ones, and its geometric errors.

    Attributes
    ----------
    name : str
    chain : Chain
    axes : mapping of axis name to Axis
    motion : Motion
    components : mapping of ISO 230-1 symbol to ComponentError
        Those of the 18 that were measured, as recorded (see `sign`); the others are zero.
    squareness_rad : (3, 3) float64
        Row j holds the rotation vector sigma_j of axis j's reference line, right-handed; only
        the components across the axis act.
    sign : SignConvention
        Of the component errors.
    separate_directions : bool
        Whether forward and backward tables act by the direction of the last motion; else their
        mean acts always.
    rotary : mapping of axis name to RotaryAxis
        The rotary axes of the chain.
    reference_axes : str
        Primary and secondary axis of the machine's frame, such as ``ZY``; empty if not said.
    files : tuple of Path
        The machine file and the tables that it names, for the record of what was run.
    notes : tuple of Note
        What was done to the tables on reading; the subject of each is the component.
    uncertainty : MeasuringUncertainty
        Of the measurement of the machine, as far as the file states it.
    """

    name: str
    chain: Chain
    axes: Mapping[str, Axis]
    motion: Motion
    components: Mapping[str, ComponentError]
    squareness_rad: np.ndarray
    sign: SignConvention = SignConvention.RELATIVE
    separate_directions: bool = False
    rotary: Mapping[str, RotaryAxis] = field(default_factory=dict)
    reference_axes: str = ""
    files: tuple[Path, ...] = ()
    notes: tuple[Note, ...] = ()
    uncertainty: MeasuringUncertainty = field(default_factory=MeasuringUncertainty)

    def __post_init__(self) -> None:
        if set(self.rotary) != set(self.chain.rotary_axes):
            raise InputError(
                f"machine '{self.name}': rotary axes {' '.join(self.rotary) or 'none'}, in the "
                f"chain {' '.join(self.chain.rotary_axes) or 'none'}"
            )

    def component_sign(self, name: str) -> float:
        """Factor from a recorded component error to the displacement of the tool, +1 or -1."""
        return sign_to_relative(self.sign, self.chain, name)

    @property
    def travel_mm(self) -> np.ndarray:
        """(2, 3) float64: lower and upper ends of the travel of X, Y, Z."""
        ends = [(self.axes[a].travel_min_mm, self.axes[a].travel_max_mm) for a in LINEAR_AXES]
        return np.array(ends).T

    def check_covers(self, nose_mm: np.ndarray) -> None:
        """Refuse axis positions (P, 3) beyond a table whose extrapolation is not set.

        Raises
        ------
        InputError
            With component, position and range.
        """
        if len(nose_mm) == 0:
            return
        columns = np.asarray(nose_mm).T  # three passes are faster than one across
        ends_mm = np.array([[c.min() for c in columns], [c.max() for c in columns]])
        for name, component in self.components.items():
            component.check_covers(ends_mm[:, component_of(name)[1]])

    def measuring_points_mm(self) -> np.ndarray:
        """Reflector positions R[i, j] = where E_ij was read, (3, 3, 3) float64, mm.

        First index the direction measured, second the axis moved. A linear component without a
        table has no reading that could hold a share of an angle; its point is the frame's origin.

        Raises
        ------
        InputError
            A linear component is `unplaced`: the arm is then unknown.
        """
        if self.unplaced:
            verb = "has" if len(self.unplaced) == 1 else "have"
            raise InputError(
                f"machine '{self.name}': {' '.join(self.unplaced)} {verb} no measured_at_mm",
                file=self.files[0] if self.files else None,
                accepted="three numbers: where the reflector stood, in the frame of the body "
                "that the axis carries",
                hint="the Abbe-consistent model needs it; commands with '--model htm' do not",
            )
        points = np.zeros((3, 3, 3))
        for name, component in self._linear_components():
            direction, axis, _ = component_of(name)
            if component.measured_at_mm is not None:
                points[direction, axis] = component.measured_at_mm
        return points

    @property
    def unplaced(self) -> tuple[str, ...]:
        """Linear components without `measured_at_mm` that an angle of their axis turns into
        something: it turns about another direction than theirs."""
        turns = {component_of(name)[:2] for name, c in self.components.items() if c.is_angle}
        return tuple(
            name
            for name, component in self._linear_components()
            if component.measured_at_mm is None and _is_turned(*component_of(name)[:2], turns)
        )

    @cached_property
    def measuring_point_travel(self) -> np.ndarray:
        """(3, 3): how far along axis j the measuring point of E_ij moves in the body's frame, per
        mm of travel.

        0 for a reflector on the body. An indicator on the other side of the joint stays with
        the tool for a work-side axis (+1) and with the table for a tool-side axis (-1).
        """
        travel = np.zeros((3, 3))
        for name, component in self._linear_components():
            if component.set_up is SetUp.INDICATOR:
                direction, axis, _ = component_of(name)
                travel[direction, axis] = -1.0 if self.chain.carries_tool(name[2]) else 1.0
        return travel

    def _linear_components(self) -> list[tuple[str, ComponentError]]:
        return [(name, c) for name, c in self.components.items() if not c.is_angle]


def _is_turned(direction: int, axis: int, turns: set[tuple[int, int]]) -> bool:
    """Whether a rotation of the axis moves points along the direction."""
    return any(rotation != direction and of == axis for rotation, of in turns)
