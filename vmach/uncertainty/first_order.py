"""How far a predicted deviation can be trusted: error tables, and the effects of the job.

Source: JCGM 100:2008 (GUM), eq. 13, for the combined variance.
"""

from __future__ import annotations

import numpy as np

from vmach.effects import Circumstances
from vmach.machine import Variant
from vmach.path.toolpath import PathStates
from vmach.prediction import Prediction
from vmach.uncertainty.tables import TableUncertainty

__all__ = ["combined_u_mm", "prediction_u_mm"]

#: points looked at in one go; a few hundred causes each
_BATCH = 2000


def prediction_u_mm(prediction: Prediction) -> np.ndarray:
    """Standard uncertainty of the deviation of every point that was cut, (C,) mm.

    It holds the noise of the tables' readings, the curve between their points, and squareness. Of
    every effect of the job it holds the inexactness of the law and the uncertainty of the
    parameters. It does not hold what the model lacks. A perfect machine has the effects' share
    alone.
    """
    states, normals = prediction.states, prediction.normals[prediction.is_cut]
    batches = np.array_split(np.arange(len(states)), len(states) // _BATCH + 1)
    variances = [_variance(prediction, states[rows], normals[rows]) for rows in batches]
    return np.sqrt(np.concatenate(variances))


def combined_u_mm(prediction: Prediction, weights: np.ndarray) -> np.ndarray:
    """Standard uncertainty of sums over the points that were cut, (M,) mm.

    Causes that points share count as one, which is what the uncertainty of a fitted size or of a
    form needs (GUM, eq. 13 with correlated inputs).

    Parameters
    ----------
    weights : (M, C) array
        Weight of every point's deviation in each sum.
    """
    states, normals = prediction.states, prediction.normals[prediction.is_cut]
    used = np.flatnonzero(weights.any(axis=0))
    if not used.size:
        return np.zeros(len(weights))
    total = 0.0
    for rows in np.array_split(used, len(used) // _BATCH + 1):
        parts = _factors(prediction, states[rows], normals[rows])
        own = weights[:, rows]
        sums = [own @ part for part in parts]
        total = total + (np.hstack(sums) if sums else np.zeros((len(weights), 1)))
    return np.sqrt(np.square(total).sum(axis=1))


def _variance(prediction: Prediction, states: PathStates, normals: np.ndarray) -> np.ndarray:
    parts = _factors(prediction, states, normals)
    return sum((np.square(part).sum(axis=1) for part in parts), start=np.zeros(len(states)))


def _factors(prediction: Prediction, states: PathStates, normals: np.ndarray) -> list[np.ndarray]:
    """Deviation of every point by each unit cause, some (P, K) mm."""
    job = prediction.preparation.job
    parts = [
        np.einsum("pi,pik->pk", normals, effect.uncertainty_patterns(states))
        for effect in prediction.effects
    ]
    if prediction.variant is not Variant.NONE:
        tables = TableUncertainty.of(job.machine)
        path = Circumstances(states, job, prediction.variant)
        parts.append(tables.factors(path, normals))
    return parts
