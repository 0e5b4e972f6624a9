"""Can the machine have been where a test says that it was, and as fast?

Source: closed form derived here: feed = arc over time.
"""

from __future__ import annotations

import numpy as np

from vmach.errors import InputError
from vmach.machine import LINEAR_AXES
from vmach.measurements.columns import Columns

__all__ = ["check_extent", "check_feed", "check_times", "check_travel"]

#: a test that is to see an axis moves it further than this
_LEAST_MM = 2.0
#: rounding of places in files
_ROUNDING_MM = 1e-3
#: times that the feed of a file may differ from that of its angles and times
_OTHER_FEED = 5.0


def check_travel(nose_mm: np.ndarray, table: Columns, travel_mm: np.ndarray) -> None:
    """Refuse a place outside the travel.

    Parameters
    ----------
    nose_mm : (P, 3) float64
        Of the spindle nose at each row of the file.
    table : Columns
    travel_mm : (2, 3) float64
        Lowest and highest position of X, Y, Z.

    Raises
    ------
    InputError
        With the first place outside.
    """
    low, high = travel_mm
    outside = (nose_mm < low - _ROUNDING_MM) | (nose_mm > high + _ROUNDING_MM)
    if not outside.any():
        return
    row, axis = np.argwhere(outside)[0]
    raise InputError(
        f"{LINEAR_AXES[axis]} of the spindle nose is {nose_mm[row, axis]:.6g} mm, "
        "outside the travel",
        file=table.path,
        line=int(table.lines[row]),
        accepted=f"{low[axis]:g} .. {high[axis]:g} mm",
        hint="places of a test, here and in the job, are machine coordinates of the nose, in mm",
    )


def check_times(table: Columns) -> None:
    """Refuse times before the cold start, or rows that are not in the order of time.

    Raises
    ------
    InputError
        With the first row at fault.
    """
    time = table.numbers["t_s"]
    before = np.concatenate([[0.0], time[:-1]])
    wrong = time < before
    if wrong.any():
        row = int(np.argmax(wrong))
        raise InputError(
            f"t_s is {time[row]:g} after {before[row]:g}",
            file=table.path,
            line=int(table.lines[row]),
            accepted="seconds since the cold start of this test, rows in the order of time",
        )


def check_extent(nose_mm: np.ndarray, table: Columns) -> None:
    """Refuse a test whose places, (P, 3), all but coincide.

    Raises
    ------
    InputError
    """
    extent = float(np.ptp(nose_mm, axis=0).max())
    if len(nose_mm) > 1 and extent < _LEAST_MM:
        raise InputError(
            f"all places of this test lie within {extent:.3g} mm",
            file=table.path,
            accepted=f"an axis that moves by {_LEAST_MM:g} mm or more",
            hint="are the places in metres? They have to be in mm",
        )


def check_feed(table: Columns, group: np.ndarray, radius_mm: float) -> None:
    """Refuse circles that turn at another feed than their file says.

    Parameters
    ----------
    table : Columns
        With ``feed_mm_min``, ``angle_deg`` and ``t_s``.
    group : (P,) str
        The run of each row.
    radius_mm : float

    Raises
    ------
    InputError
        Of the first run that does.
    """
    angle, time = np.radians(table.numbers["angle_deg"]), table.numbers["t_s"]
    for run in dict.fromkeys(group):
        rows = np.flatnonzero(group == run)
        turned = np.ptp(np.unwrap(angle[rows]))
        feed = float(np.median(table.numbers["feed_mm_min"][rows]))
        seen = 60.0 * radius_mm * turned / np.ptp(time[rows])
        if not feed / _OTHER_FEED < seen < feed * _OTHER_FEED:
            raise InputError(
                f"run '{run}' turns by {np.degrees(turned):.4g} degrees in "
                f"{np.ptp(time[rows]):.4g} s: {seen:.0f} mm/min at radius_mm = {radius_mm:g}",
                file=table.path,
                line=int(table.lines[rows[0]]),
                accepted=f"about feed_mm_min, {feed:g} mm/min",
                hint="are angles in degrees, times in seconds, the radius in mm?",
            )
