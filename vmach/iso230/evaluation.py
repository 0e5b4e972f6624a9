"""Accuracy, repeatability and reversal of ISO 230-2:2014 from single runs.

Arrow up in the standard is `forward` here, arrow down `backward`. Every figure is in the unit of
the runs, mm for positioning and straightness or rad for angles; the formulas are the same.

Source: ISO 230-2:2014, terms and formulas of the positioning figures.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from vmach.errors import InputError
from vmach.machine.tables.runs import Runs

__all__ = ["Evaluation", "evaluate"]


@dataclass(frozen=True)
class Evaluation:
    """Figures of ISO 230-2:2014, clause 3, for one set of runs.

    Attributes
    ----------
    runs : Runs
    mean_forward, mean_backward : (K,) float64
        Mean unidirectional positional deviation at every target (3.10).
    s_forward, s_backward : (K,) float64 or None
        Estimator of the standard uncertainty at every target (3.14), from n - 1; None where a
        target was approached only once.
    reversal : (K,) float64
        B_i, forward minus backward (3.12).
    A, A_forward, A_backward : float or None
        Accuracy of positioning, bidirectional and unidirectional (3.24, 3.25).
    R, R_forward, R_backward : float or None
        Repeatability of positioning (3.16, 3.17).
    E, E_forward, E_backward : float
        Systematic positional deviation (3.18, 3.19).
    M : float
        Mean bidirectional positional deviation, its range along the axis (3.21).
    B, B_mean : float
        Largest reversal in magnitude (3.13) and mean reversal (with its sign).
    """

    runs: Runs
    mean_forward: np.ndarray
    mean_backward: np.ndarray
    s_forward: np.ndarray | None
    s_backward: np.ndarray | None
    reversal: np.ndarray
    A: float | None
    A_forward: float | None
    A_backward: float | None
    R: float | None
    R_forward: float | None
    R_backward: float | None
    E: float
    E_forward: float
    E_backward: float
    M: float
    B: float
    B_mean: float

    def ends(self) -> dict[str, tuple[float, float]]:
        """Lowest and highest end of the ranges E, and A where there are runs enough."""
        means = np.concatenate((self.mean_forward, self.mean_backward))
        found = {"E": (float(means.min()), float(means.max()))}
        if self.s_forward is not None and self.s_backward is not None:
            wide = 2.0 * np.concatenate((self.s_forward, self.s_backward))
            found["A"] = (float((means - wide).min()), float((means + wide).max()))
        return found

    def figures(self) -> dict[str, float | None]:
        """The single-number results by their names."""
        return {
            field.name: getattr(self, field.name)
            for field in fields(self)
            if field.name[0] in "AREMB"
        }


def evaluate(runs: Runs) -> Evaluation:
    """Evaluate bidirectional runs.

    Parameters
    ----------
    runs : Runs
        Any number of runs; a reading may be missing (NaN) as long as every target has one in
        either direction. With fewer than two in a direction, A and R are None.

    Raises
    ------
    InputError
        A target without a reading in one direction.
    """
    forward, backward = (_Side(side, runs.position_mm) for side in (runs.forward, runs.backward))
    reversal = forward.mean - backward.mean
    bidirectional = 0.5 * (forward.mean + backward.mean)
    both = np.concatenate((forward.mean, backward.mean))
    return Evaluation(
        runs,
        forward.mean,
        backward.mean,
        forward.s,
        backward.s,
        reversal,
        A=_accuracy(forward, backward),
        A_forward=_accuracy(forward),
        A_backward=_accuracy(backward),
        R=_bidirectional_repeatability(forward, backward, reversal),
        R_forward=None if forward.s is None else float(4.0 * forward.s.max()),
        R_backward=None if backward.s is None else float(4.0 * backward.s.max()),
        E=float(np.ptp(both)),
        E_forward=float(np.ptp(forward.mean)),
        E_backward=float(np.ptp(backward.mean)),
        M=float(np.ptp(bidirectional)),
        B=float(np.abs(reversal).max()),
        B_mean=float(reversal.mean()),
    )


class _Side:
    """Mean and standard deviation at every target, from one direction."""

    def __init__(self, readings: np.ndarray, position_mm: np.ndarray) -> None:
        known = np.isfinite(readings)
        count = known.sum(axis=0)
        if not count.all():
            at = position_mm[np.argmin(count)]
            raise InputError(
                f"target {at:g} mm was approached from one side only",
                accepted="readings in both directions at every target",
            )
        self.mean = np.where(known, readings, 0.0).sum(axis=0) / count
        self.s = None
        if count.min() > 1:
            square = np.where(known, readings - self.mean, 0.0) ** 2
            self.s = np.sqrt(square.sum(axis=0) / (count - 1))


def _accuracy(*sides: _Side) -> float | None:
    """Range of the means, each widened by two standard deviations."""
    spread = [(side.mean, side.s) for side in sides if side.s is not None]
    if len(spread) < len(sides):
        return None
    high = max((mean + 2.0 * s).max() for mean, s in spread)
    low = min((mean - 2.0 * s).min() for mean, s in spread)
    return float(high - low)


def _bidirectional_repeatability(
    forward: _Side, backward: _Side, reversal: np.ndarray
) -> float | None:
    if forward.s is None or backward.s is None:
        return None
    together = 2.0 * forward.s + 2.0 * backward.s + np.abs(reversal)
    return float(np.max([together, 4.0 * forward.s, 4.0 * backward.s]))
