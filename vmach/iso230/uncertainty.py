"""Uncertainty of ISO 230-2 figures of a length, measured with a laser interferometer.

The equations of a master's thesis at KTH (a Mazak AJV 25/405; its equations 33 to 43 are missing
from the text) rebuilt after ISO/TR 230-9, so that its Tables 8 and 9 come out. Each contributor is
taken as uncorrelated and rectangular. What its Table 7 does not confirm is said in the
documentation (machine-model, "Where printed numbers do not follow").

Source: ISO/TR 230-9; KTH thesis, Tables 8 and 9.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from vmach.errors import InputError

__all__ = ["Budget", "expanded", "parameter_uncertainties", "root_sum"]


def root_sum(*contributors: float) -> float:
    """Combined standard uncertainty of uncorrelated contributors."""
    return math.sqrt(sum(u * u for u in contributors))


def expanded(u: float) -> float:
    """Expanded uncertainty for a coverage factor of 2."""
    return 2.0 * u


@dataclass(frozen=True)
class Budget:
    """What makes a laser measurement of a length uncertain; standard uncertainties in mm.

    The defaults are those of the thesis' Table 8: state your own where you know them.

    Attributes
    ----------
    wavelength_mm, air_mm, dead_path_mm, resolution_mm : float
        Laser wavelength, refractive index of air, dead path, resolution (u_lambda, u_M,n, u_DP,
        u_DR).
    misalignment_rad : float
        Largest angle between beam and axis.
    abbe_offset_mm, angle_rad : float
        Offset between two possible lines of measurement and largest pitch and yaw of the axis.
    eve_mm : float
        Largest drift during the measurement (environmental variation error).
    """

    wavelength_mm: float = 0.06e-3
    air_mm: float = 0.9e-3
    dead_path_mm: float = 0.0
    resolution_mm: float = 0.002e-3
    misalignment_rad: float = 5e-3
    abbe_offset_mm: float = 25.0
    angle_rad: float = 60e-6
    eve_mm: float = 1.5e-3

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value >= 0):
                raise InputError(f"budget: {name} = {value}", accepted="a number, 0 or more")

    @property
    def device_mm(self) -> float:
        """u_DEVICE: everything inside the interferometer."""
        return root_sum(self.wavelength_mm, self.air_mm, self.dead_path_mm, self.resolution_mm)

    def misalignment_mm(self, length_mm: float) -> float:
        """u_MISALIGNMENT: cosine error, anywhere between 0 and ``gamma^2 / 2`` of the length."""
        return 0.5 * self.misalignment_rad**2 * length_mm / math.sqrt(12.0)

    @property
    def setup_mm(self) -> float:
        """u_SETUP: Abbe error of pitch and of yaw, each up to offset times angle."""
        return math.sqrt(2.0) * self.abbe_offset_mm * self.angle_rad / math.sqrt(3.0)

    @property
    def eve_u_mm(self) -> float:
        """u_EVE: drift anywhere within its bounds."""
        return self.eve_mm / math.sqrt(3.0)


def parameter_uncertainties(budget: Budget, length_mm: float, runs: int) -> dict[str, float]:
    """Standard uncertainty of each figure of ISO 230-2, mm.

    Parameters
    ----------
    budget : Budget
    length_mm : float
        Measured length of the axis.
    runs : int
        Readings of a target in each direction, n.

    Returns
    -------
    dict
        ``R_i`` (unidirectional repeatability), ``B``, ``R``, ``M``, ``E``, ``A``.

    Notes
    -----
    A unidirectional repeatability is a difference of readings: only drift enters, twice. A
    reversal is a difference of two means of n readings. M and E hold every contributor, drift
    averaged over the runs. ``u(R)^2 = u(B)^2 + u(R_i)^2`` and ``u(A)^2 = u(E)^2 + u(R_i)^2``
    (thesis, eq. 36 and 39).
    """
    u_r_i = math.sqrt(2.0) * budget.eve_u_mm
    u_b = budget.eve_u_mm * math.sqrt(2.0 / runs)
    u_e = root_sum(
        budget.device_mm, budget.misalignment_mm(length_mm), budget.setup_mm,
        budget.eve_u_mm * math.sqrt(2.0 / runs),
    )  # fmt: skip
    return {
        "R_i": u_r_i,
        "B": u_b,
        "R": root_sum(u_b, u_r_i),
        "M": u_e,
        "E": u_e,
        "A": root_sum(u_e, u_r_i),
    }
