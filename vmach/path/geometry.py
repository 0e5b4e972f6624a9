"""Where the spindle nose is, and which way it goes, at any place of any move.

Source: closed form derived here: a helix is a circle and a straight line in one parameter.
"""

from __future__ import annotations

import math

import numpy as np

from gcode import MoveKind, Moves
from stock.compiled import njit_inlined, njit_kernel, read_only

__all__ = ["across", "last_direction", "move_length_mm", "position_at", "tangent_at"]

#: how far back along a move one looks for the way an axis came to a standstill
_BACK = 1e-6
#: an axis slower than this share of the path speed counts as standing
_STANDING = 1e-9
#: a tangent that is shorter has no direction
_NO_LENGTH_MM = 1e-9


def move_length_mm(moves: Moves) -> np.ndarray:
    """Length of every move's path, (N,) float64; helices and spirals by their mean radius."""
    length = np.linalg.norm(moves.end_mm - moves.start_mm, axis=1)
    arcs = np.flatnonzero(moves.kind == MoveKind.ARC)
    along = np.einsum("ij,ij->i", moves.end_mm[arcs] - moves.start_mm[arcs], moves.axis[arcs])
    start_radius, end_radius = _radii(moves, arcs)
    in_plane = np.abs(moves.sweep_rad[arcs]) * 0.5 * (start_radius + end_radius)
    length[arcs] = np.hypot(np.hypot(in_plane, end_radius - start_radius), along)
    return length


def position_at(moves: Moves, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
    """Nose position in machine coordinates.

    Parameters
    ----------
    moves : Moves
    move : (P,) int
        Index into `moves`.
    parameter : (P,) float64
        0 at the start of the move, 1 at its end.

    Returns
    -------
    (P, 3) float64, mm
    """
    nose = np.empty((len(move), 3))
    ends = read_only(moves.start_mm), read_only(moves.end_mm)
    _fill_positions(ends, read_only(move), read_only(parameter), nose)
    arcs = np.flatnonzero((moves.kind[move] == MoveKind.ARC) & (parameter != 1.0))
    _fill_arcs(_columns(moves), (arcs, move, parameter), _turned(moves, arcs, move, parameter),
               False, nose)  # fmt: skip
    return nose


@njit_kernel()
def _fill_positions(ends, move, parameter, nose):
    """Write places on straight moves, and the ends of all."""
    start, end = ends
    for i in range(len(move)):
        row, s = move[i], parameter[i]
        for j in range(3):
            if s == 1.0:
                nose[i, j] = end[row, j]
            else:
                nose[i, j] = start[row, j] + s * (end[row, j] - start[row, j])


def tangent_at(moves: Moves, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
    """Derivative of the nose position with respect to the parameter, (P, 3) float64, mm.

    Divided by the move's duration it is the velocity. Zero while the axes stand.
    """
    tangent = moves.end_mm[move] - moves.start_mm[move]
    arcs = np.flatnonzero(moves.kind[move] == MoveKind.ARC)
    _fill_arcs(_columns(moves), (arcs, move, parameter), _turned(moves, arcs, move, parameter),
               True, tangent)  # fmt: skip
    return tangent


def across(vector: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Parts of vectors (P, 3) that are across tangents (P, 3); all of them where one is zero."""
    length = np.linalg.norm(tangent, axis=-1, keepdims=True)
    unit = tangent / np.maximum(length, _NO_LENGTH_MM)
    return vector - np.sum(vector * unit, axis=-1, keepdims=True) * unit


def last_direction(moves: Moves, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
    """Sign of the last motion of each axis, (P, 3): -1, +1, or 0 before an axis first moved.

    An axis that stands still keeps the direction in which it came to rest.
    """
    leaving = _direction_within(moves, np.arange(len(moves)), np.ones(len(moves)))
    number = np.arange(len(moves))[:, None]
    latest = np.maximum.accumulate(np.where(leaving != 0.0, number, -1), axis=0)
    known = np.take_along_axis(leaving, np.maximum(latest, 0), axis=0)
    before = np.vstack([np.zeros((1, 3)), np.where(latest >= 0, known, 0.0)])
    own = _direction_within(moves, move, parameter)
    return np.where(own != 0.0, own, before[move])


def _direction_within(moves: Moves, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
    """Sign of the motion of each axis within the move itself, (P, 3); 0 where it stands."""
    now = _sign_of_motion(tangent_at(moves, move, parameter))
    a_little_earlier = np.maximum(parameter - _BACK, 0.0)
    earlier = _sign_of_motion(tangent_at(moves, move, a_little_earlier))
    return np.where(now != 0.0, now, earlier)


def _sign_of_motion(tangent: np.ndarray) -> np.ndarray:
    speed = np.linalg.norm(tangent, axis=1, keepdims=True)
    return np.where(np.abs(tangent) > _STANDING * speed, np.sign(tangent), 0.0)


def _radii(moves: Moves, arcs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """In-plane distance of start and end from the axis of some arcs (A,), each (A,)."""
    radii, axis = [], moves.axis[arcs]
    for point in (moves.start_mm, moves.end_mm):
        offset = point[arcs] - moves.centre_mm[arcs]
        offset = offset - np.einsum("ij,ij->i", offset, axis)[:, None] * axis
        radii.append(np.linalg.norm(offset, axis=1))
    return radii[0], radii[1]


def _columns(moves: Moves) -> tuple[np.ndarray, ...]:
    """What `_fill_arcs` needs of all moves."""
    columns = moves.start_mm, moves.end_mm, moves.centre_mm, moves.axis, moves.sweep_rad
    return tuple(map(read_only, columns))


def _turned(
    moves: Moves, arcs: np.ndarray, move: np.ndarray, parameter: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Cosine and sine of the angles that some of P places are on along their arcs, (A,) each."""
    angle = parameter[arcs] * moves.sweep_rad[move[arcs]]
    return np.cos(angle), np.sin(angle)


@njit_kernel()
def _fill_arcs(columns, places, turned, is_derivative, found):
    """Write positions on arcs, helices and spirals, or derivatives by the parameter."""
    starts, ends, centres, axes, sweeps = columns
    arcs, move, parameter = places
    for k in range(len(arcs)):
        row, s, cos, sin = move[arcs[k]], parameter[arcs[k]], turned[0][k], turned[1][k]
        axis, centre = _vector(axes, row), _vector(centres, row)
        first, along = _across_axis(_vector(starts, row), centre, axis)
        last, end_along = _across_axis(_vector(ends, row), centre, axis)
        radius = _length(first)
        growth = _length(last) - radius
        out = first[0] / radius, first[1] / radius, first[2] / radius
        here, climb = radius + s * growth, end_along - along
        on = (axis[1] * out[2] - axis[2] * out[1], axis[2] * out[0] - axis[0] * out[2],
              axis[0] * out[1] - axis[1] * out[0])  # fmt: skip
        for j in range(3):
            radial = cos * out[j] + sin * on[j]
            if is_derivative:
                tangential = cos * on[j] - sin * out[j]
                across = growth * radial + here * sweeps[row] * tangential
                found[arcs[k], j] = across + climb * axis[j]
            else:
                found[arcs[k], j] = centre[j] + here * radial + (along + s * climb) * axis[j]


@njit_inlined()
def _vector(rows, k):
    return rows[k, 0], rows[k, 1], rows[k, 2]


@njit_inlined()
def _across_axis(point, centre, axis):
    """What of a point's place from the centre is across the axis, and how far it is along it."""
    x, y, z = point[0] - centre[0], point[1] - centre[1], point[2] - centre[2]
    along = x * axis[0] + z * axis[2] + y * axis[1]
    return (x - along * axis[0], y - along * axis[1], z - along * axis[2]), along


@njit_inlined()
def _length(vector):
    return math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])
