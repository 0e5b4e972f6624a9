"""The best that a kind of table can do: least squares of the error onto what it can hold.

A table of straight lines between entries is a sum of hat functions of one axis' position; a
product with another axis' position scales them by that position. Every correction that such
tables can give is therefore A x with a sparse matrix A (one row per sample, one column per entry).
The entries that leave the least mean square over the samples solve

    (A' W A + r I) x = -A' W e

for each axis that is moved, with W the weights of the samples and r a thousand millionth of the
mean diagonal: it chooses the smallest entries where several tables can say the same (a constant
in two of them). The solution is linear in e, so the same factors give what is left of every
component error.

Source: closed form derived here: the normal equations of weighted least squares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import csr_matrix, diags, hstack

from vmach.controller_tables.knots import Knots, hat_matrix
from vmach.controller_tables.samples import ErrorSamples

__all__ = ["AxisTable", "Projection", "Term", "scaled"]

_RIDGE = 1e-9


@dataclass(frozen=True)
class Term:
    """One table that a format can hold.

    Attributes
    ----------
    input_axis, output_axis : int
        The axis whose position is looked up, and the axis that is moved.
    by_direction : bool
        Whether it has other entries for motion of the input axis in negative direction.
    factor_axis : int or None
        The correction is multiplied by this axis' position, scaled to -1 .. 1 over its knots.
    """

    input_axis: int
    output_axis: int
    by_direction: bool = False
    factor_axis: int | None = None


@dataclass(frozen=True)
class AxisTable:
    """The entries of a term: what is added to the commanded position, mm.

    Attributes
    ----------
    term : Term
    position_mm : (K,) float64
    forward_mm, backward_mm : (K,) float64
        The same where the term does not tell directions apart.
    """

    term: Term
    position_mm: np.ndarray
    forward_mm: np.ndarray
    backward_mm: np.ndarray

    @property
    def largest_mm(self) -> float:
        """Largest entry."""
        return float(max(np.abs(self.forward_mm).max(), np.abs(self.backward_mm).max()))


def scaled(knots: Knots, at_mm: np.ndarray) -> np.ndarray:
    """Positions along an axis, (P,) mm, as -1 at the first entry and 1 at the last, (P,)."""
    ends = knots.position_mm[[0, -1]]
    return (2.0 * at_mm - ends.sum()) / (ends[1] - ends[0])


class Projection:
    """Least-squares fit of given terms to given samples.

    Parameters
    ----------
    terms : sequence of Term
    knots : (Knots, Knots, Knots)
        Of the tables over X, Y and Z.
    samples : ErrorSamples
    """

    def __init__(
        self, terms: Sequence[Term], knots: tuple[Knots, Knots, Knots], samples: ErrorSamples
    ) -> None:
        self.knots, self.samples = knots, samples
        self.terms = [[term for term in terms if term.output_axis == k] for k in range(3)]
        self._weighted, self._factors = [], []
        for mine in self.terms:
            matrix = self._design(mine, samples)
            weighted = matrix.T @ diags(samples.weight)
            self._weighted.append(weighted)
            self._factors.append(_factor((weighted @ matrix).toarray()) if mine else None)

    def entries(self, error_mm: np.ndarray) -> list[np.ndarray]:
        """Entries that correct `error_mm` (P, 3) best; one vector for each axis moved."""
        return [
            cho_solve(factor, -(weighted @ error_mm[:, k])) if factor is not None else np.zeros(0)
            for k, (weighted, factor) in enumerate(zip(self._weighted, self._factors, strict=True))
        ]

    def tables(self, error_mm: np.ndarray) -> list[AxisTable]:
        """The entries that correct errors, (P, 3) mm, as tables."""
        found = []
        for mine, values in zip(self.terms, self.entries(error_mm), strict=True):
            for term in mine:
                position = self.knots[term.input_axis].position_mm
                count = len(position)
                forward, values = values[:count], values[count:]
                backward = forward
                if term.by_direction:
                    backward, values = values[:count], values[count:]
                found.append(AxisTable(term, position, forward, backward))
        return found

    def left(
        self, errors: dict[str, np.ndarray], check: ErrorSamples, shares: dict[str, np.ndarray]
    ) -> dict[str, tuple[float, float]]:
        """Root mean square of each share of the error at `check`, before and after, mm.

        Parameters
        ----------
        errors, shares : mapping of name to (P, 3) mm
            The shares at the samples of the fit, and at `check`.
        """
        designs = [self._design(mine, check) for mine in self.terms]
        found = {}
        for name, share in shares.items():
            after = share.copy()
            for k, values in enumerate(self.entries(errors[name])):
                after[:, k] += designs[k] @ values
            found[name] = (_rms(share, check.weight), _rms(after, check.weight))
        return found

    def _design(self, terms: Sequence[Term], samples: ErrorSamples) -> csr_matrix:
        blocks = [self._columns(term, samples) for term in terms]
        return csr_matrix(hstack(blocks)) if blocks else csr_matrix((len(samples), 0))

    def _columns(self, term: Term, samples: ErrorSamples) -> csr_matrix:
        axis = term.input_axis
        hats = hat_matrix(self.knots[axis].position_mm, samples.nose_mm[:, axis])
        if term.factor_axis is not None:
            factor = scaled(self.knots[term.factor_axis], samples.nose_mm[:, term.factor_axis])
            hats = diags(factor) @ hats
        if not term.by_direction:
            return hats
        forward = 0.5 * (1.0 + np.sign(samples.direction[:, axis]))
        return hstack([diags(forward) @ hats, diags(1.0 - forward) @ hats])


def _factor(gram: np.ndarray):
    gram[np.diag_indices_from(gram)] += _RIDGE * max(np.trace(gram) / len(gram), 1e-300)
    return cho_factor(gram, overwrite_a=True)


def _rms(vectors: np.ndarray, weight: np.ndarray) -> float:
    return float(np.sqrt(weight @ (vectors**2).sum(axis=1)))
