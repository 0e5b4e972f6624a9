"""What trial columns of unknown place would take off the readings: a matched filter.

Source: closed form derived here: least squares with a normal prior of each amount.
"""

from __future__ import annotations

import numpy as np

from vmach.diagnosis.proposals.form import USUAL_UM

__all__ = ["matched_power", "peaks"]


def matched_power(seen: np.ndarray, gram: np.ndarray) -> np.ndarray:
    """What each of T trials takes off the sum of squares, (T,).

    Parameters
    ----------
    seen : (T, D) 1/mm
        Products of its D columns, in unit noise, with the readings.
    gram : (T, D, D) 1/mm²
        Products of its columns with each other.
    """
    prior = np.eye(gram.shape[1]) / (1e-3 * USUAL_UM) ** 2
    if gram.shape[1] == 1:  # as most have: asked thousands of times
        return seen[:, 0] * (seen[:, 0] / (gram[:, 0, 0] + prior[0, 0]))
    return (seen * np.linalg.solve(gram + prior, seen[:, :, None])[:, :, 0]).sum(axis=1)


def peaks(
    power: np.ndarray, shared: np.ndarray, most: int, *, length: np.ndarray | None = None
) -> list[int]:
    """The trials of most power, none of which shares half of its readings with an earlier one.

    Parameters
    ----------
    power : (T,) float64
    shared : (T, n) float64
        Weights of the readings in each trial.
    most : int
    length : (T,) float64, optional
        Norms of the weights, where they are known.
    """
    length = np.linalg.norm(shared, axis=1) if length is None else length
    left, found = power.copy(), []
    while len(found) < most and left.max(initial=0.0) > 0.0:
        best = int(np.argmax(left))
        found.append(best)
        cosine = shared @ shared[best] / np.maximum(length * length[best], 1e-300)
        left[cosine > 0.5] = 0.0
    return found
