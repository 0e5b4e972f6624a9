"""Workpiece zero and tool lengths set on the machine itself, and what its touches take off.

The control knows where it commanded the tool when it touched; the tool was e further. It counts
from there, so what the machine gets wrong at the place of touch is in all it does, with the other
sign:

    e'(p) = e(p) - (e_x(P_x), e_y(P_y), e_z(P_z)) - (0, 0, e_z(S, tool) - e_z(S, probe))

with P_x, P_y, P_z where probe or edge finder touched for each axis, and S where the tools' lengths
were touched. With S = P_z every tool has its own e_z(P_z). Lengths from a presetter have no S.

Source: closed form derived here: a zero that is set at the commanded place x - e counts from it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gcode import WORK_OFFSETS
from vmach.errors import InputError
from vmach.job import Job, Probing
from vmach.machine import RigidDisplacement
from vmach.path.instrument_motion import MotionRecord
from vmach.path.toolpath import PathStates

__all__ = ["TouchedZero", "relative_to_zero", "touched_zero"]

#: touches of one tool in one work offset: X, Y, Z by the probe; then the tool, and the probe, at S
_TOUCHES = 5
#: time of a move and a touch, and how far the axes come from
_PACE_S, _RUN_UP_MM = 10.0, 2.0


@dataclass(frozen=True)
class TouchedZero:
    """Touches, and which of them the zero at each of P states is made of.

    Attributes
    ----------
    states : PathStates
        5 touches of every tool in every work offset, before the program begins.
    pair : (P,) int64
        Which five belong to each state.
    is_preset : bool
        Tools were measured off the machine.
    """

    states: PathStates
    pair: np.ndarray
    is_preset: bool

    def shift_mm(self, at_touch_mm: np.ndarray) -> np.ndarray:
        """What the zero takes off at each state, (P, 3, ...) mm.

        Parameters
        ----------
        at_touch_mm : (5 U, 3, ...) float64
            A displacement of the tip at every touch.
        """
        touch = at_touch_mm.reshape(-1, _TOUCHES, *at_touch_mm.shape[1:])
        height = touch[:, 2, 2] + (0.0 if self.is_preset else touch[:, 3, 2] - touch[:, 4, 2])
        return np.stack([touch[:, 0, 0], touch[:, 1, 1], height], axis=1)[self.pair]


def touched_zero(job: Job, states: PathStates) -> TouchedZero | None:
    """The touches that the zero of some states was set by.

    None where the job says nothing of it, and for no states at all.

    Raises
    ------
    InputError
        A touch outside the travel.
    """
    if job.probing is None or len(states.move) == 0:
        return None
    moves = states.moves
    used = np.column_stack([moves.work_offset[states.move], states.tool])
    pairs, pair = np.unique(used, axis=0, return_inverse=True)
    return TouchedZero(_touches(job, pairs), pair.ravel(), job.probing.tools == "preset")


def relative_to_zero(
    job: Job, states: PathStates, displacement: Callable[[PathStates], RigidDisplacement]
) -> RigidDisplacement:
    """A displacement of the tool, counted from the zero that was touched on this machine.

    Parameters
    ----------
    job : Job
    states : PathStates
    displacement : callable
        Of the tool at any states, as the machine makes it.
    """
    moved = displacement(states)
    zero = touched_zero(job, states)
    if zero is None:
        return moved
    taken_off = zero.shift_mm(displacement(zero.states).shift_mm)
    return replace(moved, shift_mm=moved.shift_mm - taken_off)


def _touches(job: Job, pairs: np.ndarray) -> PathStates:
    """States of the machine at every touch, each reached from the side that the job says."""
    said = job.probing
    assert said is not None
    lengths = _lengths(job, said)
    probe = len(lengths) - 1
    places = [*said.at_mm, said.tools_at_mm, said.tools_at_mm]
    nose, tool, offset = [], [], []
    for number, own in pairs:
        zero = _zero(job, int(number))
        for k, place in enumerate(places):
            carried = int(own) if k == 3 else probe
            nose.append(zero + place + [0.0, 0.0, lengths[carried]])
            tool.append(carried)
            offset.append(int(number))
    _check_travel(job, np.array(nose))
    record = MotionRecord(nose[0], tool_length_mm=0.0, start_s=-2.0 * _PACE_S * (len(nose) + 1))
    stops, moved = [], []
    way = np.array(said.approach, dtype=float)
    for k, place in enumerate(nose):
        clock = -2.0 * _PACE_S * (len(nose) - k)
        record.line(place - _RUN_UP_MM * way, until_s=clock)
        record.line(place, until_s=clock + _PACE_S)
        stops.append(record.stand(until_s=clock + 2.0 * _PACE_S))
        moved += [k] * 3
    states = record.states(np.array(stops), np.ones(len(stops)))
    moves = replace(states.moves, tool=np.array(tool)[moved], work_offset=np.array(offset)[moved])
    return replace(states, moves=moves, tool_lengths_mm=lengths)


def _lengths(job: Job, said: Probing) -> np.ndarray:
    """Length of every tool by its number, and of the probe behind them."""
    lengths = np.full(max(job.tools) + 2, np.nan)
    for number, tool in job.tools.items():
        lengths[number] = tool.length_mm
    lengths[-1] = said.probe_length_mm
    return lengths


def _zero(job: Job, number: int) -> np.ndarray:
    name = WORK_OFFSETS[max(number, 1) - 1]
    return job.work_offsets_mm.get(name, next(iter(job.work_offsets_mm.values())))


def _check_travel(job: Job, nose_mm: np.ndarray) -> None:
    low, high = job.machine.travel_mm
    outside = (nose_mm < low) | (nose_mm > high)
    if outside.any():
        row, axis = np.argwhere(outside)[0]
        raise InputError(
            f"[probing]: to touch, {'XYZ'[axis]} goes to {nose_mm[row, axis]:.3f} mm in machine "
            "coordinates, outside the travel",
            file=job.path,
            accepted=f"{low[axis]:g} .. {high[axis]:g} mm",
            hint="places of touch count from the workpiece zero; check probe_length_mm",
        )
