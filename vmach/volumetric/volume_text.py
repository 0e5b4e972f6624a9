"""A volume of the machine's travel as users write it."""

from __future__ import annotations

import math

import numpy as np

from vmach.errors import InputError
from vmach.machine import Machine
from vmach.volumetric.field import Volume, measured_volume

__all__ = ["volume_of"]

#: beyond that a slip: a grid of 171 points a side
_MOST_POINTS = 5_000_000


def volume_of(machine: Machine, text: str | None, grid: str) -> Volume:
    """The volume and its grid as the options ``--volume`` and ``--grid`` say.

    Raises
    ------
    InputError
        If they cannot be read, or the volume is not within the travel.
    """
    counts = _counts(grid)
    if text is None:
        return measured_volume(machine, counts)
    try:
        ends = np.array([float(part) for part in text.split(",")]).reshape(3, 2)
    except ValueError:
        raise InputError(
            f"--volume {text}", accepted="six numbers: xmin,xmax,ymin,ymax,zmin,zmax"
        ) from None
    low, high = machine.travel_mm
    if not (np.isfinite(ends).all() and (ends[:, 0] >= low).all() and (ends[:, 1] <= high).all()):
        raise InputError(
            f"--volume {text} is not within the travel",
            accepted=", ".join(f"{a:g} .. {b:g}" for a, b in zip(low, high, strict=True)),
        )
    return Volume(ends[:, 0], ends[:, 1], counts)


def _counts(text: str) -> tuple[int, int, int]:
    parts = text.split(",")
    parts = parts * 3 if len(parts) == 1 else parts
    if len(parts) != 3 or not all(part.strip().isdigit() and int(part) > 1 for part in parts):
        raise InputError(f"--grid {text}", accepted="a number of points, or three: 21,11,11")
    counts = tuple(int(part) for part in parts)
    if math.prod(counts) > _MOST_POINTS:
        raise InputError(
            f"--grid {text} has {math.prod(counts)} points", accepted=f"{_MOST_POINTS} at most"
        )
    return counts
