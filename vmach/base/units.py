"""The one place where units change: mm, rad and s inside, um, urad and mm/min in files.

Each function takes a number or an array and returns the same, scaled. For degrees NumPy has
`np.radians` and `np.degrees`.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    import numpy as np

    #: a number or an array
    Numbers = TypeVar("Numbers", float, np.ndarray)

__all__ = [
    "mm_from_um",
    "mm_per_s_from_mm_per_min",
    "rad_from_urad",
    "um_from_mm",
    "urad_from_rad",
    "with_micro_sign",
]

_PLAIN_MICRO = re.compile(r"(?<![\w./-])u(?=(m|rad)\b(?!\.\w))")


def mm_from_um(length_um: Numbers) -> Numbers:
    """Millimetres from micrometres."""
    return length_um / 1e3


def um_from_mm(length_mm: Numbers) -> Numbers:
    """Micrometres from millimetres."""
    return length_mm * 1e3


def rad_from_urad(angle_urad: Numbers) -> Numbers:
    """Radians from microradians, which are also um/m (squareness, pitch per length)."""
    return angle_urad / 1e6


def urad_from_rad(angle_rad: Numbers) -> Numbers:
    """Microradians (um/m) from radians."""
    return angle_rad * 1e6


def mm_per_s_from_mm_per_min(feed_mm_per_min: Numbers) -> Numbers:
    """Speed in mm/s from a programmed feed in mm/min."""
    return feed_mm_per_min / 60.0


def with_micro_sign(text: str) -> str:
    """A text for a picture or a page: um and urad as µm and µrad, names like `u_um` as they are.

    Terminals, CSV and JSON keep the plain letters.
    """
    return _PLAIN_MICRO.sub("µ", text)
