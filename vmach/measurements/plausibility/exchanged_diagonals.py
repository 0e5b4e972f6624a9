"""Are two diagonals under each other's names?

A scale makes both longer, a squareness one longer and the other shorter. Read under exchanged
names, the difference of their lengths has the other sign, which contradicts the squareness of the
machine file, or its tables. Readings on their own cannot tell it: four body diagonals are three
squarenesses and a scale, in any order.

Source: ISO 230-6, body and face diagonals; closed forms derived here: a squareness E of two axes
changes the length of a line with the direction cosines n by E n_1 n_2 of itself, with the sign of
`_PLANES`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from vmach.base.note import Kind, Note
from vmach.base.units import um_from_mm, urad_from_rad
from vmach.measurements.measurement import Measurement
from vmach.measurements.plausibility.alternatives import (
    BETTER,
    CLEAR_U,
    CLOSE_U,
    FAR_BETTER,
    FEWEST_LEFT,
)

__all__ = ["DiagonalPair"]

#: squareness of the plane of two axes, and the sign with which it makes a line longer that rises
#: along both: dx = -EC0Y y, dz = -EB0X x, dz = +EA0Y y
_PLANES = {"EC0Y": ((0, 1), -1.0), "EB0X": ((0, 2), -1.0), "EA0Y": ((1, 2), 1.0)}
#: a direction cosine, or a difference of their products, that is none
_NONE = 1e-9


@dataclass(frozen=True)
class DiagonalPair:
    """Two diagonals as they are named, and under each other's names.

    Attributes
    ----------
    named, exchanged : (Measurement, Measurement)
        The same files in the same order.
    """

    named: tuple[Measurement, Measurement]
    exchanged: tuple[Measurement, Measurement]

    @property
    def apart_mm(self) -> tuple[float, float]:
        """Root mean square of measured minus predicted, as named and exchanged.

        Zeros and a scale that both have in common are taken off: material and air may be warm.
        """
        return _apart_mm(self.named), _apart_mm(self.exchanged)

    @property
    def looks_exchanged(self) -> bool:
        """Whether the model explains the readings far better under each other's names."""
        plain, apart = self.apart_mm
        u_mm = float(np.median(np.concatenate([test.u_mm for test in self.named])))
        if sum(test.degrees for test in self.named) < FEWEST_LEFT or plain < CLEAR_U * u_mm:
            return False
        is_close = apart <= CLOSE_U * u_mm or plain >= FAR_BETTER * apart
        return is_close and plain >= BETTER * apart

    def note(self) -> Note:
        """The question, with what the readings say and what the model says."""
        one, other = self.named
        plain, apart = (float(um_from_mm(size)) for size in self.apart_mm)
        measured, model = (
            _longer(one, what) - _longer(other, what) for what in ("measured_mm", "predicted_mm")
        )
        said = (
            f"is {one.name} the diagonal that {other.name} is named, and the other way round? "
            f"{one.name} is longer than {other.name} by {urad_from_rad(measured):.1f} um/m, and by "
            f"{urad_from_rad(model):.1f} um/m with the machine file"
        )
        if found := _squareness(one, other):
            name, share = found
            said += (
                f": {name} is {urad_from_rad(measured / share):.1f} urad by both diagonals, and "
                f"{urad_from_rad(model / share):.1f} urad by the machine file"
            )
        said += (
            f". Exchanged, the readings would agree with it within {apart:.2f} um instead of "
            f"{plain:.2f} um (rms)"
        )
        hint = (
            "look at from_mm and to_mm of both; nothing is changed. If they are right, the "
            "squareness of the machine file has the other sign"
        )
        return Note.question(
            Kind.EXCHANGED, said, plain, "um", hint=hint, place=other.name, file=one.name
        )


def _direction(test: Measurement) -> np.ndarray:
    """Direction cosines, (3,)."""
    return np.asarray(test.sensing[0])


def _distance_mm(test: Measurement) -> np.ndarray:
    """Along the diagonal from the middle of its readings, (P,)."""
    along = test.states.nose_mm @ _direction(test)
    return np.asarray(along - along.mean())


def _apart_mm(tests: tuple[Measurement, Measurement]) -> float:
    one, other = tests
    residual = np.concatenate([test.measured_mm - test.predicted_mm for test in tests])
    free = np.column_stack(
        [
            block_diag(one.nuisance, other.nuisance),
            np.concatenate([_distance_mm(test) for test in tests]),
        ]
    )
    left = residual - free @ np.linalg.lstsq(free, residual, rcond=None)[0]
    degrees = max(len(residual) - int(np.linalg.matrix_rank(free)), 1)
    return float(np.sqrt(left @ left / degrees))


def _longer(test: Measurement, what: str) -> float:
    """By which share of itself a diagonal is longer: the slope of its readings or predictions."""
    free = np.column_stack([test.nuisance, _distance_mm(test)])
    return float(np.linalg.lstsq(free, getattr(test, what), rcond=None)[0][-1])


def _squareness(one: Measurement, other: Measurement) -> tuple[str, float] | None:
    """The one squareness that two face diagonals of a plane tell apart.

    Returns
    -------
    name, share : str, float
        By `share` times the squareness the first is longer than the other; None for other pairs.
    """
    ways = np.array([_direction(one), _direction(other)])
    if np.abs(ways[0] ** 2 - ways[1] ** 2).max() > 1e-3:
        return None  # a scale of one axis tells them apart, too
    shares = {
        name: sign * float(np.subtract(*(ways[:, axes[0]] * ways[:, axes[1]])))
        for name, (axes, sign) in _PLANES.items()
    }
    seen = {name: share for name, share in shares.items() if abs(share) > _NONE}
    return next(iter(seen.items())) if len(seen) == 1 else None
