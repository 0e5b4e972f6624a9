"""Where the spindle nose is, and which way it goes, at any place of any move.

Source: closed form derived here: a helix is a circle and a straight line in one parameter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gcode import MoveKind, Moves

__all__ = ["across", "last_direction", "move_length_mm", "position_at", "tangent_at"]

#: how far back along a move one looks for the way an axis came to a standstill
_BACK = 1e-6
#: an axis slower than this share of the path speed counts as standing
_STANDING = 1e-9
#: a tangent that is shorter has no direction
_NO_LENGTH_MM = 1e-9


def move_length_mm(moves: Moves) -> np.ndarray:
    """Length of every move's path, (N,) float64; helices and spirals by their mean radius."""
    straight = np.linalg.norm(moves.end_mm - moves.start_mm, axis=1)
    along = np.einsum("ij,ij->i", moves.end_mm - moves.start_mm, moves.axis)
    start_radius, end_radius = _radii(moves)
    in_plane = np.abs(moves.sweep_rad) * 0.5 * (start_radius + end_radius)
    in_plane = np.hypot(in_plane, end_radius - start_radius)
    return np.where(moves.kind == MoveKind.ARC, np.hypot(in_plane, along), straight)


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
    start, end = moves.start_mm[move], moves.end_mm[move]
    nose = start + parameter[:, None] * (end - start)
    arcs = np.flatnonzero(moves.kind[move] == MoveKind.ARC)
    if arcs.size:
        nose[arcs] = _OnArc.at(moves, move[arcs], parameter[arcs]).position()
    ends = parameter == 1.0
    nose[ends] = end[ends]
    return nose


def tangent_at(moves: Moves, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
    """Derivative of the nose position with respect to the parameter, (P, 3) float64, mm.

    Divided by the move's duration it is the velocity. Zero while the axes stand.
    """
    tangent = moves.end_mm[move] - moves.start_mm[move]
    arcs = np.flatnonzero(moves.kind[move] == MoveKind.ARC)
    if arcs.size:
        tangent[arcs] = _OnArc.at(moves, move[arcs], parameter[arcs]).derivative()
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


def _radii(moves: Moves) -> tuple[np.ndarray, np.ndarray]:
    """In-plane distance of start and end from the arc's axis, each (N,)."""
    radii = []
    for point in (moves.start_mm, moves.end_mm):
        offset = point - moves.centre_mm
        offset = offset - np.einsum("ij,ij->i", offset, moves.axis)[:, None] * moves.axis
        radii.append(np.linalg.norm(offset, axis=1))
    return radii[0], radii[1]


@dataclass(frozen=True)
class _OnArc:
    """Places on arcs, helices and spirals in the frames of their axes; columns of P rows."""

    centre: np.ndarray
    axis: np.ndarray
    parameter: np.ndarray
    sweep: np.ndarray
    start_along: np.ndarray
    climb: np.ndarray
    growth: np.ndarray
    radius: np.ndarray
    outward: np.ndarray
    onward: np.ndarray

    @classmethod
    def at(cls, moves: Moves, move: np.ndarray, parameter: np.ndarray) -> _OnArc:
        """At parameters (P,) of moves (P,), which are arcs."""
        axis, centre = moves.axis[move], moves.centre_mm[move]

        def split(point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            offset = point[move] - centre
            along = np.einsum("ij,ij->i", offset, axis)[:, None]
            return offset - along * axis, along

        first, start_along = split(moves.start_mm)
        last, end_along = split(moves.end_mm)
        start_radius = np.linalg.norm(first, axis=1, keepdims=True)
        growth = np.linalg.norm(last, axis=1, keepdims=True) - start_radius
        outward = first / start_radius
        s, sweep = parameter[:, None], moves.sweep_rad[move][:, None]
        return cls(centre, axis, s, sweep, start_along, end_along - start_along, growth,
                   start_radius + s * growth, outward, np.cross(axis, outward))  # fmt: skip

    def position(self) -> np.ndarray:
        """(P, 3) mm."""
        turn = self.parameter * self.sweep
        radial = np.cos(turn) * self.outward + np.sin(turn) * self.onward
        along = self.start_along + self.parameter * self.climb
        return self.centre + self.radius * radial + along * self.axis

    def derivative(self) -> np.ndarray:
        """With respect to the parameter, (P, 3) mm."""
        turn = self.parameter * self.sweep
        cos, sin = np.cos(turn), np.sin(turn)
        radial, tangential = (
            cos * self.outward + sin * self.onward,
            cos * self.onward - sin * self.outward,
        )
        return self.growth * radial + self.radius * self.sweep * tangential + self.climb * self.axis
