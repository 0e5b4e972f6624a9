"""What trial columns of unknown place would take off the readings: a matched filter.

Source: closed form derived here: least squares with a normal prior of each amount.
"""

from __future__ import annotations

from collections.abc import Callable

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


def peaks(power: np.ndarray, cosine: Callable[[int], np.ndarray], most: int) -> list[int]:
    """The trials of most power, none of which shares half of its readings with an earlier one.

    Parameters
    ----------
    power : (T,) float64
    cosine : callable
        Of the weights of the readings in a trial with those in all, (T,).
    most : int
    """
    left, found = power.copy(), []
    while left.max(initial=0.0) > 0.0:
        found.append(int(np.argmax(left)))
        if len(found) == most:
            break
        left[cosine(found[-1]) > 0.5] = 0.0
    return found
