"""Errors of the tool tip along a path of nose positions, such as the outline of a part.

Source: Huddersfield paper (errors along a profile); the equations of
`vmach.machine.displacement`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.files.text_file import column_hint, csv_rows, read_text
from vmach.machine import Machine, Variant, displacement
from vmach.volumetric.farthest_pair import farthest_pair

__all__ = ["Profile", "ProfileErrors", "read_profile"]


@dataclass(frozen=True)
class ProfileErrors:
    """Error along a profile.

    Attributes
    ----------
    distance_mm : (P,) float64
        Along the path from its start.
    nose_mm, error_mm : (P, 3) float64
    """

    distance_mm: np.ndarray
    nose_mm: np.ndarray
    error_mm: np.ndarray

    @property
    def largest_difference_mm(self) -> float:
        """Longest difference between the errors at two points of the path."""
        return farthest_pair(self.error_mm)[2]


@dataclass(frozen=True)
class Profile:
    """Nose positions in machine coordinates in the order in which they are passed, (P, 3) mm."""

    nose_mm: np.ndarray

    def divided(self, spacing_mm: float) -> Profile:
        """The same path of straight lines with positions at most `spacing_mm` apart."""
        pieces = [self.nose_mm[:1]]
        for start, end in pairwise(self.nose_mm):
            count = max(1, math.ceil(np.linalg.norm(end - start) / spacing_mm))
            pieces.append(np.linspace(start, end, count + 1)[1:])
        return Profile(np.vstack(pieces))

    def errors(self, machine: Machine, tool_mm: np.ndarray, variant: Variant) -> ProfileErrors:
        """Displacement of the tip at every position, by the direction of the last motion.

        Parameters
        ----------
        machine : Machine
        tool_mm : (3,) float64
            Vector from nose to tip.
        variant : Variant
        """
        steps = np.diff(self.nose_mm, axis=0)
        moved = displacement(
            machine, self.nose_mm, tool_mm, variant, direction=_last_direction(steps)
        )
        distance = np.concatenate(([0.0], np.cumsum(np.linalg.norm(steps, axis=1))))
        return ProfileErrors(distance, self.nose_mm, moved.shift_mm)


def _last_direction(steps_mm: np.ndarray) -> np.ndarray:
    """Sign of the last motion of every axis on reaching each position, kept while it stands."""
    sign = np.vstack((np.zeros((1, 3)), np.sign(steps_mm)))
    row = np.where(sign != 0, np.arange(len(sign))[:, None], 0)
    return np.take_along_axis(sign, np.maximum.accumulate(row, axis=0), axis=0)


def read_profile(path: Path) -> Profile:
    """Read a CSV with the columns x, y, z: nose positions, mm.

    Raises
    ------
    InputError
        No such file, a column that is missing, a cell that is no finite number, no rows.
    """
    rows = csv_rows(read_text(path, what="profile").splitlines(), path)
    header = [cell.strip().lower() for cell in next(rows, [])]
    if not {"x", "y", "z"} <= set(header):
        raise InputError(
            f"header '{','.join(header)}'",
            file=path,
            line=1,
            accepted="x, y, z",
            hint=column_hint(header),
        )
    columns = [header.index(name) for name in "xyz"]
    points = []
    for line, row in enumerate(rows, 2):
        if not any(cell.strip() for cell in row):
            continue
        try:
            point = [float(row[column]) for column in columns]
        except (ValueError, IndexError):
            point = [math.nan]
        if not all(map(math.isfinite, point)):
            raise InputError(
                f"row '{','.join(row)}'", file=path, line=line, accepted="finite numbers x, y, z"
            )
        points.append(point)
    if not points:
        raise InputError("the profile has no points", file=path)
    return Profile(np.array(points))
