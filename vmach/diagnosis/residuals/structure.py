"""Structure that no single effect has to explain: the gate that a naming has to pass.

Whatever an explanation leaves has to be noise. These flexible patterns, far too flexible to be
causes, are weighed like candidates: offsets, slopes and shapes of every feature, wandering in
time, patterns of tool and feed. If one of them is there, something real is left.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import block_diag
from scipy.special import chdtrc

from vmach.effects.laws.heat.wandering import wandering
from vmach.fit.evidence import SignatureBank
from vmach.fit.survey import Survey
from vmach.fit.whitening import Whitening

__all__ = ["Structure", "patterns"]

_SIMULATIONS = 200
#: chance that clean data fail the gate, for each of its two parts
_FALSE_ALARM = 0.0005
#: usual size of a pattern, mm
_SIZE_MM = 1.5e-3
_WAVES_IN_TIME = 12.0


def patterns(survey: Survey) -> dict[str, np.ndarray]:
    """Signatures (n, K) mm of each kind of pattern, of usual size."""
    return {"feature": _SIZE_MM * _of_features(survey), "time": _SIZE_MM * _in_time(survey)}


def _of_features(survey: Survey) -> np.ndarray:
    """Offset, slope, bend and shift of each group of readings, (n, K)."""
    names, number = np.unique(survey.group, return_inverse=True)
    inside = np.eye(len(names))[number]
    place = _place_within(number)
    shapes = [np.ones_like(place), place, place**2]
    if (np.abs(survey.sensing).max(axis=0) > 0).sum() > 1:
        shapes += [survey.sensing[:, 0], survey.sensing[:, 1]]
    return np.hstack([inside * shape[:, None] for shape in shapes])


def _in_time(survey: Survey) -> np.ndarray:
    """Wandering of the tool along X, Y and Z, new in every measurement, (n, K)."""
    blocks = []
    for path, m in zip(survey.paths, survey.measurements, strict=True):
        seconds = path.time_s
        waves = wandering(seconds, max(float(np.ptp(seconds)), 1.0) / _WAVES_IN_TIME)
        blocks.append((m.sensing[:, :, None] * waves[:, None, :]).reshape(len(m), -1))
    return block_diag(*blocks)


def _place_within(number: np.ndarray) -> np.ndarray:
    """Order of each reading within its group, from -1 to 1, (n,)."""
    place = np.zeros(len(number))
    for k in np.unique(number):
        rows = np.flatnonzero(number == k)
        place[rows] = np.linspace(-1.0, 1.0, len(rows)) if len(rows) > 1 else 0.0
    return place


class Structure:
    """The gate of one survey."""

    def __init__(self, survey: Survey, whiten: Whitening, *, seed: int = 2) -> None:
        blocks = {name: whiten(c)[:, None, :] for name, c in patterns(survey).items()}
        self._names = tuple(blocks)
        self._bank = SignatureBank(list(blocks.values()), [np.zeros(1)] * len(blocks))
        self._size, self._seed, self._projected = len(survey), seed, whiten.projected

    def threshold(self, absorb: Whitening | None = None) -> float:
        """Log evidence of a pattern that clean data exceed with the chance of a false alarm.

        Of what is left after an explanation: patterns that it takes up cost no evidence.
        """
        random = np.random.default_rng(self._seed)
        noise = self._projected(random.standard_normal((self._size, _SIMULATIONS)))
        largest = np.max([e.log_factor for e in self._bank.evidence(noise, absorb)], axis=0)
        return float(np.quantile(largest, 0.9) + np.log(0.1 / _FALSE_ALARM))

    def left_in(
        self, reading: np.ndarray, degrees: int, *, absorb: Whitening | None = None
    ) -> dict[str, float]:
        """What is left of whitened readings, by kind of pattern; empty if it is noise.

        Parameters
        ----------
        reading : (n,) float64
        degrees : int
            Degrees of freedom of what is left.
        absorb : Whitening, optional
            Takes the explanation out of readings and patterns.

        Returns
        -------
        dict
            Log evidence of each pattern above the threshold; "scatter": the ratio of variances
            where the readings scatter more than their uncertainty allows.
        """
        weighed = zip(self._names, self._bank.evidence(reading[:, None], absorb), strict=True)
        gains = {name: float(evidence.log_factor[0]) for name, evidence in weighed}
        threshold = self.threshold(absorb)
        found = {name: gain for name, gain in gains.items() if gain > threshold}
        residual = reading if absorb is None else absorb(reading)
        total = float(residual @ residual)
        if chdtrc(degrees, total) < _FALSE_ALARM:
            found["scatter"] = total / degrees
        return found
