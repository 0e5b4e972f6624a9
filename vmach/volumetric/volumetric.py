"""Volumetric accuracy: the largest difference between the errors at any two points.

After "Defining and computing machine tool accuracy" (University of Huddersfield), sections 4.1 and
4.2: not the largest error against one datum, but the worst that can lie between two features.

Source: Huddersfield paper, sections 4.1 and 4.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.machine import Machine, Variant, contributions
from vmach.volumetric.farthest_pair import farthest_pair
from vmach.volumetric.field import ErrorField

__all__ = ["Contribution", "VolumetricAccuracy", "assess", "contributions_between"]


@dataclass(frozen=True)
class VolumetricAccuracy:
    """Figures of an error field, mm.

    Attributes
    ----------
    largest_difference_mm : float
        Volumetric accuracy: longest difference of two error vectors.
    worst_nose_mm : (2, 3) float64
        Where these two are.
    worst_error_mm : (2, 3) float64
    largest_mm, mean_mm, rms_mm, p95_mm : float
        Of the lengths of the error vectors.
    range_mm : (3,) float64
        Largest minus smallest error in X, Y and Z.
    points, pairs : int
    """

    largest_difference_mm: float
    worst_nose_mm: np.ndarray
    worst_error_mm: np.ndarray
    largest_mm: float
    mean_mm: float
    rms_mm: float
    p95_mm: float
    range_mm: np.ndarray
    points: int
    pairs: int


@dataclass(frozen=True)
class Contribution:
    """Share of one component error in the difference between two points.

    Attributes
    ----------
    name : str
        ISO 230-1 symbol.
    difference_mm : (3,) float64
        Its part of the second error vector minus its part of the first.
    share : float
        Along the whole difference, as a fraction of it; all shares add up to 1, single ones may
        be negative.
    """

    name: str
    difference_mm: np.ndarray
    share: float


def assess(field: ErrorField) -> VolumetricAccuracy:
    """Volumetric accuracy of an error field, without approximation."""
    first, second, difference = farthest_pair(field.error_mm)
    magnitude = field.magnitude_mm
    count = len(magnitude)
    pair = np.array([first, second])
    return VolumetricAccuracy(
        largest_difference_mm=difference,
        worst_nose_mm=field.nose_mm(pair),
        worst_error_mm=field.error_mm[pair],
        largest_mm=float(magnitude.max()),
        mean_mm=float(magnitude.mean()),
        rms_mm=float(np.sqrt(np.mean(magnitude**2))),
        p95_mm=float(np.percentile(magnitude, 95.0)),
        range_mm=np.array([np.ptp(column) for column in field.error_mm.T]),
        points=count,
        pairs=count * (count - 1) // 2,
    )


def contributions_between(
    machine: Machine, nose_mm: np.ndarray, tool_mm: np.ndarray, variant: Variant
) -> tuple[Contribution, ...]:
    """What every component error adds to the difference between two points, largest first.

    Parameters
    ----------
    machine : Machine
    nose_mm : (2, 3) float64
    tool_mm : (3,) float64
    variant : Variant
    """
    parts = {
        name: part.shift_mm[1] - part.shift_mm[0]
        for name, part in contributions(machine, nose_mm, tool_mm, variant)
    }
    whole = sum(parts.values(), np.zeros(3))
    square = float(whole @ whole)
    found = [
        Contribution(name, part, float(part @ whole) / square if square else 0.0)
        for name, part in parts.items()
    ]
    return tuple(sorted(found, key=lambda one: -abs(one.share)))
