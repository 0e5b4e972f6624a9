"""Noise of single readings: correlated along a feature, with heavy tails, up to one factor.

In units of the standard uncertainty u, as stated or as a test shows it, the covariance of the
readings of one feature is

    C = (1 - s) diag(1 / w) + s r^|i - j|

with the share s that goes from point to point with the correlation r (stylus, form of the wall),
and weights w below one for readings that stand out from their neighbours: the mean of a
chi-squared mixture, with which a normal distribution becomes Student's t.

Source: K. Lange, R. Little and J. Taylor, J. Am. Stat. Assoc. 84 (1989) 881 (Student's t as a
mixture).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vmach.fit.noise.along_features import AlongFeatures
from vmach.fit.noise.own_scale import AS_STATED, OwnScale

__all__ = ["FeatureNoise"]


@dataclass(frozen=True)
class FeatureNoise:
    """Covariance of n readings.

    Attributes
    ----------
    u_mm : (n,) float64
        Stated standard uncertainty.
    group : (n,) str
        Feature or run; readings follow each other within it.
    weight : (n,) float64
    share, correlation : float
        Of the variance that is correlated, and from one reading to the next.
    log_prior : float
        Log probability of the weights, as far as the covariance does not state it: readings
        weighed otherwise are compared with it.
    degrees : float
        Of freedom of Student's t that the weights are of.
    own_scale : OwnScale
        What each test's uncertainty is of the stated one, beside the factor that all share.
    """

    u_mm: np.ndarray
    group: np.ndarray
    weight: np.ndarray
    share: float = 0.0
    correlation: float = 0.0
    log_prior: float = 0.0
    degrees: float = np.inf
    own_scale: OwnScale = AS_STATED

    @cached_property
    def shown_mm(self) -> np.ndarray:
        """Standard uncertainty, as each test shows it, (n,)."""
        return self.u_mm * self.own_scale.of_readings

    @property
    def widening(self) -> float:
        """Standard uncertainties of parameters, in those of readings with weights that are known.

        Weights come from the same readings: these say (v + 1)/(v + 3) of what the weights let
        them say, v the degrees of freedom.

        Source: Lange, Little and Taylor (1989), the expected information of Student's t.
        """
        return float(np.sqrt(1.0 + 2.0 / (self.degrees + 1.0)))

    @property
    def is_plain(self) -> bool:
        """Whether every reading weighs as stated."""
        return bool(np.all(self.weight == 1.0))

    def is_as(self, other: FeatureNoise) -> bool:
        """Whether it is that of the same readings with the same weights and correlation."""
        same = np.array_equal(self.weight, other.weight) and self.share == other.share
        same = same and self.own_scale.is_as(other.own_scale)
        return same and self.correlation == other.correlation and self.u_mm is other.u_mm

    def of_some(self, rows: np.ndarray) -> FeatureNoise:
        """The noise of some readings, evenly spread, by their numbers (m,)."""
        # neighbours are further apart
        further = self.correlation ** (len(self.u_mm) / len(rows))
        own = {name: getattr(self, name)[rows] for name in ("u_mm", "group", "weight")}
        return replace(self, correlation=further, own_scale=self.own_scale.of_some(rows), **own)

    def white(self, columns: np.ndarray) -> np.ndarray:
        """Columns (n, k) mm in unit noise."""
        if self._along is not None:
            return self._along.white(columns)
        scaled = columns / self.shown_mm[:, None]
        scaled *= np.sqrt(self.weight)[:, None]
        return scaled

    def back(self, white: np.ndarray) -> np.ndarray:
        """Columns (n, k) by the transpose of the map that makes columns white."""
        if self._along is not None:
            return self._along.back(white)
        return white * (np.sqrt(self.weight) / self.shown_mm)[:, None]

    def deviations(self, weights: np.ndarray) -> np.ndarray:
        """Of weighted sums of readings, (n, k) mm: a column's squares add up to a variance."""
        if self._along is not None:
            return self._along.deviations(weights)
        return weights * self.shown_mm[:, None] / np.sqrt(self.weight)[:, None]

    def standardised(self, white: np.ndarray) -> np.ndarray:
        """The expected independent part of white readings (n,), in standard deviations."""
        if self._along is None:
            return white / np.sqrt(self.weight)
        back = self._along.back(white[:, None])[:, 0] * self.shown_mm
        return np.sqrt(1.0 - self.share) / self.weight * back

    def autocorrelation(self, left: np.ndarray, lag: int) -> float:
        """Of what is left (n,) of readings that follow each other in a feature."""
        _, number = np.unique(self.group, return_inverse=True)
        order = np.argsort(number, kind="stable")
        value, number = left[order], number[order]
        same = number[lag:] == number[:-lag]
        if not same.any():
            return 0.0
        return float(np.mean((value[lag:] * value[:-lag])[same]) / np.mean(value**2))

    @cached_property
    def precisions(self) -> np.ndarray:
        """Of every reading, given all others, in units of `shown_mm`, (n,)."""
        return self.weight if self._along is None else self._along.precisions * self.shown_mm**2

    @cached_property
    def log_determinant(self) -> float:
        """Of the covariance in units of the stated u."""
        own = self.own_scale.log_determinant
        if self._along is None:
            return own - float(np.log(self.weight).sum())
        return own + self._along.log_determinant

    @cached_property
    def _along(self) -> AlongFeatures | None:
        """The covariance, where readings of a feature are correlated."""
        if self.share == 0.0:
            return None
        own = (1.0 - self.share) / self.weight
        return AlongFeatures(self.shown_mm, self.group, own, self.share, self.correlation)
