"""Places, approaches and times of a test that hardly belong together: questions to its user.

They are notes and no errors: unusual tests exist.

Source: closed form derived here: lost motion leaves an axis behind its last motion, never ahead.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from vmach.base.note import Kind, Note
from vmach.base.units import mm_per_s_from_mm_per_min, um_from_mm
from vmach.machine.tables.error_table import MM_PER
from vmach.measurements.measurement import Measurement

__all__ = [
    "approach_notes",
    "circle_notes",
    "drift_notes",
    "inch_notes",
    "lost_motion_notes",
    "pace_notes",
]

#: share of the ways that have to contradict, and of these on either side
_NEARLY_ALL, _OF_EITHER = 0.9, 0.25
#: fewer ways than this say nothing
_FEWEST = 8
#: share of the way that is enough to doubt the times
_MUCH = 0.25
#: lost motion the wrong way round, mm and in standard uncertainties; a carriage that yaws when it
#: turns back may bring a little of it
_CLEAR_MM, _CLEAR_U = 5e-3, 5.0
#: places that would fill this share of their room in inches fill a fiftieth of it in mm; chosen:
#: tests go from end to end, and short ones seldom lie where this holds
_FILLS = 0.5
#: no drift test is over sooner
_SHORTEST_DRIFT_S = 300.0
#: planes in which an angle that grows goes counterclockwise, seen against the third axis
_RIGHT_HANDED = ("XY", "YZ", "ZX")
#: names of runs that say their sense, whatever number or feed stands behind it
_SENSE = re.compile(r"(ccw|cw)(?![a-z])", re.IGNORECASE)
_TURN = {"ccw": 1.0, "cw": -1.0}


def approach_notes(nose_mm: np.ndarray, side: np.ndarray) -> tuple[Note, ...]:
    """A note where places are approached against the way to them, whichever way it goes.

    Parameters
    ----------
    nose_mm : (P, 3) float64
        Places in the order of time.
    side : (P, 3) number
        Sign of the last motion of each axis, as the file says; 0 where it does not.
    """
    way, said = np.sign(np.diff(np.round(nose_mm, 6), axis=0)), np.asarray(side)[1:]
    moved = (way != 0) & (said != 0)
    against = moved & (way != said)
    count = int(against.sum())
    if count < max(_FEWEST, _NEARLY_ALL * moved.sum()):
        return ()
    if not _OF_EITHER < np.mean(said[against] > 0) < 1.0 - _OF_EITHER:
        return ()  # always from one side: that may be meant
    text = (
        f"{count} of {int(moved.sum())} approaches contradict the direction from the position "
        "before: are the signs exchanged? They are those of the last motion, 1 towards +"
    )
    return (Note.question(Kind.SIGN, text, count, "1"),)


def lost_motion_notes(test: Measurement, side: np.ndarray) -> tuple[Note, ...]:
    """A note where an axis stops further along its motion than the model says, on either side.

    It compares readings one after the other at the same place, so that no heat comes between.

    Parameters
    ----------
    test : Measurement
        Along one axis; where several move, one may shift another when it reverses.
    side : (P,) number
        Sign of the motion into each place.
    """
    nose_mm, side = np.round(test.states.nose_mm, 6), np.asarray(side)
    turned = np.all(nose_mm[1:] == nose_mm[:-1], axis=1) & (side[1:] * side[:-1] < 0)
    residual = test.measured_mm - test.predicted_mm
    ahead = (np.diff(residual) * np.sign(side[1:]))[turned]
    if len(ahead) == 0:
        return ()
    mean, u_mm = float(ahead.mean()), float(np.median(test.u_mm) * np.sqrt(2.0 / len(ahead)))
    if mean < max(_CLEAR_MM, _CLEAR_U * u_mm):
        return ()
    said = (
        f"approached with 1 the axis stops {um_from_mm(mean):.1f} um further towards + than with "
        "-1, and lost motion does the opposite: are the signs of approach exchanged, or does the "
        "control compensate too much backlash?"
    )
    return (Note.question(Kind.LOST_MOTION, said, float(um_from_mm(mean)), "um"),)


def pace_notes(
    nose_mm: np.ndarray, time_s: np.ndarray, rapid_mm_per_min: float
) -> tuple[Note, ...]:
    """A note where places, (P, 3) mm, are reached sooner than rapid motion would, (P,) s."""
    way = np.abs(np.diff(nose_mm, axis=0)).max(axis=1)
    fast = way > mm_per_s_from_mm_per_min(rapid_mm_per_min) * np.diff(time_s)
    if way[fast].sum() <= _MUCH * way.sum():
        return ()
    said = (
        f"{way.sum():.0f} mm in {np.ptp(time_s):.4g} s, much of it faster than the machine's "
        f"rapid motion of {rapid_mm_per_min:g} mm/min: is t_s in seconds?"
    )
    return (Note.question(Kind.CLOCK, said, float(np.ptp(time_s)), "s", place="t_s"),)


def inch_notes(place_mm: np.ndarray, room_mm: np.ndarray, room: str) -> tuple[Note, ...]:
    """A note where places fill a small spot of their room in mm, and most of it in inches.

    Parameters
    ----------
    place_mm : (P, K) float64
    room_mm : (2, K) float64
        Lowest and highest place along each of K axes.
    room : str
        What they lie in.
    """
    low, high = place_mm.min(axis=0), place_mm.max(axis=0)
    moves = high > low
    meant = MM_PER["inch"] * np.array([low, high])
    fits = (meant[0] >= room_mm[0] - 1.0) & (meant[1] <= room_mm[1] + 1.0)
    share = MM_PER["inch"] * (high - low) / np.maximum(np.ptp(room_mm, axis=0), 1.0)
    if not moves.any() or not fits[moves].all() or share[moves].max() < _FILLS:
        return ()
    k = int(np.argmax(np.where(moves, share, 0.0)))
    said = (
        f"places from {low[k]:.4g} to {high[k]:.4g} mm are a spot of {room}; in inches they would "
        f"go from {meant[0, k]:.4g} to {meant[1, k]:.4g} mm: are they in inches? They have to be "
        "in mm"
    )
    return (Note.question(Kind.UNIT, said, float(high[k] - low[k]), "mm"),)


def drift_notes(time_s: np.ndarray) -> tuple[Note, ...]:
    """A note where a drift test, (P,) s, is over before anything warms."""
    if np.ptp(time_s) >= _SHORTEST_DRIFT_S:
        return ()
    lasts_s = float(np.ptp(time_s))
    said = f"the test lasts {lasts_s:.4g} s: is t_s in seconds?"
    return (Note.question(Kind.CLOCK, said, lasts_s, "s", place="t_s"),)


def circle_notes(runs: Sequence[str], angle_rad: np.ndarray, plane: str) -> tuple[Note, ...]:
    """A note where circles called cw or ccw turn the other way.

    Parameters
    ----------
    runs : (P,) str
        Name of the run of each row; other names say nothing.
    angle_rad : (P,) float64
    plane : str
        Its two axes; angles count from the first to the second.
    """
    if plane not in _RIGHT_HANDED:
        return ()
    names = np.asarray(runs, dtype=str)
    wrong = []
    for name in dict.fromkeys(names.tolist()):
        sense = _SENSE.match(name)
        rows = np.flatnonzero(names == name)
        steps = np.diff(angle_rad[rows])
        steps = (steps + np.pi) % (2.0 * np.pi) - np.pi
        if sense and len(steps) and np.sign(np.median(steps)) == -_TURN[sense[1].lower()]:
            wrong.append(name)
    if not wrong:
        return ()
    said = (
        f"run {', '.join(wrong)} turns the other way in the plane {plane}: does angle_deg "
        f"count from {plane[0]} towards {plane[1]}?"
    )
    return (Note.question(Kind.SIGN, said, len(wrong), "1", place=f"plane {plane}"),)
