"""What the error tables do not know: noise of their readings and the curve between them.

Both are carried as independent unit-variance causes, each with its signature on the readings:
the covariance of the prediction is ``F F^T`` for the matrix F of signatures.

Source: JCGM 100:2008 (GUM), 4.2 (type A) for the noise; C. de Boor, A Practical Guide to Splines
(1978): linear interpolation errs by h^2 f'' / 8 in the middle.
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
    bend : mapping of component to (K - 1,) float64
        Distance of the curve from the straight line in the middle of every interval, mm or rad,
        by the curvature of the table.
    bend_apart : mapping of component to float
        RMS of the differences of it between neighbouring points: its uncertainty.
    squareness_rad : float
    """

    reading_mm: float
    reading_rad: float
    bend: dict[str, np.ndarray]
    bend_apart: dict[str, float]
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
        bends = {n: _bends(t.position_mm, t.mean) for n, t in machine.components.items()}
        height = {name: both.mean(axis=0) for name, both in bends.items()}
        apart = {n: _root_mean_square(0.5 * np.diff(b, axis=0)) for n, b in bends.items()}
        return cls(reading[0], reading[1], height, apart)

    def factors(self, path: Circumstances, sensing: np.ndarray) -> np.ndarray:
        """Signature of every unit cause on readings along `sensing` (P, 3), (P, Q) mm."""
        machine = path.job.machine
        parts = []
        for name in COMPONENT_NAMES:
            table = machine.components.get(name)
            if table is None:
                continue
            _, axis, angular = component_of(name)
            lever = path.states.seen_mm(path.lever(name))
            lever = np.einsum("ij,ij->i", sensing, lever)[:, None]
            position, knots = path.nose_mm[:, axis], table.position_mm
            hats = np.stack([np.interp(position, knots, e) for e in np.eye(len(knots))], axis=1)
            parts.append((self.reading_rad if angular else self.reading_mm) * lever * hats)
            # one cause for all: where the curve bends one way, it does so over intervals
            bumps = lever * _bumps(position, knots)
            parts.append(bumps @ self.bend[name][:, None])
            parts.append(self.bend_apart[name] * bumps)
        for axis, rotation in _SQUARENESSES:
            across = np.cross(np.eye(3)[rotation], np.eye(3)[axis])
            lean = path.states.seen_mm(np.multiply.outer(path.nose_mm[:, axis], across))
            turned = np.einsum("ij,ij->i", sensing, lean)
            parts.append(self.squareness_rad * turned[:, None])
        return np.hstack(parts)


def _bends(position: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Height above the chord in the middle of every interval by either end's curvature, (2, K - 1).

    At the ends of the table the curvature of the next point holds.
    """
    step = np.diff(position)
    if len(step) < 2:
        return np.zeros((2, len(step)))
    curvature = 2.0 * np.diff(np.diff(value) / step) / (step[:-1] + step[1:])
    first, last = np.append(curvature[:1], curvature), np.append(curvature, curvature[-1:])
    return -np.stack([first, last]) * step**2 / 8.0


def _root_mean_square(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _bumps(position: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """A parabola of height one over every interval of the table, (P, K - 1)."""
    share = (position[:, None] - knots[:-1]) / np.diff(knots)
    inside = (share > 0.0) & (share < 1.0)
    return np.where(inside, 4.0 * share * (1.0 - share), 0.0)
