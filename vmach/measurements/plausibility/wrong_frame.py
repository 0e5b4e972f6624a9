"""How measured points lie to the nominal ones where they do not meet: shifted, turned, mirrored.

Source: W. Kabsch, Acta Cryst. A 32 (1976) 922: the rotation from singular values.
"""

from __future__ import annotations

import numpy as np

__all__ = ["motion_in_words", "wrong_frame"]

#: measured points that lie this near (median, mm) after a motion are those of this part
_NEAR_MM = 0.1
#: a rotation this near to an exchange of axes is one; a smaller turn than this is none, rad
_EXCHANGED, _NO_TURN_RAD = 0.02, 1e-3
_FEWEST = 4


def wrong_frame(nominal_mm: np.ndarray, measured_mm: np.ndarray) -> str | None:
    """What was done to measured points that a motion of the whole would bring to the nominal ones.

    Parameters
    ----------
    nominal_mm, measured_mm : (P, 3) float64
        The same points, row by row.

    Returns
    -------
    str or None
        In words; None where no motion brings them together.
    """
    if len(nominal_mm) < _FEWEST:
        return None
    for mirrored in (False, True):
        rotation = _rotation(nominal_mm, measured_mm, mirrored=mirrored)
        shift = measured_mm.mean(axis=0) - rotation @ nominal_mm.mean(axis=0)
        away = np.linalg.norm(measured_mm - nominal_mm @ rotation.T - shift, axis=1)
        if np.median(away) < _NEAR_MM:
            return motion_in_words(rotation, shift, mirrored=mirrored)
    return None


def _rotation(nominal: np.ndarray, measured: np.ndarray, *, mirrored: bool) -> np.ndarray:
    """The orthogonal matrix that turns nominal into measured points best (Kabsch)."""
    spread = (measured - measured.mean(axis=0)).T @ (nominal - nominal.mean(axis=0))
    left, _, right = np.linalg.svd(spread)
    handed = np.sign(np.linalg.det(left @ right)) * (-1.0 if mirrored else 1.0)
    return left @ np.diag([1.0, 1.0, handed]) @ right


def motion_in_words(rotation: np.ndarray, shift: np.ndarray, *, mirrored: bool = False) -> str:
    """What was done to measured points R p + d, with rotation R (3, 3) and shift d (3,) mm."""
    axes = np.round(rotation)
    turn_rad = np.arccos(np.clip(0.5 * (np.trace(rotation) - 1.0), -1.0, 1.0))
    by = "({})".format(", ".join(f"{value:.3f}" for value in np.round(shift, 3) + 0.0))
    if not np.array_equal(axes, np.eye(3)) and np.abs(rotation - axes).max() < _EXCHANGED:
        what = "a mirrored part, or columns" if mirrored else "columns"
        names = ", ".join(_axis(row) for row in axes)
        return f"mx, my, mz hold {names} and are shifted by {by} mm: {what} in another order?"
    if mirrored:
        return "they are those of the mirrored part"
    if turn_rad < _NO_TURN_RAD:
        return f"all of them are shifted by {by} mm: is the CMM's zero that of the program?"
    return (
        f"they are turned by {np.degrees(turn_rad):.3g} degrees and shifted by {by} mm: "
        "are the CMM's axes those of the program?"
    )


def _axis(row: np.ndarray) -> str:
    """The axis, with its sign, that a row of an exchange takes its values from."""
    k = int(np.argmax(np.abs(row)))
    return ("-" if row[k] < 0 else "") + "xyz"[k]
