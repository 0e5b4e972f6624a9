"""Pieces of compensated motion: where points are inserted and which arcs stay arcs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from gcode import Moves
from vmach.path_geometry import position_at

__all__ = ["Piece", "circle_through", "split_arc", "split_line"]

#: an arc is cut into arcs of no more than this, so that start and end stay apart
_LARGEST_SWEEP_RAD = np.radians(181.0)
#: a circle of larger radius is written as a line
_LARGEST_RADIUS_MM = 1e5


@dataclass(frozen=True)
class Piece:
    """One block of the compensated program.

    Attributes
    ----------
    move : int
        Row of the nominal moves.
    start, end : float
        Stretch of that move, 0 to 1; equal for a step that takes up a jump of the error.
    is_arc : bool
    kept : bool
        The block stays as it is.
    """

    move: int
    start: float
    end: float
    is_arc: bool = False
    kept: bool = False


def circle_through(first: np.ndarray, middle: np.ndarray, last: np.ndarray) -> np.ndarray | None:
    """Centre (2,) of the circle through three points of a plane; None where they are in line."""
    a, b = middle - first, last - first
    twice_area = 2.0 * (a[0] * b[1] - a[1] * b[0])
    if abs(twice_area) * _LARGEST_RADIUS_MM <= abs(a @ a * np.linalg.norm(b)):
        return None
    x = (b[1] * (a @ a) - a[1] * (b @ b)) / twice_area
    y = (a[0] * (b @ b) - b[0] * (a @ a)) / twice_area
    return first + np.array([x, y])


def split_line(
    move: int, parameter: np.ndarray, correction_mm: np.ndarray, tolerance_mm: float
) -> Iterator[Piece]:
    """Cut a straight move where linear interpolation of the correction is not good enough."""
    ends = [(0, len(parameter) - 1)]
    while ends:
        i, j = ends.pop()
        share = (parameter[i : j + 1] - parameter[i]) / (parameter[j] - parameter[i])
        chord = correction_mm[i] + share[:, None] * (correction_mm[j] - correction_mm[i])
        off = np.linalg.norm(correction_mm[i : j + 1] - chord, axis=1)
        if j - i > 1 and off.max() > tolerance_mm:
            cut = i + int(np.clip(np.argmax(off), 1, j - i - 1))
            ends += [(cut, j), (i, cut)]
        else:
            yield Piece(move, float(parameter[i]), float(parameter[j]))


def split_arc(
    moves: Moves,
    move: int,
    parameter: np.ndarray,
    correction_mm: np.ndarray,
    *,
    tolerance_mm: float,
) -> Iterator[Piece]:
    """Cut an arc into arcs that pass the corrected points, or lines where none does."""
    nominal = position_at(moves, np.full(len(parameter), move), parameter)
    points = nominal + correction_mm
    ends = [(0, len(parameter) - 1)]
    while ends:
        i, j = ends.pop()
        sweep = abs(moves.sweep_rad[move]) * (parameter[j] - parameter[i])
        fits = _circle_miss(points[i : j + 1], moves.axis[move]) <= tolerance_mm
        if j - i >= 2 and fits and sweep <= _LARGEST_SWEEP_RAD:
            yield Piece(move, float(parameter[i]), float(parameter[j]), is_arc=True)
        elif j - i == 1:
            yield Piece(move, float(parameter[i]), float(parameter[j]))
        else:
            ends += [((i + j) // 2, j), (i, (i + j) // 2)]


def _circle_miss(points: np.ndarray, axis: np.ndarray) -> float:
    """Largest distance of points (K, 3) from the helix through first, middle and last."""
    side = [k for k in range(3) if abs(axis[k]) < 0.5]
    flat, height = points[:, side], points @ axis
    centre = circle_through(flat[0], flat[len(flat) // 2], flat[-1])
    if centre is None:
        return np.inf
    radius = np.linalg.norm(flat - centre, axis=1)
    rise = np.linspace(height[0], height[-1], len(points))
    return float(np.hypot(radius - radius[0], height - rise).max())
