"""What the axes and the spindle did before a given moment: the memory that effects have.

Everything is worked out once per program on a polyline of the path, whose corners are the ends
of moves and, on arcs, points close enough together, among them those where an axis reverses.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit

from gcode import MoveKind, Moves
from vmach.path_geometry import move_length_mm, position_at

__all__ = ["REFERENCE_AXIS_MM_PER_S", "MotionHistory"]

#: mean speed of an axis that thermal amplitudes are stated at: 100 mm/min
REFERENCE_AXIS_MM_PER_S = 100.0 / 60.0

#: largest angle between neighbouring corners of the polyline on an arc
_ARC_STEP_RAD = np.pi / 32
#: cosines that the temperature along a screw is made of
_SCREW_WAVES = 12
#: of carbon steel near room temperature
_STEEL_DIFFUSIVITY_MM2_PER_S = 13.0


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

    def response(
        self, drive: np.ndarray, time_constant_s: float, *, move: np.ndarray, time_s: np.ndarray
    ) -> np.ndarray:
        """First-order response, from cold, to a drive that is constant during every move.

        Parameters
        ----------
        drive : (N,) float64
            What the response tends to during each move.
        time_constant_s : float
        move, time_s : (P,)
            Where it is asked for.

        Returns
        -------
        (P,) float64
        """
        moves = self.moves
        start = _states_at_starts(drive, moves.duration_s, time_constant_s)
        faded = np.exp(-(time_s - moves.start_s[move]) / time_constant_s)
        return drive[move] + (start[move] - drive[move]) * faded

    def screw_warmth_mm(
        self, axis: int, time_constant_s: float, *, travel_mm: tuple[float, float],
        move: np.ndarray, time_s: np.ndarray, position_mm: np.ndarray,
    ) -> np.ndarray:  # fmt: skip
        """Warmth of a screw that is heated where its nut runs, summed from home to the nut.

        Heat enters the places that the nut passes, by the way it makes there, spreads along the
        steel and is lost to the air with the time constant; no heat leaves by the ends. The
        temperature is a sum of cosines along the screw, each of which follows its share of the
        heat with a lag of its own: 1 / time constant + diffusivity (m pi / length)^2. Used all
        the time and everywhere alike, at the reference speed, the screw has a warmth of 1.

        Parameters
        ----------
        axis : int
        time_constant_s : float
        travel_mm : (float, float)
            Where the screw begins and ends.
        move, time_s, position_mm : (P,)
            Where it is asked for; positions of the axis.

        Returns
        -------
        (P,) float64
            Integral of the warmth over the screw from 0 to `position_mm`, mm.
        """
        low, high = travel_mm
        wave = np.pi * np.arange(1, _SCREW_WAVES + 1) / (high - low)
        rate = 1.0 / time_constant_s + _STEEL_DIFFUSIVITY_MM2_PER_S * wave**2
        summed = self.axis_speed_mm_per_s[:, axis] / REFERENCE_AXIS_MM_PER_S
        summed = self.response(summed, time_constant_s, move=move, time_s=time_s) * position_mm
        for k, drive in enumerate(self._heat_of_waves(axis, wave, low).T):
            lag = 1.0 / rate[k]
            warmth = self.response(drive * lag / time_constant_s, lag, move=move, time_s=time_s)
            sines = np.sin(wave[k] * (position_mm - low)) - np.sin(-wave[k] * low)
            summed += warmth * sines / wave[k]
        return summed

    def _heat_of_waves(self, axis: int, wave: np.ndarray, low: float) -> np.ndarray:
        """Heat of every move in cosines along the screw, in reference speeds, (N, waves)."""
        if axis in self._heats:  # the travel, and with it the waves, are those of the machine
            return self._heats[axis]
        key, corner = self._corners
        owner = np.minimum(key[:-1].astype(np.int64), len(self.moves) - 1)
        sines = np.sin(np.multiply.outer(corner[:, axis] - low, wave)) / wave
        forwards = np.sign(np.diff(corner[:, axis]))[:, None]
        way = np.zeros((len(self.moves), len(wave)))
        np.add.at(way, owner, 2.0 * forwards * np.diff(sines, axis=0))
        duration = self.moves.duration_s[:, None]
        per_s = np.divide(way, duration, out=np.zeros_like(way), where=duration > 0)
        self._heats[axis] = per_s / REFERENCE_AXIS_MM_PER_S
        return self._heats[axis]

    @cached_property
    def _heats(self) -> dict[int, np.ndarray]:
        return {}

    @cached_property
    def axis_speed_mm_per_s(self) -> np.ndarray:
        """Mean speed of each axis during every move, (N, 3)."""
        way = np.abs(self.moves.end_mm - self.moves.start_mm)
        key, corner = self._corners
        steps = np.abs(np.diff(corner, axis=0))
        owner = np.minimum(key[:-1].astype(np.int64), len(self.moves) - 1)
        for axis in range(3):
            way[:, axis] = np.bincount(owner, steps[:, axis], len(self.moves))
        duration = self.moves.duration_s[:, None]
        return np.divide(way, duration, out=np.zeros_like(way), where=duration > 0)

    def cutting_way_mm(self, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
        """Way that the tool in the spindle has gone at feed since the program's start, (P,)."""
        moves = self.moves
        feeding = (moves.kind == MoveKind.LINE) | (moves.kind == MoveKind.ARC)
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


@njit(cache=True)
def _states_at_starts(drive, duration, time_constant):
    """State of a first-order lag at the start of every move, from zero."""
    start = np.zeros(len(drive))
    for k in range(len(drive) - 1):
        faded = np.exp(-duration[k] / time_constant)
        start[k + 1] = drive[k] + (start[k] - drive[k]) * faded
    return start
