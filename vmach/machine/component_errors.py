"""Component errors: what a laser, a level or a straightedge found along one axis.

Source: ISO 230-1, error motions of a linear axis: EXX, EYX, EZX, EAX, EBX, ECX.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date
from enum import StrEnum
from functools import cached_property

import numpy as np

from vmach.errors import InputError
from vmach.machine.chain import LINEAR_AXES
from vmach.machine.tables.cross_validation import Score
from vmach.machine.tables.interpolation import LINEAR, Extrapolation, Interpolation, PiecewiseCubic
from vmach.machine.tables.runs import Runs

__all__ = ["COMPONENT_NAMES", "ComponentError", "SetUp", "component_of"]

#: the 18 component errors, ISO 230-1: direction of the error, then the axis that moves
COMPONENT_NAMES = tuple(f"E{kind}{axis}" for axis in LINEAR_AXES for kind in "XYZABC")
#: rounding of positions beyond the ends of a table
_TABLE_END_SLACK_MM = 1e-6


def component_of(name: str) -> tuple[int, int, bool]:
    """Direction index (0..2), axis index (0..2) and whether the error is an angle.

    ``EBX`` is the rotation about Y (B) of axis X: ``(1, 0, True)``.
    """
    kind, axis = name[1], name[2]
    angular = kind in "ABC"
    return ("ABC" if angular else "XYZ").index(kind), LINEAR_AXES.index(axis), angular


class SetUp(StrEnum):
    """Which side of the measured joint the measuring point belongs to."""

    #: a reflector on the body that the axis carries: the point rides with it
    REFLECTOR = "reflector"
    #: an indicator on the other side (in the spindle, against a straightedge on the table):
    #: the point of the body that is measured changes as the axis moves
    INDICATOR = "indicator"


@dataclass(frozen=True)
class ComponentError:
    """One component error against the position of its axis, in mm or rad.

    Attributes
    ----------
    name : str
        ISO 230-1 symbol such as ``EXX`` or ``EBY``.
    position_mm : (K,) float64
        Axis positions, increasing.
    forward, backward : (K,) float64
        The error approaching in positive and in negative direction, mm or rad.
    measured_at_mm : (3,) float64 or None
        Where the measuring point was, in the frame of the body that the axis carries, origin at
        the spindle nose with every axis at home; for `SetUp.INDICATOR` with the axis at zero.
        Only for positioning and straightness.
    nose_at_mm : (3,) float64 or None
        The axis positions that `measured_at_mm` was stated by, where it was.
    set_up : SetUp
    slope_removed : bool or None
        Whether a least-squares line was taken out of a straightness; None where not said.
    interpolation : Interpolation
    extrapolation : Extrapolation
    evidence : tuple of Score
        Cross-validation that the interpolation was chosen by, if it was.
    runs : Runs or None
        The single runs, where the table holds them.
    reverse : bool
        The file's positions count against the axis; those here are the axis' own.
    reverse_deviations : bool or None
        Whether its deviations and directions of approach did too; None where not said.
    source : str
        File that the values come from.
    provenance : str
        ``measured``, ``reconstructed`` or ``assumed``; empty where not said.
    measured_on : date or None
    """

    name: str
    position_mm: np.ndarray
    forward: np.ndarray
    backward: np.ndarray
    measured_at_mm: np.ndarray | None = None
    set_up: SetUp = SetUp.REFLECTOR
    slope_removed: bool | None = None
    interpolation: Interpolation = LINEAR
    extrapolation: Extrapolation = Extrapolation.REFUSE
    evidence: tuple[Score, ...] = ()
    runs: Runs | None = None
    reverse: bool = False
    reverse_deviations: bool | None = None
    nose_at_mm: np.ndarray | None = None
    source: str = ""
    provenance: str = ""
    measured_on: date | None = None

    @property
    def mean(self) -> np.ndarray:
        """Mean of both directions at the table's positions, (K,), mm or rad."""
        return 0.5 * (self.forward + self.backward)

    @property
    def is_angle(self) -> bool:
        """Whether the error is in rad."""
        return component_of(self.name)[2]

    @property
    def range_mm(self) -> tuple[float, float]:
        """First and last position of the table."""
        return float(self.position_mm[0]), float(self.position_mm[-1])

    @cached_property
    def curves(self) -> tuple[PiecewiseCubic, PiecewiseCubic, PiecewiseCubic]:
        """Curves of mean, forward and backward, in this order."""
        return tuple(
            self.interpolation.fit(self.position_mm, value, self.extrapolation)
            for value in (self.mean, self.forward, self.backward)
        )

    def evaluate(self, position_mm: np.ndarray, direction: np.ndarray | None = None) -> np.ndarray:
        """The error at positions of its axis, mm or rad.

        Parameters
        ----------
        position_mm : (P,) float64
        direction : (P,) number, optional
            Sign of the last motion of the axis: positive takes `forward`, negative `backward`,
            zero (not known) their mean. Without it the mean everywhere.

        Raises
        ------
        InputError
            A position beyond the table where extrapolation is refused.
        """
        position_mm = np.asarray(position_mm, dtype=float)
        self.check_covers(position_mm)
        mean, forward, backward = self.curves
        if direction is None:
            return mean(position_mm)
        one_way = np.where(direction > 0, forward(position_mm), backward(position_mm))
        return np.where(direction == 0, mean(position_mm), one_way)

    def check_covers(self, position_mm: np.ndarray) -> None:
        """Refuse positions, (P,) mm, beyond the table, unless its extrapolation is set.

        Raises
        ------
        InputError
            With component, worst position, range of the table and what to do.
        """
        if self.extrapolation is not Extrapolation.REFUSE or position_mm.size == 0:
            return
        low, high = self.range_mm
        least, most = float(position_mm.min()), float(position_mm.max())
        if least >= low - _TABLE_END_SLACK_MM and most <= high + _TABLE_END_SLACK_MM:
            return
        worst = least if low - least > most - high else most
        raise InputError(
            f"{self.name} is asked for at {self.name[2]} = {worst:.3f} mm, its table ends before",
            file=self.source or None,
            accepted=f"{low:g} .. {high:g} mm",
            hint=f'in the machine file, [errors.{self.name}] extrapolation = "hold" keeps the '
            'value at the end, "linear" continues along the tangent',
        )
