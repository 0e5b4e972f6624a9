"""The standard uncertainty of each test, where what it states is wrong by a factor of its own.

All tests share one unknown factor. Beside it each may have one: a measuring machine is stated with
its maximum permissible error, a ballbar with its resolution.

Source: closed form derived here: the most probable shared and own factors, normal in their
logarithms, of given scatter; the median of absolute normal values is 0.6745 of their deviation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vmach.fit.sizes import LOG_FACTOR
from vmach.measurements import MEDIAN_OF_NORMAL

__all__ = ["AS_STATED", "EXACT", "FEW", "OwnScale", "own_scale_of"]

#: fewer readings say little of a scatter: that of 20 is known within a quarter by their median
FEW = 20
#: scatter from which on it can be told, in stated uncertainties; below, readings are predictions
EXACT = 1e-3


@dataclass(frozen=True)
class OwnScale:
    """What uncertainties are of the stated ones.

    Attributes
    ----------
    of_readings : (n,) or () float64
        One for all readings of a test.
    log_prior : float
        How probable such scales are beforehand.
    """

    of_readings: np.ndarray
    log_prior: float = 0.0

    @property
    def log_determinant(self) -> float:
        """Of the covariance, beside what it is as stated."""
        return 2.0 * float(np.log(self.of_readings).sum())

    def is_as(self, other: OwnScale) -> bool:
        """Whether both say the same of every reading."""
        return np.array_equal(self.of_readings, other.of_readings)

    def of_some(self, rows: np.ndarray) -> OwnScale:
        """Those of some readings, by their numbers (m,)."""
        if self.of_readings.ndim == 0:
            return self
        return replace(self, of_readings=self.of_readings[rows])


AS_STATED = OwnScale(np.array(1.0))


def own_scale_of(left: np.ndarray, rows: Sequence[slice]) -> OwnScale:
    """The scale of each test by what it leaves of its readings.

    Parameters
    ----------
    left : (n,) float64
        What is left of each reading, without its own say, in stated standard uncertainties.
    rows : sequence of slice
        The readings of each test. One of few readings scatters as all do together.
    """
    told = np.array([len(left[own]) >= FEW for own in rows])
    if np.count_nonzero(told) < 2:
        return AS_STATED
    medians = np.array([np.median(np.abs(left[own])) for own in rows]) / MEDIAN_OF_NORMAL
    shown = np.log(np.maximum(medians, EXACT))
    # the shared factor is as probable beforehand as each of the others
    shared = shown[told].sum() / (np.count_nonzero(told) + 1)
    logs = np.where(told, shown - shared, 0.0)
    counts = [len(left[own]) for own in rows]
    log_prior = -0.5 * float(np.sum((logs / LOG_FACTOR) ** 2))
    return OwnScale(np.exp(np.repeat(logs, counts)), log_prior)
