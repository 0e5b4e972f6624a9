"""The two forms of the arms side by side over a volume.

Source: the Abbe-consistent model (virtual machining of free-form slots), which compares both
arms.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from vmach.machine import Machine, Variant
from vmach.volumetric.field import ErrorField, Volume, error_field

__all__ = ["Comparison", "compare_variants"]


@dataclass(frozen=True)
class Comparison:
    """Error fields with conventional and with Abbe-consistent arms.

    Attributes
    ----------
    htm, abbe : ErrorField
    mean_htm_mm, mean_abbe_mm : float
        Mean length of the error vectors.
    smaller_percent : float
        How much smaller the mean of the Abbe form is, in percent of the conventional one;
        negative where it is larger. The size depends on the angles, on where the reflectors
        stood and on the origin: it is a figure of one machine and one set-up (24.7 % for that of
        the paper on Abbe-consistent arms), not of the method, and 0 where every reflector stood
        at the origin.
    """

    htm: ErrorField
    abbe: ErrorField
    mean_htm_mm: float
    mean_abbe_mm: float
    smaller_percent: float

    @property
    def in_words(self) -> str:
        """``3.9 % smaller``."""
        way = "larger" if self.smaller_percent < 0 else "smaller"
        return f"{abs(self.smaller_percent):.1f} % {way}"


def compare_variants(
    machine: Machine,
    volume: Volume,
    tool_mm: np.ndarray,
    *,
    known: Mapping[Variant, ErrorField] | None = None,
) -> Comparison:
    """Compute both fields over a volume.

    Parameters
    ----------
    machine : Machine
    volume : Volume
    tool_mm : (3,) float64
        Vector from nose to tip.
    known : mapping of Variant to ErrorField, optional
        Fields of the same machine, volume and tool that are there already.

    Raises
    ------
    InputError
        A measuring point is missing.
    """
    known = known or {}
    htm, abbe = (
        known[variant] if variant in known else error_field(machine, volume, tool_mm, variant)
        for variant in (Variant.HTM, Variant.ABBE)
    )
    means = [float(field.magnitude_mm.mean()) for field in (htm, abbe)]
    percent = 100.0 * (1.0 - means[1] / means[0]) if means[0] else 0.0
    return Comparison(htm, abbe, *means, percent)
