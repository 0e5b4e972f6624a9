"""Body and face diagonals of a volume, ISO 230-6: positioning along a skew line.

A laser on a diagonal sees the error along the diagonal only. The figures are those of ISO 230-2
(ISO 230-6 refers to it), here from the model instead of from readings.

Source: ISO 230-6, body and face diagonals; ISO 230-2 for the figures.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from vmach.iso230 import Evaluation, evaluate
from vmach.machine import LINEAR_AXES, Machine, Variant, displacement
from vmach.machine.tables.runs import Runs
from vmach.volumetric.field import Volume

__all__ = ["Diagonal", "diagonals"]

_TARGETS = 21  #: target positions along each diagonal


@dataclass(frozen=True)
class Diagonal:
    """Deviation along one diagonal.

    Attributes
    ----------
    name : str
        Signs of the axes that move from the first end to the last: ``+X +Y -Z``; face diagonals
        have two.
    start_mm, end_mm : (3,) float64
        Nose positions of the ends.
    result : Evaluation
        Of the deviation along the diagonal against the distance from its start, mm; zero at the
        start as on a laser. Forward is from start to end.
    """

    name: str
    start_mm: np.ndarray
    end_mm: np.ndarray
    result: Evaluation


def diagonals(
    machine: Machine, volume: Volume, tool_mm: np.ndarray, variant: Variant
) -> tuple[Diagonal, ...]:
    """The four body diagonals and the six face diagonals (through the middle of the volume).

    Parameters
    ----------
    machine : Machine
    volume : Volume
    tool_mm : (3,) float64
    variant : Variant
    """
    # each line once: the first axis that moves goes up
    signs = [np.array([1.0, y, z]) for y in (1.0, -1.0) for z in (1.0, -1.0)]
    for first, second in combinations(range(3), 2):
        for other in (1.0, -1.0):
            face = np.zeros(3)
            face[first], face[second] = 1.0, other
            signs.append(face)
    low, high = np.asarray(volume.low_mm), np.asarray(volume.high_mm)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    found = []
    for sign in signs:
        line = np.linspace(middle - sign * half, middle + sign * half, _TARGETS)
        result = _along(machine, line, tool_mm, variant)
        found.append(Diagonal(_name(sign), line[0], line[-1], result))
    return tuple(found)


def _name(sign: np.ndarray) -> str:
    return " ".join(
        f"{'+' if s > 0 else '-'}{axis}" for axis, s in zip(LINEAR_AXES, sign, strict=True) if s
    )


def _along(
    machine: Machine, line_mm: np.ndarray, tool_mm: np.ndarray, variant: Variant
) -> Evaluation:
    """Deviation along a line, approached from either side."""
    way = line_mm[-1] - line_mm[0]
    length = float(np.linalg.norm(way))
    readings = []
    for sense in (1.0, -1.0):
        direction = np.tile(sense * np.sign(way), (len(line_mm), 1))
        moved = displacement(machine, line_mm, tool_mm, variant, direction=direction)
        readings.append(moved.shift_mm @ (way / length))
    zero = readings[0][0]
    distance = np.linspace(0.0, length, len(line_mm))
    return evaluate(Runs(distance, readings[0] - zero, readings[1] - zero))
