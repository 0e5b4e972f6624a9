"""Rotary axes: where they turn, how far, and their component and location errors (ISO 230-7).

Source: ISO 230-7, error motions and location errors of an axis of rotation; ISO 230-1, EXC and
XOC.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from vmach.errors import InputError
from vmach.machine.chain import ROTARY_AXES
from vmach.machine.tables.interpolation import LINEAR, Extrapolation, Interpolation, PiecewiseCubic
from vmach.machine.tables.runs import Runs

__all__ = ["RotaryAxis", "RotaryError", "location_of"]

_END_SLACK_RAD = 1e-9  #: rounding of angles beyond the ends of a table


@dataclass(frozen=True)
class RotaryError:
    """One component error of a rotary axis against its angle, in mm or rad.

    Attributes
    ----------
    name : str
        ISO 230-1 symbol such as ``EXC`` (radial), ``EZC`` (axial), ``EAC`` (tilt), ``ECC``
        (angular positioning).
    position_rad : (K,) float64
        Angles, increasing.
    value : (K,) float64
        Mean of both directions, mm or rad; displacements hold at the axis' centre.
    runs : Runs, optional
        What was read, in both directions, over the angle in degrees; for ISO 230-2 alone.
    """

    name: str
    position_rad: np.ndarray
    value: np.ndarray
    interpolation: Interpolation = LINEAR
    extrapolation: Extrapolation = Extrapolation.REFUSE
    runs: Runs | None = None

    @cached_property
    def curve(self) -> PiecewiseCubic:
        """The error over the angle in rad."""
        return self.interpolation.fit(self.position_rad, self.value, self.extrapolation)

    def evaluate(self, angle_rad: np.ndarray) -> np.ndarray:
        """The error at angles of the axis, (P,) rad; (P,) mm or rad.

        Raises
        ------
        InputError
            An angle beyond the table where extrapolation is refused.
        """
        low, high = np.degrees(self.position_rad[[0, -1]])
        beyond = (angle_rad < self.position_rad[0] - _END_SLACK_RAD) | (
            angle_rad > self.position_rad[-1] + _END_SLACK_RAD
        )
        if self.extrapolation is Extrapolation.REFUSE and beyond.any():
            raise InputError(
                f"{self.name} is asked for at {np.degrees(angle_rad[beyond][0]):.3f} deg, "
                "its table ends before",
                accepted=f"{low:g} .. {high:g} deg",
                hint=f'[errors.{self.name}] extrapolation = "hold" or "linear"',
            )
        return self.curve(angle_rad)


@dataclass(frozen=True)
class RotaryAxis:
    """A rotary axis and its errors.

    Attributes
    ----------
    travel_min_rad, travel_max_rad : float
    centre_mm : (3,) float64
        A point of the axis of rotation, in machine coordinates with every axis at zero.
    components : mapping of ISO 230-1 symbol to RotaryError
        As recorded, in the axes of the body that carries the rotary axis.
    location_mm, location_rad : (3,) float64
        Location errors: displacement and tilt of the real axis line at the centre, in the axes of
        the carrying body (EX0C, EY0C, EA0C, EB0C for a C axis); along and about the axis itself
        they do nothing.
    """

    travel_min_rad: float
    travel_max_rad: float
    centre_mm: np.ndarray
    components: Mapping[str, RotaryError] = field(default_factory=dict)
    location_mm: np.ndarray = field(default_factory=lambda: np.zeros(3))
    location_rad: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def motion(self, angle_rad: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Component errors at the centre as recorded: shift and rotation, (P, 3) mm and rad."""
        shift, rotation = np.zeros((2, len(angle_rad), 3))
        for name, component in self.components.items():
            angular = name[1] in ROTARY_AXES
            column = "XYZABC".index(name[1]) % 3
            (rotation if angular else shift)[:, column] = component.evaluate(angle_rad)
        return shift, rotation


def location_of(name: str) -> tuple[str, int, bool] | None:
    """Axis, direction index and whether it is an angle, of ``EX0C`` or ``XOC``; else None.

    ISO 230-1:2012 writes ``EX0C`` and ``EA0C``, ISO 230-7:2006 ``XOC`` and ``AOC``.
    """
    short = name[1:] if len(name) == 4 and name[0] == "E" else name
    if len(short) != 3 or short[1] not in "0O" or short[2] not in ROTARY_AXES:
        return None
    if short[0] not in "XYZABC":
        return None
    return short[2], "XYZABC".index(short[0]) % 3, short[0] in "ABC"
