"""How far a predicted deviation can be trusted: error tables, and the effects of the job.

Source: JCGM 100:2008 (GUM), eq. 13, for the combined variance.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vmach.effects import Circumstances, EffectInstance
from vmach.effects.correlated import patterns_left_open
from vmach.job import Job
from vmach.machine import Variant
from vmach.path.toolpath import PathStates
from vmach.prediction import Prediction
from vmach.uncertainty.tables import TableUncertainty

__all__ = ["combined_u_mm", "path_u_mm", "prediction_u_mm"]

#: points looked at in one go; a few hundred causes each, so that it stays in the cache
_BATCH = 1000


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


def path_u_mm(
    states: PathStates, sensing: np.ndarray, weights: np.ndarray, *, job: Job, variant: Variant,
    effects: Sequence[EffectInstance],
) -> np.ndarray:  # fmt: skip
    """Standard uncertainty of sums over states of the path, (M,) mm.

    Parameters
    ----------
    states : PathStates
        P states.
    sensing : (P, 3) array
        Direction in which the error of each is looked at, a unit vector.
    weights : (M, P) array
        Weight of every state's error in each sum.
    """
    parts = [weights @ part for part in _causes(states, sensing, job, variant, effects)]
    return np.sqrt(sum((np.square(part).sum(axis=1) for part in parts), np.zeros(len(weights))))


def _variance(prediction: Prediction, states: PathStates, normals: np.ndarray) -> np.ndarray:
    parts = _factors(prediction, states, normals)
    return sum((np.square(part).sum(axis=1) for part in parts), start=np.zeros(len(states)))


def _factors(prediction: Prediction, states: PathStates, normals: np.ndarray) -> list[np.ndarray]:
    """Deviation of every point by each unit cause, some (P, K) mm."""
    job = prediction.preparation.job
    return _causes(states, normals, job, prediction.variant, prediction.effects)


def _causes(
    states: PathStates, sensing: np.ndarray, job: Job, variant: Variant,
    effects: Sequence[EffectInstance],
) -> list[np.ndarray]:  # fmt: skip
    """Error of every state along its direction by each unit cause, some (P, K) mm."""
    parts = [
        np.einsum("pi,pik->pk", sensing, patterns)
        for patterns in patterns_left_open(effects, states)
    ]
    if variant is not Variant.NONE:
        tables = TableUncertainty.of(job.machine)
        parts.append(tables.factors(Circumstances(states, job, variant), sensing))
    return parts
