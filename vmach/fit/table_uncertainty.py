"""What the error tables do not know: noise of their readings and the curve between them.

Both are carried as independent unit-variance causes, each with its signature on the readings:
the covariance of the prediction is ``F F^T`` for the matrix F of signatures.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.effects import Circumstances
from vmach.machine import COMPONENT_NAMES, Machine
from vmach.machine.component_errors import component_of

__all__ = ["TableUncertainty"]

#: where a table shows no difference between both directions, its noise is taken as this
_DEFAULT_MM, _DEFAULT_RAD = 0.2e-3, 0.3e-6
_SQUARENESS_RAD = 1e-6
#: C0Y, B0X, A0Y as (axis, rotation); the other three turn the frame, which nobody measures
_SQUARENESSES = ((1, 2), (0, 1), (1, 0))


@dataclass(frozen=True)
class TableUncertainty:
    """Standard uncertainties of a machine's tables.

    Attributes
    ----------
    reading_mm, reading_rad : float
        Of the mean of both directions at a table's position; from the scatter of their
        difference over all tables of the machine.
    bend : mapping of component to float
        RMS error of straight lines between the table's points, mm or rad, at mid-interval: an
        eighth of the second differences, what the readings' noise makes of them taken off.
    squareness_rad : float
    """

    reading_mm: float
    reading_rad: float
    bend: dict[str, float]
    squareness_rad: float = _SQUARENESS_RAD

    @classmethod
    def of(cls, machine: Machine) -> TableUncertainty:
        """Estimate the uncertainties from the tables themselves."""
        reading = []
        for angular, default in ((False, _DEFAULT_MM), (True, _DEFAULT_RAD)):
            apart = [
                (table.forward - table.backward) - np.mean(table.forward - table.backward)
                for name, table in machine.components.items()
                if component_of(name)[2] == angular
            ]
            scatter = np.sqrt(np.mean(np.concatenate(apart) ** 2)) if apart else 0.0
            reading.append(0.5 * float(scatter) or default)
        bend = {}
        for name, table in machine.components.items():
            noise = reading[int(component_of(name)[2])]
            bend[name] = _bend(table.position_mm, table.mean, noise)
        return cls(reading[0], reading[1], bend)

    def factors(
        self, path: Circumstances, sensing: np.ndarray, *, bend_share: float = 1.0
    ) -> np.ndarray:
        """Signature of every unit cause on readings along `sensing` (P, 3), (P, Q) mm."""
        machine = path.job.machine
        parts = []
        for name in COMPONENT_NAMES:
            table = machine.components.get(name)
            if table is None:
                continue
            _, axis, angular = component_of(name)
            lever = path.lever(name).at(path.contact_mm)
            lever = np.einsum("ij,ij->i", sensing, lever)[:, None]
            position, knots = path.nose_mm[:, axis], table.position_mm
            hats = np.stack([np.interp(position, knots, e) for e in np.eye(len(knots))], axis=1)
            parts.append((self.reading_rad if angular else self.reading_mm) * lever * hats)
            if bend_share > 0.0:
                parts.append(bend_share * self.bend[name] * lever * _bumps(position, knots))
        for axis, rotation in _SQUARENESSES:
            across = np.cross(np.eye(3)[rotation], np.eye(3)[axis])
            turned = path.nose_mm[:, axis] * (sensing @ across)
            parts.append(self.squareness_rad * turned[:, None])
        return np.hstack(parts)


def _bend(position: np.ndarray, value: np.ndarray, noise: float) -> float:
    if len(value) < 3:
        return 0.0
    second = np.diff(value, 2)
    excess = max(float(np.mean(second**2)) - 6.0 * noise**2, 0.0)
    return np.sqrt(excess) / 8.0


def _bumps(position: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """A parabola of height one over every interval of the table, (P, K - 1)."""
    share = (position[:, None] - knots[:-1]) / np.diff(knots)
    inside = (share > 0.0) & (share < 1.0)
    return np.where(inside, 4.0 * share * (1.0 - share), 0.0)
