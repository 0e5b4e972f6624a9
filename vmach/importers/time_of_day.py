"""Times as a logger's clock shows them, with or without a date: 08:59:30, 2026-03-01 08:59:30.5.

Source: ISO 8601 for the time of day, 24 hours and 60 minutes each; its date is not looked at.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

__all__ = ["CLOCK", "COUNTED_FROM_THE_FIRST", "is_time_of_day", "seconds_of_day"]

#: unit of a column that holds times of day
CLOCK = "time of day"
#: what is said of such a column
COUNTED_FROM_THE_FIRST = "; times of day count from the first, taken as the cold start"
_TIME = re.compile(
    r"(?:\S+[T ]\s*)?(\d{1,2}):([0-5]\d):([0-5]\d(?:[.,]\d+)?)\s*(AM|PM|Z)?", re.IGNORECASE
)
_DAY_S = 86_400.0


def is_time_of_day(cell: str) -> bool:
    """Whether a cell is hours, minutes and seconds, whatever date stands before them."""
    return _TIME.fullmatch(cell.strip()) is not None


def seconds_of_day(cells: Sequence[str]) -> np.ndarray:
    """Seconds since the first of some times of day, (P,).

    A clock that goes back by more than half a day has passed midnight.
    """
    seconds = np.array([_seconds(cell) for cell in cells])
    days = np.cumsum(np.diff(seconds, prepend=seconds[:1]) < -0.5 * _DAY_S)
    return seconds + _DAY_S * days - seconds[0]


def _seconds(cell: str) -> float:
    found = _TIME.fullmatch(cell.strip())
    assert found is not None
    hours, half = int(found[1]), (found[4] or "").upper()
    if half in ("AM", "PM"):
        hours = hours % 12 + (12 if half == "PM" else 0)
    return 3600.0 * hours + 60.0 * int(found[2]) + float(found[3].replace(",", "."))
