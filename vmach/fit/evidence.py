"""How much better readings are explained with an effect than without: log evidence.

For readings y in unit noise and coefficients c with independent normal priors of variance
lambda^2, the Bayes factor of y = X c + noise against plain noise is, with the singular value
decomposition X = U s V^T and z = U^T y,

    log B = 1/2 sum_k [ z_k^2 w_k - log(1 + lambda^2 s_k^2) ],  w_k = lambda^2 s_k^2 / (1 + ...)

It is averaged over several prior widths and over the grid of the inner parameters, so that
looking in many places costs what it should. Under plain noise the chance of a factor above b is
at most 1/b.

Only inner products X^T X and X^T y enter. They are worked out for all candidates in a few large
matrix products; what an explanation absorbs changes them by a matrix of low rank.

Source: R. Kass and A. Raftery, Bayes factors, J. Am. Stat. Assoc. 90 (1995) 773; closed form
derived here: Gaussian integral over c. The bound 1/b is Markov's inequality.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from vmach.fit.whitening import Whitening

__all__ = ["WIDTHS", "Evidence", "SignatureBank", "evidence_of_unit", "log_evidence"]

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


class SignatureBank:
    """Signatures of many candidates, weighed together.

    Parameters
    ----------
    blocks : sequence of (n, G, K) float64
        Of each candidate: whitened signatures of the usual sizes of K coefficients at G places
        on the grid of its inner parameters.
    log_priors : sequence of (G,) float64
        Logarithm of the weight of each place; the weights of a candidate add up to one.
    """

    def __init__(self, blocks: Sequence[np.ndarray], log_priors: Sequence[np.ndarray]) -> None:
        self._shapes = [block.shape[1:] for block in blocks]
        self._log_priors = list(log_priors)
        # candidates with equally many coefficients lie side by side
        order = sorted(range(len(blocks)), key=lambda c: self._shapes[c][1])
        sizes = np.array([self._shapes[c][0] * self._shapes[c][1] for c in order])
        starts = np.cumsum(sizes) - sizes
        self._first = dict(zip(order, starts.tolist(), strict=True))
        self._members: dict[int, list[int]] = {}
        self._rows = np.empty((int(sizes.sum()), len(blocks[0]) if blocks else 0))
        for c in order:
            self._members.setdefault(self._shapes[c][1], []).append(c)
            self._rows[self._slice(c)] = blocks[c].reshape(len(blocks[c]), -1).T
        self._gram = {k: _products(self._part(self._rows, k)) for k in self._members}

    def columns(self, c: int) -> np.ndarray:
        """Whitened signatures of candidate c, (n, G, K)."""
        places, terms = self._shapes[c]
        return self._rows[self._slice(c)].reshape(places, terms, -1).transpose(2, 0, 1)

    def evidence(self, readings: np.ndarray, absorb: Whitening | None = None) -> list[Evidence]:
        """Evidence for every candidate.

        Parameters
        ----------
        readings : (n, S) float64
            Whitened readings.
        absorb : Whitening, optional
            Takes an explanation out of whitened readings and signatures.
        """
        if not self._shapes:
            return []
        if absorb is None:
            inner, removed = self._rows @ readings, None
        else:
            basis, change = absorb.change_of_products()
            inner = self._rows @ (readings - basis @ (change @ (basis.T @ readings)))
            removed = self._rows @ basis
        found: dict[int, Evidence] = {}
        for terms, members in self._members.items():
            gram = self._gram[terms]
            if removed is not None:
                part = self._part(removed, terms)
                gram = gram - np.matmul(part @ change, part.transpose(0, 2, 1))
            squared, by_width = _factors(gram, self._part(inner, terms))
            place = 0
            for c in members:
                own = slice(place, place := place + self._shapes[c][0])
                found[c] = _evidence(squared[own], by_width[:, own], self._log_priors[c])
        return [found[c] for c in range(len(self._shapes))]

    def _slice(self, c: int) -> slice:
        places, terms = self._shapes[c]
        return slice(self._first[c], self._first[c] + places * terms)

    def _part(self, rows: np.ndarray, terms: int) -> np.ndarray:
        """Rows of the candidates with so many coefficients, (places, coefficients, ...)."""
        members = self._members[terms]
        both = slice(self._slice(members[0]).start, self._slice(members[-1]).stop)
        return rows[both].reshape(-1, terms, rows.shape[1])


def _products(rows: np.ndarray) -> np.ndarray:
    return np.matmul(rows, rows.transpose(0, 2, 1))


def _factors(gram: np.ndarray, inner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Squared singular values (P, K) and log factors (widths, P, S) at every place."""
    if gram.shape[1] == 1:
        squared, projected = gram[:, 0], inner
    else:
        squared, vectors = np.linalg.eigh(gram)
        projected = np.matmul(vectors.transpose(0, 2, 1), inner)
    squared = np.maximum(squared, 0.0)
    z_squared = projected**2 / np.maximum(squared, _TINY)[:, :, None]
    factors = []
    for width in WIDTHS:
        ratio = width**2 * squared
        gain = np.einsum("gk,gks->gs", ratio / (1.0 + ratio), z_squared)
        factors.append(0.5 * (gain - np.log1p(ratio).sum(axis=1)[:, None]))
    return squared, np.array(factors)


def _evidence(squared: np.ndarray, by_width: np.ndarray, log_prior: np.ndarray) -> Evidence:
    total = _log_of_sum(by_width) - np.log(len(WIDTHS)) + log_prior[:, None]
    best = np.argmax(total, axis=0)
    return Evidence(
        log_factor=_log_of_sum(total),
        best=best,
        best_width=np.argmax(by_width[:, best, np.arange(len(best))], axis=0),
        information=float(np.sqrt(squared.max(initial=0.0))),
    )


def _log_of_sum(logarithms: np.ndarray) -> np.ndarray:
    """Logarithm of the sum over the first axis; as scipy's logsumexp, without its checks."""
    largest = logarithms.max(axis=0)
    return largest + np.log(np.exp(logarithms - largest).sum(axis=0))


def log_evidence(columns: np.ndarray, readings: np.ndarray, log_prior: np.ndarray) -> Evidence:
    """Evidence for a single candidate, its block and weights as in a `SignatureBank`."""
    return SignatureBank([columns], [log_prior]).evidence(readings)[0]


def evidence_of_unit(columns: np.ndarray, reading: np.ndarray) -> float:
    """Log evidence for causes of unit variance with whitened signatures (n, K)."""
    if columns.shape[1] == 0:
        return 0.0
    lower = np.linalg.cholesky(np.eye(columns.shape[1]) + columns.T @ columns)
    found = solve_triangular(lower, columns.T @ reading, lower=True)
    return float(0.5 * found @ found - np.log(np.diag(lower)).sum())
