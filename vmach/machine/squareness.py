"""Squareness: how a machine file states it, and what it means.

``EC0Y`` is the rotation C of the reference line of Y, right-handed: Y leans towards -X where it
is positive.

Source: ISO 230-1, squareness error of two linear axes.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vmach.errors import InputError
from vmach.machine.chain import LINEAR_AXES
from vmach.machine.tables.error_table import RAD_PER

__all__ = ["agreed_value", "lean_direction", "squareness_name", "squareness_vectors"]

#: reports round: two statements of one angle may differ by this share, or by half a unit
_ROUNDING_SHARE = 0.01
_ROUNDING = {"um_per_m": 0.05, "arcsec": 0.5}
_RAD = {"um_per_m": RAD_PER["um/m"], "arcsec": RAD_PER["arcsec"]}


def squareness_name(axis: int, rotation: int) -> str:
    """``EC0Y`` for axis 1 and rotation 2: the line of Y turned about C."""
    return f"E{'ABC'[rotation]}0{LINEAR_AXES[axis]}"


def lean_direction(axis: int, rotation: int) -> np.ndarray:
    """Unit vector (3,) towards which a positive squareness leans the axis: e_rotation x e_axis."""
    return np.cross(np.eye(3)[rotation], np.eye(3)[axis])


def squareness_vectors(squareness_rad: Mapping[str, float]) -> np.ndarray:
    """Rotation vector of every axis' reference line, (3, 3) rad, from ``EC0Y`` and the like."""
    sigma = np.zeros((3, 3))
    for name, value in squareness_rad.items():
        sigma["XYZ".index(name[3]), "ABC".index(name[1])] = value
    return sigma


def agreed_value(um_per_m: float | None, arcsec: float | None, use: str | None) -> float:
    """The angle that a statement in two units means, rad.

    Parameters
    ----------
    um_per_m, arcsec : float or None
        The same angle in both units, as printed in a report.
    use : {"um_per_m", "arcsec"} or None
        Which one to trust where they contradict each other.

    Raises
    ------
    InputError
        They contradict each other and `use` does not choose; the hint says so where the two
        numbers fit with their units swapped.
    """
    given = {
        unit: value
        for unit, value in (("um_per_m", um_per_m), ("arcsec", arcsec))
        if value is not None
    }
    if not given or (use is not None and use not in given):
        what = "no value" if use is None else f'no value for use = "{use}"'
        raise InputError(what, accepted="um_per_m, arcsec or both")
    chosen = use or next(iter(given))
    if use is None and len(given) == 2 and not _agree(um_per_m, arcsec):
        also = um_per_m * _RAD["um_per_m"] / _RAD["arcsec"]
        hint = 'use = "um_per_m" or use = "arcsec" says which one holds'
        if _agree(arcsec, um_per_m):
            hint = (
                f"swapped, {um_per_m:g} arcsec and {arcsec:g} um/m are the same angle, so the "
                f"two numbers are probably exchanged; {hint}"
            )
        raise InputError(
            f"{um_per_m:g} um/m is {also:.4g} arcsec, but {arcsec:g} arcsec is stated", hint=hint
        )
    return given[chosen] * _RAD[chosen]


def _agree(um_per_m: float, arcsec: float) -> bool:
    """Whether both numbers can be roundings of the same angle."""
    difference = abs(um_per_m * _RAD["um_per_m"] - arcsec * _RAD["arcsec"])
    rounding = max(_ROUNDING[unit] * _RAD[unit] for unit in _ROUNDING)
    return difference <= max(rounding, _ROUNDING_SHARE * abs(um_per_m) * _RAD["um_per_m"])
