"""What the axes and the spindle did before a given moment: the memory that effects have.

Everything is worked out once per program on a polyline of the path, whose corners are the ends
of moves and, on arcs, points close enough together, among them those where an axis reverses.

Source: M. Krasnosel'skii and A. Pokrovskii, Systems with Hysteresis (1989), play operator; closed
form derived here: warmth as in `vmach.path.heat_history`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit

from gcode import MoveKind, Moves
from vmach.path.geometry import move_length_mm, position_at
from vmach.path.heat_history import HeatHistory, response

__all__ = ["MotionHistory"]

#: largest angle between neighbouring corners of the polyline on an arc
_ARC_STEP_RAD = np.pi / 32


@dataclass(frozen=True)
class MotionHistory:
    """The history of one program, asked at places given as (move, parameter)."""

    moves: Moves

    @cached_property
    def _corners(self) -> tuple[np.ndarray, np.ndarray]:
        """Key (move + parameter) and nose position of the polyline's corners."""
        moves = self.moves
        count = len(moves)
        keys = [np.arange(count + 1, dtype=float)]
        for arc in np.flatnonzero(moves.kind == MoveKind.ARC):
            keys.append(arc + _places_on_arc(moves, int(arc)))
        key = np.unique(np.concatenate(keys))
        move = np.minimum(key.astype(np.int64), count - 1)
        return key, position_at(moves, move, key - move)

    def play(
        self, key: np.ndarray, nose_mm: np.ndarray, *, width_mm: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Side on which each axis lies in a dead band of the given width, and the way since.

        The carriage rests until the drive has crossed the band (the play operator): a motion
        smaller than the band does not count as a reversal.

        Parameters
        ----------
        key : (P,) float64
            Move plus parameter.
        nose_mm : (P, 3) float64
            Position there.
        width_mm : float

        Returns
        -------
        side : (P, 3) float64
            +1 after motion in positive direction, -1 negative, in between while crossing;
            0 before the axis first moved.
        travel_mm : (P, 3) float64
            Way of the axis since it last reversed.
        since : (P, 3) float64
            Key (move + parameter) of that reversal.
        """
        corner_key, corner = self._corners
        at = np.clip(np.searchsorted(corner_key, key, side="left") - 1, 0, len(corner_key) - 1)
        order = np.argsort(at, kind="stable")
        side, travel, since = np.empty((3, len(key), 3))
        for axis in range(3):
            found = _follow(corner[:, axis], corner_key, at[order], nose_mm[order, axis], width_mm)
            side[order, axis], travel[order, axis], since[order, axis] = found
        return side, travel, since

    def spindle_warmth(
        self, drive: np.ndarray, time_constant_s: float, time_s: np.ndarray
    ) -> np.ndarray:
        """First-order response to a drive (N,) that is constant during every move, (P,)."""
        start_s, duration_s = self.moves.start_s, self.moves.duration_s
        return response(
            drive, time_constant_s, start_s=start_s, duration_s=duration_s, time_s=time_s
        )

    @cached_property
    def heat(self) -> HeatHistory:
        """What the axes have warmed by moving."""
        key, corner = self._corners
        move = np.minimum(key[:-1].astype(np.int64), len(self.moves) - 1)
        duration = self.moves.duration_s[move]
        start_s = self.moves.start_s[move] + (key[:-1] - move) * duration
        return HeatHistory(corner, start_s, np.diff(key) * duration)

    def cutting_length_mm(self, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
        """Way that the tool in the spindle has gone at feed since the program's start, (P,)."""
        moves = self.moves
        feeding = moves.at_feed
        length = np.where(feeding, move_length_mm(moves), 0.0)
        before = np.zeros(len(moves))
        for tool in np.unique(moves.tool):
            own = np.flatnonzero(moves.tool == tool)
            before[own] = np.cumsum(length[own]) - length[own]
        return before[move] + parameter * length[move]


def _places_on_arc(moves: Moves, arc: int) -> np.ndarray:
    """Parameters of the corners on an arc: equal steps, and where X, Y or Z reverses."""
    sweep = moves.sweep_rad[arc]
    steps = int(np.ceil(abs(sweep) / _ARC_STEP_RAD))
    places = np.arange(1, steps) / steps
    outward = moves.start_mm[arc] - moves.centre_mm[arc]
    onward = np.cross(moves.axis[arc], outward)
    # the coordinate cos(a) outward + sin(a) onward is extreme where tan(a) = onward / outward
    first = np.arctan2(onward, outward)
    turns = np.arange(-1, 2 * int(abs(sweep) / (2 * np.pi)) + 4) * np.pi
    angle = np.add.outer(np.sign(sweep) * first, turns).ravel()
    extreme = angle / abs(sweep)
    inside = (extreme > 1e-9) & (extreme < 1 - 1e-9)
    return np.concatenate([places, extreme[inside]])


@njit(cache=True)
def _follow(corner, corner_key, at, position, width):
    """Play operator along the corners, asked at sorted indices `at` plus the last bit of way."""
    count = len(at)
    side, travel, since = np.zeros(count), np.zeros(count), np.zeros(count)
    half = 0.5 * width
    lag, way, sign, turned = 0.0, 0.0, 0.0, 0.0
    asked = 0
    for k in range(len(corner)):
        if k > 0:
            step = corner[k] - corner[k - 1]
            lag = min(max(lag + step, -half), half)
            way += abs(step)
            if sign * lag <= 0.0 and lag != 0.0:
                sign, way, turned = np.sign(lag), abs(step), corner_key[k - 1]
        while asked < count and at[asked] == k:
            step = position[asked] - corner[k]
            here = min(max(lag + step, -half), half)
            side[asked] = here / half
            flips = sign * here <= 0.0 and here != 0.0
            travel[asked] = abs(step) if flips else way + abs(step)
            since[asked] = corner_key[k] if flips else turned
            asked += 1
        if asked == count:
            break
    return side, travel, since
