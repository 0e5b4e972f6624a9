"""How the path bends and where it has corners: what servo drives respond to.

Source: closed form derived here: curvature 1/R towards the centre of an arc; the turn of short
lines over their mean length.
"""

from __future__ import annotations

import numpy as np

from gcode import MoveKind, Moves
from vmach.path.geometry import move_length_mm, tangent_at

__all__ = ["corner_before", "curvature_per_mm"]

#: a change of direction by more than this is a corner, by less a smooth path in small steps
_CORNER_RAD = np.radians(15.0)


def curvature_per_mm(moves: Moves, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
    """Curvature vector, towards the centre, length 1/R, (P, 3) per mm.

    On arcs that of the circle. On straight moves that of the smooth curve which they approximate:
    change of direction from the move before to the move after, over the way in between; corners
    do not count.
    """
    curvature = _of_straight_moves(moves)[move]
    arcs = np.flatnonzero(moves.kind[move] == MoveKind.ARC)
    if arcs.size:
        tangent = tangent_at(moves, move[arcs], parameter[arcs])
        a_bit = 1e-4
        further = tangent_at(moves, move[arcs], parameter[arcs] + a_bit)
        length = np.linalg.norm(tangent, axis=1, keepdims=True)
        turned = further / np.linalg.norm(further, axis=1, keepdims=True) - tangent / length
        curvature[arcs] = turned / (a_bit * length)
    return curvature


def corner_before(
    moves: Moves, move: np.ndarray, time_s: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The last corner that the path went round.

    Returns
    -------
    jump_mm_per_s : (P, 3) float64
        Velocity after the corner minus velocity before it.
    elapsed_s : (P,) float64
        Time since.
    """
    count = len(moves)
    everything = np.arange(count)
    entering = _velocity(moves, everything, np.zeros(count))
    leaving = _velocity(moves, everything, np.ones(count))
    before = np.vstack([np.zeros(3), leaving[:-1]])
    jump = entering - before
    corner = ~_is_smooth(before, entering)
    corner[0] = True
    last = np.maximum.accumulate(np.where(corner, everything, 0))[move]
    return jump[last], time_s - moves.start_s[last]


def _of_straight_moves(moves: Moves) -> np.ndarray:
    """Curvature of the curve behind a run of short straight moves, (N, 3); zero elsewhere."""
    length = move_length_mm(moves)
    line = (moves.kind == MoveKind.LINE) & (length > 0)
    direction = np.where(line[:, None], moves.end_mm - moves.start_mm, 0.0)
    direction = direction / np.where(line, length, 1.0)[:, None]
    smooth = line[1:] & line[:-1] & _is_smooth(direction[:-1], direction[1:])
    turn = np.where(smooth[:, None], direction[1:] - direction[:-1], 0.0)
    way = np.where(smooth, 0.5 * (length[1:] + length[:-1]), 0.0)
    total_turn, total_way = np.zeros((len(moves), 3)), np.zeros(len(moves))
    for part in (slice(1, None), slice(None, -1)):
        total_turn[part] += turn
        total_way[part] += way
    return total_turn / np.where(total_way > 0, total_way, 1.0)[:, None]


def _is_smooth(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Whether two velocities (N, 3) differ little in direction and size, (N,) bool."""
    size = np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1)
    limit = 2.0 * np.sin(0.5 * _CORNER_RAD) * np.minimum(*size)
    return np.linalg.norm(after - before, axis=1) < limit


def _velocity(moves: Moves, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
    tangent = tangent_at(moves, move, parameter)
    duration = moves.duration_s[move][:, None]
    return np.divide(tangent, duration, out=np.zeros_like(tangent), where=duration > 0)
