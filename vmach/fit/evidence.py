"""How much better readings are explained with an effect than without: log evidence.

For readings y in unit noise and coefficients c with independent normal priors of variance
lambda^2, the Bayes factor of y = X c + noise against plain noise is, with the singular value
decomposition X = U s V^T and z = U^T y,

    log B = 1/2 sum_k [ z_k^2 w_k - log(1 + lambda^2 s_k^2) ],  w_k = lambda^2 s_k^2 / (1 + ...)

It is averaged over several prior widths and over the grid of the inner parameters, so that
looking in many places costs what it should. Under plain noise the chance of a factor above b is
at most 1/b.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

__all__ = ["WIDTHS", "Evidence", "evidence_of_unit", "log_evidence"]

#: prior widths in multiples of the usual size
WIDTHS = (0.1, 0.4, 1.5, 6.0)
_TINY = 1e-12


@dataclass(frozen=True)
class Evidence:
    """Log evidence of one candidate.

    Attributes
    ----------
    log_factor : (S,) float64
        For each of S sets of readings.
    best : (S,) int
        Place on the inner grid that fits best.
    best_width : (S,) int
        Index of the prior width that fits best there.
    information : float
        Largest singular value over the grid: signal-to-noise of one usual size.
    """

    log_factor: np.ndarray
    best: np.ndarray
    best_width: np.ndarray
    information: float


def log_evidence(columns: np.ndarray, readings: np.ndarray, log_prior: np.ndarray) -> Evidence:
    """Evidence for a candidate.

    Parameters
    ----------
    columns : (n, G, K) float64
        Whitened signatures of the usual sizes of K coefficients at G places on the grid.
    readings : (n, S) float64
        Whitened readings.
    log_prior : (G,) float64
        Logarithm of the weight of each place; the weights add up to one.
    """
    count, places, terms = columns.shape
    flat = columns.reshape(count, places * terms)
    inner = (flat.T @ readings).reshape(places, terms, -1)
    if terms == 1:
        gram = np.einsum("ngk,ngk->g", columns, columns)[:, None]
        projected = inner
        squared = gram
    else:
        by_place = np.ascontiguousarray(np.moveaxis(columns, 0, 1))
        gram = np.matmul(by_place.transpose(0, 2, 1), by_place)
        squared, vectors = np.linalg.eigh(gram)
        projected = np.matmul(vectors.transpose(0, 2, 1), inner)
    squared = np.maximum(squared, 0.0)
    z_squared = projected**2 / np.maximum(squared, _TINY)[:, :, None]
    factors = []
    for width in WIDTHS:
        ratio = width**2 * squared
        weight = ratio / (1.0 + ratio)
        gain = np.einsum("gk,gks->gs", weight, z_squared)
        factors.append(0.5 * (gain - np.log1p(ratio).sum(axis=1)[:, None]))
    by_width = np.array(factors)
    total = logsumexp(by_width, axis=0) - np.log(len(WIDTHS)) + log_prior[:, None]
    best = np.argmax(total, axis=0)
    return Evidence(
        log_factor=logsumexp(total, axis=0),
        best=best,
        best_width=np.argmax(by_width[:, best, np.arange(len(best))], axis=0),
        information=float(np.sqrt(squared.max(initial=0.0))),
    )


def evidence_of_unit(columns: np.ndarray, reading: np.ndarray) -> float:
    """Log evidence for causes of unit variance with whitened signatures (n, K)."""
    if columns.shape[1] == 0:
        return 0.0
    left, size, _ = np.linalg.svd(columns, full_matrices=False)
    ratio = size**2
    gain = (left.T @ reading) ** 2 * ratio / (1.0 + ratio)
    return float(0.5 * (gain.sum() - np.log1p(ratio).sum()))
