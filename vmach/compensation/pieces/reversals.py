"""Where axes turn back, and how far on the lost motion is taken up.

Source: closed form derived here: an arc turns an axis back where its tangent has no share of that
axis.
"""

from __future__ import annotations

import numpy as np

from gcode import Moves
from vmach.path.geometry import last_direction, position_at

__all__ = ["TAKE_UP_MM", "is_taken_up", "reversals_of_arcs", "settled", "turned_at_start"]

#: way of an axis after which its lost motion counts as taken up
TAKE_UP_MM = 0.03
#: one looks no farther from a reversal
_FARTHEST_MM = 2.5
#: places whose ladders are looked at in one go
_PLACES_AT_ONCE = 4096
#: lost motion is taken up by this share halfway, and does not go on after that
_SUDDEN = 0.75
#: parameters, from a reversal on, at which one looks whether it is taken up
_LADDER = np.geomspace(1e-5, 0.5, 41)


def turned_at_start(moves: Moves, move: np.ndarray) -> np.ndarray:
    """Axes that turn back where moves (M,), in their order, begin; (M, 3) bool."""
    now = last_direction(moves, move, np.full(len(move), _LADDER[0]))
    before = np.zeros_like(now)
    before[1:] = last_direction(moves, move[:-1], np.ones(max(len(move) - 1, 0)))
    return now * before < 0.0


def reversals_of_arcs(moves: Moves, arcs: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where axes turn back on arcs, in order.

    Parameters
    ----------
    moves : Moves
    arcs : (A,) int64

    Returns
    -------
    arc : (K,) int64
        Index into `arcs`.
    place : (K,) float64
        Parameter, between 0 and 1.
    axis : (K, 3) bool
        Which axis.
    """
    normal, sweep = moves.axis[arcs], moves.sweep_rad[arcs]
    start = moves.start_mm[arcs] - moves.centre_mm[arcs]
    onward = np.cross(normal, start)
    most = int(np.ceil(np.abs(sweep).max(initial=0.0) / np.pi + 2.0))
    half_turns = np.pi * np.arange(-1.0, most - 1.0) * np.sign(sweep)[:, None]
    owners, places, axes = [], [], []
    for axis in range(3):
        angle = np.arctan2(onward[:, axis], start[:, axis])[:, None] + half_turns
        found = angle / sweep[:, None]
        inside = (found > _LADDER[0]) & (found < 1.0 - _LADDER[0])
        inside &= (np.abs(normal[:, axis]) < 0.5)[:, None]
        owners.append(np.nonzero(inside)[0])
        places.append(found[inside])
        axes.append(np.full(len(places[-1]), axis))
    owner, place, axis = (np.concatenate(a) for a in (owners, places, axes))
    order = np.lexsort((place, owner))
    return owner[order], place[order], np.arange(3) == axis[order, None]


def is_taken_up(
    at_once: np.ndarray, halfway: np.ndarray, in_full: np.ndarray, farther: np.ndarray, *,
    least_mm: np.ndarray | float,
) -> np.ndarray:  # fmt: skip
    """Whether an error changes as one that is taken up and then stays, (P,) bool.

    Parameters
    ----------
    at_once, halfway, in_full, farther : (P, 3) float64
        The error where an axis turns back, where it is taken up (`settled`), halfway there and
        at twice that way, mm.
    least_mm : (P,) float64 or float
        A smaller change is none.
    """
    growth = np.linalg.norm(in_full - at_once, axis=1)
    grows = growth > least_mm
    grows &= np.linalg.norm(halfway - at_once, axis=1) > _SUDDEN * growth
    return grows & (np.linalg.norm(farther - in_full, axis=1) < (1.0 - _SUDDEN) * growth)


def settled(
    moves: Moves, move: np.ndarray, place: np.ndarray, turned: np.ndarray, *, length_mm: np.ndarray
) -> np.ndarray:
    """Parameters, (P,), from which on the play of axes that turned back is taken up.

    Parameters
    ----------
    moves : Moves
    move : (P,) int64
    place : (P,) float64
        Where they turned back.
    turned : (P, 3) bool
        Which did; just after the place where none.
    length_mm : (P,) float64
        Of the moves' paths.
    """
    found = np.minimum(place + _LADDER[0], 1.0)
    rows = np.flatnonzero(turned.any(axis=1))
    for begin in range(0, len(rows), _PLACES_AT_ONCE):
        part = rows[begin : begin + _PLACES_AT_ONCE]
        found[part] = _taken_up(moves, move[part], place[part], turned[part], length_mm[part])
    return found


def _taken_up(
    moves: Moves, move: np.ndarray, place: np.ndarray, turned: np.ndarray, length_mm: np.ndarray
) -> np.ndarray:
    """`settled` for places where an axis turned back."""
    later = np.minimum(place[:, None] + _LADDER, 0.5 * (1.0 + place[:, None]))
    owner = np.repeat(move, len(_LADDER))
    there = position_at(moves, owner, later.ravel()).reshape(len(move), len(_LADDER), 3)
    way = np.abs(there - position_at(moves, move, place)[:, None])
    ready = ((way >= TAKE_UP_MM) | ~turned[:, None]).all(axis=2)
    ready |= _LADDER * length_mm[:, None] > _FARTHEST_MM
    first = np.where(ready.any(axis=1), np.argmax(ready, axis=1), len(_LADDER) - 1)
    return later[np.arange(len(move)), first]
