"""How far a predicted deviation can be trusted, as far as the error tables are concerned."""

from __future__ import annotations

import numpy as np

from vmach.effects import Circumstances
from vmach.fit.table_uncertainty import TableUncertainty
from vmach.machine import Variant
from vmach.prediction import Prediction

__all__ = ["prediction_u_mm"]

#: points looked at in one go; a few hundred causes each
_BATCH = 2000


def prediction_u_mm(prediction: Prediction) -> np.ndarray:
    """Standard uncertainty of the deviation of every point that was cut, (C,) mm.

    It holds the noise of the tables' readings, the curve between their points and the
    squareness; not what the model lacks. Zero for a perfect machine.
    """
    states = prediction.states
    if prediction.variant is Variant.NONE:
        return np.zeros(len(states))
    job = prediction.preparation.job
    normals = prediction.normals[prediction.is_cut]
    tables = TableUncertainty.of(job.machine)
    variances = [
        np.square(tables.factors(Circumstances(states[rows], job), normals[rows])).sum(axis=1)
        for rows in np.array_split(np.arange(len(states)), len(states) // _BATCH + 1)
    ]
    return np.sqrt(np.concatenate(variances))
