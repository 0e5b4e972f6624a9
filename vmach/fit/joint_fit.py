"""Joint fit of several effects: amplitudes by generalised least squares, inner parameters around.

The amplitudes are eliminated at every step (variable projection); a component's correction curve
is held by its smoothness prior, everything else is free. What the whitening left free, alignment
and zeros, is fitted at the same time.

Source: G. Golub and V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413 (variable projection).
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import least_squares

from vmach.fit.survey import Survey
from vmach.fit.terms import FREE, JointFit, Term, Whitener

__all__ = ["fit_terms"]

#: step of logarithms in a derivative
_STEP = 1e-3
#: places whose signatures are whitened together
_AT_ONCE = 64


def fit_terms(
    survey: Survey,
    terms: Sequence[Term],
    whiten: Whitener,
    *,
    refine: bool = True,
) -> JointFit:
    """Fit terms to the readings of a survey.

    Parameters
    ----------
    survey : Survey
    terms : sequence of Term
        With starting values.
    whiten : callable
        Turns columns (n, ...) mm into unit noise.
    refine : bool
        Whether inner parameters move from their starting values.
    """
    problem = _Problem(survey, tuple(terms), whiten, whiten(survey.residual_mm))
    if refine:
        problem = problem.at_best_places()
    start = problem.logarithms()
    if refine and len(start):
        low, high = problem.bounds()
        found = least_squares(
            problem.residual,
            np.clip(start, low, high),
            bounds=(low, high),
            x_scale=0.3,
            diff_step=_STEP,
            max_nfev=12,
            xtol=1e-4,
            ftol=1e-5,
        )
        problem = problem.at(found.x)
    return problem.solve()


@dataclass(frozen=True)
class _Problem:
    """The fit as a function of the logarithms of all free inner parameters, I in all.

    Attributes
    ----------
    survey : Survey
    terms : tuple of Term
        Their coefficients are K in all.
    whiten : callable
    reading : (n,) float64
        What is to be explained, whitened.
    known, products : dict
        Signatures that were worked out, and their products with each other, for all problems
        that are made of this one.
    """

    survey: Survey
    terms: tuple[Term, ...]
    whiten: Whitener
    reading: np.ndarray
    known: dict[Hashable, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    products: dict[tuple[Hashable, Hashable], np.ndarray] = field(default_factory=dict)

    def logarithms(self) -> np.ndarray:
        """Where the free inner parameters are, (I,)."""
        values = [term.inner[name] for term in self.terms for name in term.free_inner]
        return np.log(np.maximum(values, 1e-9)) if values else np.zeros(0)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Between which ends the logarithms may move, (I,) each."""
        ends = [(p.low, p.high) for term in self.terms for p in term.free_parameters]
        low, high = np.log(np.array(ends)).T
        return low - 1e-9, high + 1e-9

    def at(self, logarithms: np.ndarray) -> _Problem:
        """The problem with its free inner parameters at given logarithms, (I,)."""
        places = _stretches([len(term.free_parameters) for term in self.terms])
        moved = []
        for term, own in zip(self.terms, places, strict=True):
            values = np.exp(logarithms[own]).tolist()
            update = dict(zip(term.free_inner, values, strict=True))
            moved.append(replace(term, inner={**term.inner, **update}))
        return self._of(moved)

    def _of(self, terms: Sequence[Term]) -> _Problem:
        """The same problem with other terms."""
        return replace(self, terms=tuple(terms))

    def at_best_places(self) -> _Problem:
        """Terms that have places to choose among at the best of them, given the others."""
        terms = self.terms
        for k, term in enumerate(self.terms):
            places, log_prior = self.survey.places(term.effect, term.target, term.inner)
            if places:
                others = self._of([t for i, t in enumerate(terms) if i != k])
                gains = others.gains_of(term, places) + log_prior
                moved = replace(term, inner=places[int(np.argmax(gains))])
                terms = (*terms[:k], moved, *terms[k + 1 :])
        return self._of(terms)

    def gains_of(self, term: Term, places: Sequence[Mapping[str, float]]) -> np.ndarray:
        """Half of what a further term at each of some places (G,) takes off the sum of squares."""
        rows, aim = self._rows(), self.reading
        precision = self._precision()
        left = aim - rows @ np.linalg.solve(precision, rows.T @ aim)
        gains = []
        for k in range(0, len(places), _AT_ONCE):
            some = places[k : k + _AT_ONCE]
            raw = [self.survey.signature(term.effect, term.target, inner) for inner in some]
            columns = self.whiten(np.hstack(raw))
            each = columns.T.reshape(len(some), -1, len(left))
            shared = (columns.T @ rows).reshape(*each.shape[:2], rows.shape[1])
            taken = shared @ np.linalg.solve(precision, shared.transpose(0, 2, 1))
            own = each @ each.transpose(0, 2, 1) - taken + np.eye(each.shape[1]) / FREE**2
            seen = each @ left
            solved = np.linalg.solve(own, seen[:, :, None])[:, :, 0]
            gains.append(0.5 * np.einsum("gk,gk->g", seen, solved))
        return np.concatenate(gains)

    def columns(self, term: Term) -> tuple[np.ndarray, np.ndarray]:
        """Signatures of a term in mm and whitened, (n, own K) each."""
        if term.place not in self.known:
            raw = self.survey.signature(term.effect, term.target, term.inner)
            self.known[term.place] = raw, self.whiten(raw)
        return self.known[term.place]

    def _rows(self) -> np.ndarray:
        """Whitened signatures of all terms, (n, K)."""
        none = np.zeros((len(self.reading), 0))
        return np.hstack([none, *(self.columns(term)[1] for term in self.terms)])

    def _widths(self) -> np.ndarray:
        """Prior standard deviation of every coefficient, (K,)."""
        each = [np.full(self.columns(t)[1].shape[1], t.prior_width) for t in self.terms]
        return np.concatenate([np.zeros(0), *each])

    def _precision(self) -> np.ndarray:
        """Of all coefficients, from readings and priors, (K, K); products are worked out once."""
        blocks = [[self._products(one, other) for other in self.terms] for one in self.terms]
        gram = np.block(blocks) if blocks else np.zeros((0, 0))
        return gram + np.diag(self._widths() ** -2.0)

    def _products(self, one: Term, other: Term) -> np.ndarray:
        """Of the whitened signatures of two terms."""
        key = one.place, other.place
        if key not in self.products:
            found = self.columns(one)[1].T @ self.columns(other)[1]
            self.products[key], self.products[key[::-1]] = found, found.T
        return self.products[key]

    def _solution(self) -> np.ndarray:
        """The most probable coefficients, (K,)."""
        seen = [self.columns(term)[1].T @ self.reading for term in self.terms]
        return np.linalg.solve(self._precision(), np.concatenate([np.zeros(0), *seen]))

    def residual(self, logarithms: np.ndarray) -> np.ndarray:
        """What is left, (n + K,), at logarithms (q,) with the best coefficients and priors."""
        here = self.at(logarithms)
        solution = here._solution()
        unusual = np.concatenate([term.unusual for term in here.terms])
        left = self.reading.copy()
        for term, own in zip(here.terms, here._stretches(), strict=True):
            left -= here.columns(term)[1] @ solution[own]
        return np.concatenate([left, -solution / here._widths(), unusual])

    def _stretches(self) -> list[slice]:
        """Where among the K the coefficients of each term stand."""
        return _stretches([self.columns(term)[1].shape[1] for term in self.terms])

    def solve(self) -> JointFit:
        """The best coefficients where the inner parameters are, with their covariance."""
        solution, places = self._solution(), self._stretches()
        signatures = [self.columns(term)[0] for term in self.terms]
        coefficients = tuple(solution[own] for own in places)
        tangents = [
            self._tangents(term, own) for term, own in zip(self.terms, coefficients, strict=True)
        ]
        return JointFit(
            terms=self.terms,
            coefficients=coefficients,
            covariance=self._covariance(places, tangents),
            signatures_mm=tuple(signatures),
            tangents_mm=tuple(tangents),
            whiten=self.whiten,
        )

    def _tangents(self, term: Term, coefficients: np.ndarray) -> np.ndarray:
        """Change of a fitted term with each of its free inner logarithms, (n, own I) mm."""
        here = self.columns(term)[0]
        slopes = [np.zeros((len(here), 0))]
        for unit in np.eye(len(term.free_parameters)):
            near = self.survey.signature(term.effect, term.target, term.inner_at(_STEP * unit))
            slopes.append(((near - here) @ coefficients / _STEP)[:, None])
        return np.hstack(slopes)

    def _covariance(
        self, places: Sequence[slice], tangents: Sequence[np.ndarray]
    ) -> tuple[np.ndarray, ...]:
        """Covariance of every term's own coefficients and inner parameters, all free at once.

        Parameters
        ----------
        places : sequence of slice
            Where among the K the coefficients of each term stand.
        tangents : sequence of (n, own I) float64
        """
        slope = self.whiten(np.hstack(tangents))
        spreads = np.concatenate([term.spread_of_inner for term in self.terms])
        shared, held = self._rows().T @ slope, np.diag(spreads**-2.0)
        precision = np.block([[self._precision(), shared], [shared.T, slope.T @ slope + held]])
        covariance = np.linalg.pinv(precision, hermitian=True)
        inner = _stretches([t.shape[1] for t in tangents], start=len(shared))
        number = np.arange(len(covariance))
        own = [np.concatenate([number[c], number[i]]) for c, i in zip(places, inner, strict=True)]
        return tuple(covariance[np.ix_(k, k)] for k in own)


def _stretches(counts: Sequence[int], *, start: int = 0) -> list[slice]:
    """Stretches of so many each, one behind the other."""
    ends = np.cumsum([start, *counts]).tolist()
    return [slice(*both) for both in itertools.pairwise(ends)]
