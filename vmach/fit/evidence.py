"""How much better readings are explained with an effect than without: log evidence.

Let readings y have unit noise, and coefficients c independent normal priors of variance lambda^2.
With the singular value decomposition X = U s V^T and z = U^T y, the Bayes factor of y = X c + noise
against plain noise is

    log B = 1/2 sum_k [ z_k^2 w_k - log(1 + lambda^2 s_k^2) ],  w_k = lambda^2 s_k^2 / (1 + ...)

It is averaged over several prior widths and over the grid of the inner parameters, so that
looking in many places costs what it should. Under plain noise the chance of a factor above b is
at most 1/b.

Only inner products X^T X and X^T y enter.

Source: R. Kass and A. Raftery, Bayes factors, J. Am. Stat. Assoc. 90 (1995) 773; closed form
derived here: Gaussian integral over c. The bound 1/b is Markov's inequality.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

__all__ = [
    "WIDTHS",
    "Evidence",
    "evidence_at_places",
    "width_of",
]

#: prior widths in multiples of the usual size
WIDTHS = (0.1, 0.4, 1.5, 6.0)
_TINY = 1e-12


@dataclass(frozen=True)
class Evidence:
    """Log evidence of C candidates on S sets of readings.

    Attributes
    ----------
    log_factor : (C, S) float64
    best : (C, S) int
        Place on the candidate's inner grid that fits best.
    best_width : (C, S) int
        Index of the prior width that fits best there.
    information : (C,) float64
        Largest singular value over the grid: signal-to-noise of one usual size.
    """

    log_factor: np.ndarray
    best: np.ndarray
    best_width: np.ndarray
    information: np.ndarray

    @classmethod
    def joined(cls, parts: Sequence[Evidence], order: np.ndarray) -> Evidence:
        """Of several groups of candidates on one set of readings, put in an order (C,)."""
        none, nowhere = np.zeros((0, 1)), np.zeros((0, 1), dtype=int)
        every = [cls(none, nowhere, nowhere, np.zeros(0)), *parts]
        names = ("log_factor", "best", "best_width", "information")
        return cls(*(np.concatenate([getattr(p, n) for p in every])[order] for n in names))


def _factors(gram: np.ndarray, inner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Squared singular values (P, K) and log factors (widths, P, S) at every place."""
    if gram.shape[1] == 1:
        squared, projected = gram[:, 0], inner
    else:
        squared, vectors = _axes_of_two(gram) if gram.shape[1] == 2 else np.linalg.eigh(gram)
        projected = np.matmul(vectors.transpose(0, 2, 1), inner)
    squared = np.maximum(squared, 0.0)
    z_squared = projected**2 / np.maximum(squared, _TINY)[:, :, None]
    factors = []
    for width in WIDTHS:
        ratio = width**2 * squared
        gain = np.einsum("gk,gks->gs", ratio / (1.0 + ratio), z_squared)
        factors.append(0.5 * (gain - np.log1p(ratio).sum(axis=1)[:, None]))
    return squared, np.array(factors)


def _axes_of_two(gram: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues (P, 2) and eigenvectors in columns (P, 2, 2) of P symmetric matrices (P, 2, 2).

    Source: the rotation of C. Jacobi, J. reine angew. Math. 30 (1846) 51, one step of which is
    exact for two.
    """
    first, shared, second = gram[:, 0, 0], gram[:, 0, 1], gram[:, 1, 1]
    mean, half = 0.5 * (first + second), 0.5 * (first - second)
    apart, angle = np.hypot(half, shared), 0.5 * np.arctan2(shared, half)
    cosine, sine = np.cos(angle), np.sin(angle)
    axes = np.stack([np.stack([-sine, cosine]), np.stack([cosine, sine])])
    return np.stack([mean - apart, mean + apart], axis=1), axes.transpose(2, 1, 0)


def _log_of_sum(logarithms: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Logarithm of the sum over stretches of the first axis that begin at `starts`."""
    largest = np.maximum.reduceat(logarithms, starts)
    count = np.diff([*starts, len(logarithms)])
    relative = np.exp(logarithms - np.repeat(largest, count, axis=0))
    return largest + np.log(np.add.reduceat(relative, starts))


def width_of(coefficients: np.ndarray) -> float:
    """The prior width under which fitted coefficients (K,) are most likely."""
    size = float(coefficients @ coefficients)
    likely = [-0.5 * size / w**2 - len(coefficients) * np.log(w) for w in WIDTHS]
    return WIDTHS[int(np.argmax(likely))]


def evidence_at_places(
    gram: np.ndarray, inner: np.ndarray, log_priors: Sequence[np.ndarray]
) -> Evidence:
    """Evidence of candidates with K coefficients, from inner products at all their places.

    Parameters
    ----------
    gram : (P, K, K) float64
        Of the whitened signatures with each other, candidate by candidate.
    inner : (P, K, S) float64
        With S sets of readings.
    log_priors : sequence of (G,) float64
        Of each candidate; the lengths add up to P.
    """
    squared, by_width = _factors(gram, inner)
    count = [len(log_prior) for log_prior in log_priors]
    starts = np.cumsum([0, *count[:-1]])
    widths, places, sets = by_width.shape
    total = _log_of_sum(by_width.reshape(widths, -1), np.zeros(1, dtype=int)).reshape(places, sets)
    total += np.concatenate(log_priors)[:, None] - np.log(widths)
    log_factor = _log_of_sum(total, starts)
    # the first of the places that are best
    is_best = total == np.repeat(np.maximum.reduceat(total, starts), count, axis=0)
    number = np.where(is_best, np.arange(places)[:, None], places)
    best = np.minimum.reduceat(number, starts)
    return Evidence(
        log_factor=log_factor,
        best=best - starts[:, None],
        best_width=np.argmax(by_width[:, best, np.arange(sets)], axis=0),
        information=np.sqrt(np.maximum.reduceat(squared.max(axis=1, initial=0.0), starts)),
    )
