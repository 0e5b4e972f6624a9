"""The motion of a ballbar test, given by its readings: circles with run-ups that nobody wrote down.

Every circle of a ballbar begins and ends with a stretch without readings, so that the machine is
at feed when they start. How long it was, the time between the runs tells: the axes hardly rest.

Source: closed form derived here: a run-up and a run-out share the pause between two circles.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from vmach.errors import InputError
from vmach.measurements.columns import Columns
from vmach.path.instrument_motion import MotionRecord
from vmach.path.toolpath import PathStates

__all__ = ["Circle", "circles", "turned_rad"]

#: the shortest run-up: it settles the direction of the axes; and the longest
_LEAST_RAD, _MOST_RAD = np.radians(10.0), np.pi
#: share of the time between two runs that run-out and run-up take together
_SHARE_OF_PAUSE = 0.8
#: time before the first reading in which the first run-up is gone, however slow the feed
_BEFORE_S = 60.0
#: a run that goes back by more than this is two; chosen: beyond what angles are rounded to
_BACK_RAD = np.radians(5.0)
#: steps that tell how fast a run turns, whichever way round; between longer ones rows are missing
_SHORT_RAD = 0.5 * np.pi
#: shortest time between two rows that turn
_QUICKEST_S = 1e-6


@dataclass(frozen=True)
class Circle:
    """Where the circles lie.

    Attributes
    ----------
    centre_mm : (3,) float64
        Of the spindle nose.
    across, upward : (3,) float64
        Unit vectors at 0 and 90 degrees.
    radius_mm, tool_length_mm : float
    """

    centre_mm: np.ndarray
    across: np.ndarray
    upward: np.ndarray
    radius_mm: float
    tool_length_mm: float

    def outward(self, angle_rad: np.ndarray | float) -> np.ndarray:
        """Unit vectors from the centre, (..., 3)."""
        cosine, sine = np.cos(angle_rad), np.sin(angle_rad)
        return np.multiply.outer(cosine, self.across) + np.multiply.outer(sine, self.upward)

    def at(self, angle_rad: float) -> np.ndarray:
        """Place on the circle, (3,)."""
        return self.centre_mm + self.radius_mm * self.outward(angle_rad)


def circles(
    circle: Circle, angle_rad: np.ndarray, table: Columns, *, group: np.ndarray
) -> PathStates:
    """States at the readings of a test, run after run.

    Parameters
    ----------
    circle : Circle
    angle_rad : (P,) float64
    table : Columns
        The file, with ``t_s`` and ``run``.
    group : (P,) str
        The run of each reading; the rows of one run follow each other.

    Raises
    ------
    InputError
        A run that does not turn, or that turns back.
    """
    time_s = table.numbers["t_s"]
    record = MotionRecord(
        circle.centre_mm,
        tool_length_mm=circle.tool_length_mm,
        start_s=float(time_s[0]) - _BEFORE_S,
    )
    starts = np.flatnonzero(np.concatenate([[True], group[1:] != group[:-1]]))
    runs = [slice(*ends) for ends in zip(starts, [*starts[1:], len(group)], strict=True)]
    turned = [
        turned_rad(angle_rad[run], table.take(np.arange(run.start, run.stop))) for run in runs
    ]
    speed = [np.ptp(a) / np.ptp(time_s[run]) for a, run in zip(turned, runs, strict=True)]
    between = [
        _unseen_rad(time_s[after.start] - time_s[before.stop - 1], speed[k], speed[k + 1])
        for k, (before, after) in enumerate(itertools.pairwise(runs))
    ]
    move, parameter = np.empty(len(group), dtype=np.int64), np.empty(len(group))
    up = [between[0] if between else _LEAST_RAD, *between]
    for k, (run, angle) in enumerate(zip(runs, turned, strict=True)):
        time, way = time_s[run], np.sign(angle[-1] - angle[0])
        out = between[k] if k < len(between) else 0.0
        record.line(circle.at(angle[0] - way * up[k]), until_s=time[0] - up[k] / speed[k])
        move[run] = record.arc(
            circle.at(angle[-1] + way * out),
            centre_mm=circle.centre_mm,
            axis=np.cross(circle.across, circle.upward),
            sweep_rad=way * (up[k] + np.ptp(angle) + out),
            until_s=time[-1] + out / speed[k],
        )
        parameter[run] = (np.abs(angle - angle[0]) + up[k]) / (up[k] + np.ptp(angle) + out)
    return record.states(move, parameter)


def turned_rad(angle_rad: np.ndarray, table: Columns) -> np.ndarray:
    """Angle of one run without jumps of a whole turn: where rows are missing, the time tells.

    Parameters
    ----------
    angle_rad : (P,) float64
    table : Columns
        The rows of the run.

    Raises
    ------
    InputError
        A run that does not turn, or that turns back.
    """
    step, pause = np.diff(angle_rad), np.diff(table.numbers["t_s"])
    run = table.text["run"][0]
    if len(angle_rad) < 2 or not pause.any():
        raise _refused(f"no time passes in run '{run}'", table, 0)
    short = np.abs(_within_half_a_turn(step)) < _SHORT_RAD
    rate = _within_half_a_turn(step[short]).sum() / max(pause[short].sum(), _QUICKEST_S)
    expected = rate * pause
    turned = angle_rad[0] + np.cumsum([0.0, *(expected + _within_half_a_turn(step - expected))])
    away = np.abs(turned - turned[0]) > _BACK_RAD
    way = np.sign(turned[np.argmax(away) if away.any() else -1] - turned[0])
    if way == 0.0:
        raise _refused(f"run '{run}' does not turn", table, 0)
    back = np.maximum.accumulate(way * turned) - way * turned
    if back.max() > _BACK_RAD:
        begun = int(np.argmax(way * turned[: int(np.argmax(back > _BACK_RAD))]))
        raise _refused(f"run '{run}' turns back", table, begun + 1)
    return turned


def _within_half_a_turn(angle_rad: np.ndarray) -> np.ndarray:
    return (angle_rad + np.pi) % (2.0 * np.pi) - np.pi


def _refused(what: str, table: Columns, row: int) -> InputError:
    return InputError(
        what,
        file=table.path,
        line=int(table.lines[row]),
        accepted="rows of one run one after the other, in the order of time, all in one sense",
        hint="circles in the other sense, or at another feed, are runs with names of their own",
    )


def _unseen_rad(pause_s: float, speed: float, next_speed: float) -> float:
    """The run-out of one run, and alike the run-up of the next; speeds in rad/s."""
    angle = _SHARE_OF_PAUSE * pause_s / (1.0 / speed + 1.0 / next_speed)
    return float(np.clip(angle, _LEAST_RAD, _MOST_RAD))
