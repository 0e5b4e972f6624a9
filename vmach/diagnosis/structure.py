"""Structure that no single effect has to explain: the gate that a naming has to pass.

Whatever an explanation leaves has to be noise. These flexible patterns, far too flexible to be
causes, are weighed like candidates: offsets, slopes and shapes of every feature, wandering in
time, patterns of tool and feed. If one of them is there, something real is left.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from vmach.effects.wandering import wandering
from vmach.fit.evidence import log_evidence
from vmach.fit.survey import Survey
from vmach.fit.whitening import Whitening

__all__ = ["Structure", "patterns"]

_SIMULATIONS = 200
#: chance that clean data fail the gate, for each of its two parts
_FALSE_ALARM = 0.002
#: usual size of a pattern, mm
_SIZE_MM = 1.5e-3
_WAVES_IN_TIME = 12.0


def patterns(survey: Survey) -> dict[str, np.ndarray]:
    """Signatures (n, K) mm of each kind of pattern, of usual size."""
    names, number = np.unique(survey.group, return_inverse=True)
    inside = np.eye(len(names))[number]
    place = _place_within(number)
    shapes = [np.ones_like(place), place, place**2]
    if (np.abs(survey.sensing).max(axis=0) > 0).sum() > 1:
        shapes += [survey.sensing[:, 0], survey.sensing[:, 1]]
    feature = np.hstack([inside * shape[:, None] for shape in shapes])
    time, first = [], 0
    for path, m in zip(survey.paths, survey.measurements, strict=True):
        seconds = path.time_s
        waves = wandering(seconds, max(float(np.ptp(seconds)), 1.0) / _WAVES_IN_TIME)
        block = np.zeros((len(survey), 3 * waves.shape[1]))
        rows = slice(first, first + len(m))
        block[rows] = (m.sensing[:, :, None] * waves[:, None, :]).reshape(len(m), -1)
        time.append(block)
        first += len(m)
    return {"feature": _SIZE_MM * feature, "time": _SIZE_MM * np.hstack(time)}


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
        self._white = {name: whiten(c)[:, None, :] for name, c in patterns(survey).items()}
        random = np.random.default_rng(seed)
        noise = whiten.projected(random.standard_normal((len(survey), _SIMULATIONS)))
        largest = np.max(
            [log_evidence(c, noise, np.zeros(1)).log_factor for c in self._white.values()], axis=0
        )
        #: log evidence of a pattern that clean data exceed with the chance of a false alarm
        self.threshold = float(np.quantile(largest, 0.9) + np.log(0.1 / _FALSE_ALARM))

    def left_in(self, residual: np.ndarray, degrees: int, *, absorb=None) -> dict[str, float]:
        """What is left in a whitened residual, by kind of pattern; empty if it is noise.

        Parameters
        ----------
        residual : (n,) float64
        degrees : int
            Its degrees of freedom.
        absorb : callable, optional
            What took the explanation out of the readings, to be applied to the patterns too.

        Returns
        -------
        dict
            Log evidence of each pattern above the threshold; "scatter": the ratio of variances
            where the readings scatter more than their uncertainty allows.
        """
        found = {}
        for name, columns in self._white.items():
            pattern = columns if absorb is None else absorb(columns)
            evidence = float(log_evidence(pattern, residual[:, None], np.zeros(1)).log_factor[0])
            if evidence > self.threshold:
                found[name] = evidence
        total = float(residual @ residual)
        if chi2.sf(total, degrees) < _FALSE_ALARM:
            found["scatter"] = total / degrees
        return found
