"""What a machine file states of the uncertainty with which the machine was measured.

Source: JCGM 100:2008, 4.3 (type B evaluation).
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["MeasuringUncertainty"]


@dataclass(frozen=True)
class MeasuringUncertainty:
    """Standard uncertainties of the measurement of a machine, as ``[uncertainty]`` states them.

    Attributes
    ----------
    reading_mm, reading_rad : float or None
        Of one value of a table, the mean of both directions. Where None, the scatter of the
        tables tells it.
    squareness_rad : float or None
        Of each squareness; where None, what is usual.
    positioning_share : float
        Of the length scale of all positioning tables alike, without unit: wavelength of the
        laser, temperature and expansion of the machine. It makes them correlated.
    measured_at_mm : float
        Of each coordinate of a measuring point.
    """

    reading_mm: float | None = None
    reading_rad: float | None = None
    squareness_rad: float | None = None
    positioning_share: float = 0.0
    measured_at_mm: float = 0.0
