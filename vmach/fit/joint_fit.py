"""Joint fit of several effects: amplitudes by generalised least squares, inner parameters around.

The amplitudes are eliminated at every step (variable projection); a component's correction curve
is held by its smoothness prior, everything else is free. What the whitening left free, alignment
and zeros, is fitted at the same time.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from vmach.fit.survey import Survey
from vmach.fit.terms import FREE, JointFit, Term
from vmach.fit.whitening import Whitening, orthonormal

__all__ = ["fit_terms"]

_STEP = 1e-3


def fit_terms(
    survey: Survey,
    terms: Sequence[Term],
    whiten: Whitening | Callable[[np.ndarray], np.ndarray],
    *,
    refine: bool = True,
) -> JointFit:
    """Fit terms to the readings of a survey.

    Parameters
    ----------
    survey : Survey
    terms : sequence of Term
        With starting values.
    whiten : Whitening
        Of the survey's readings.
    refine : bool
        Whether inner parameters move from their starting values.
    """
    problem = _Problem(survey, tuple(terms), whiten)
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


class _Problem:
    """The fit as a function of the logarithms of all free inner parameters."""

    def __init__(self, survey: Survey, terms: tuple[Term, ...], whiten) -> None:
        self.survey, self.terms, self.whiten = survey, terms, whiten
        self.target = whiten(survey.residual_mm)
        self._cache: dict[tuple, tuple[np.ndarray, np.ndarray]] = {}

    def logarithms(self) -> np.ndarray:
        values = [term.inner[name] for term in self.terms for name in term.free_inner]
        return np.log(np.maximum(values, 1e-9)) if values else np.zeros(0)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        ends = []
        for term in self.terms:
            by_name = {p.name: p for p in term.effect.inner_parameters}
            ends += [(by_name[n].low, by_name[n].high) for n in term.free_inner]
        low, high = np.log(np.array(ends)).T
        return low - 1e-9, high + 1e-9

    def at(self, logarithms: np.ndarray) -> _Problem:
        moved, first = [], 0
        for term in self.terms:
            names = term.free_inner
            values = np.exp(logarithms[first : first + len(names)])
            first += len(names)
            update = dict(zip(names, values.tolist(), strict=True))
            moved.append(replace(term, inner={**term.inner, **update}))
        return self._of(moved)

    def _of(self, terms: Sequence[Term]) -> _Problem:
        """The same problem with other terms."""
        other = copy.copy(self)
        other.terms = tuple(terms)
        return other

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
        rows, target = self._system()
        basis = orthonormal(rows)
        target = target - basis @ (basis.T @ target)
        gains = []
        for inner in places:
            columns = self.columns(replace(term, inner=inner))[1]
            columns = np.vstack([columns, np.zeros((len(rows) - len(columns), columns.shape[1]))])
            columns = columns - basis @ (basis.T @ columns)
            precision = columns.T @ columns + np.eye(columns.shape[1]) / FREE**2
            seen = columns.T @ target
            gains.append(0.5 * seen @ np.linalg.solve(precision, seen))
        return np.array(gains)

    def prior_residual(self) -> np.ndarray:
        rows = []
        for term in self.terms:
            by_name = {p.name: p for p in term.effect.inner_parameters}
            for name in term.free_inner:
                p = by_name[name]
                rows.append(np.log(term.inner[name] / p.usual) / p.spread)
        return np.array(rows)

    def columns(self, term: Term) -> tuple[np.ndarray, np.ndarray]:
        """Signatures in mm and whitened."""
        key = (term.label, *term.inner.values())
        if key not in self._cache:
            raw = self.survey.signature(term.effect, term.target, term.inner)
            self._cache[key] = raw, self.whiten(raw)
        return self._cache[key]

    def _system(self) -> tuple[np.ndarray, np.ndarray]:
        white = [np.zeros((len(self.target), 0)), *(self.columns(t)[1] for t in self.terms)]
        pairs = zip(self.terms, white[1:], strict=True)
        widths = np.concatenate([[], *(np.full(w.shape[1], t.width or FREE) for t, w in pairs)])
        rows = np.vstack([np.hstack(white), np.diag(1.0 / widths)])
        return rows, np.concatenate([self.target, np.zeros(len(widths))])

    def residual(self, logarithms: np.ndarray) -> np.ndarray:
        here = self.at(logarithms)
        rows, target = here._system()
        solution = np.linalg.lstsq(rows, target, rcond=None)[0]
        return np.concatenate([target - rows @ solution, here.prior_residual()])

    def solve(self) -> JointFit:
        rows, target = self._system()
        solution = np.linalg.lstsq(rows, target, rcond=None)[0]
        raw = [self.columns(term)[0] for term in self.terms]
        ends = np.cumsum([r.shape[1] for r in raw])
        coefficients = np.split(solution, ends[:-1])
        tangents = [
            self._tangents(term, c) for term, c in zip(self.terms, coefficients, strict=True)
        ]
        return JointFit(
            terms=self.terms,
            coefficients=tuple(coefficients),
            covariance=self._covariance(rows, raw, tangents),
            signatures_mm=tuple(raw),
            tangents_mm=tuple(tangents),
            whiten=self.whiten,
        )

    def _tangents(self, term: Term, coefficients: np.ndarray) -> np.ndarray:
        here = self.columns(term)[0]
        slopes = [np.zeros((len(here), 0))]
        for name in term.free_inner:
            moved = {**term.inner, name: term.inner[name] * np.exp(_STEP)}
            near = self.survey.signature(term.effect, term.target, moved)
            slopes.append(((near - here) @ coefficients / _STEP)[:, None])
        return np.hstack(slopes)

    def _covariance(self, rows, raw, tangents) -> tuple[np.ndarray, ...]:
        """Covariance of every term's own coefficients and inner parameters, all free at once."""
        slope = np.hstack([self.whiten(t) for t in tangents])
        spreads = []
        for term in self.terms:
            by_name = {p.name: p.spread for p in term.effect.inner_parameters}
            spreads += [by_name[name] for name in term.free_inner]
        padded = np.vstack([slope, np.zeros((len(rows) - len(slope), slope.shape[1]))])
        prior = np.hstack(
            [
                np.zeros((len(spreads), rows.shape[1])),
                np.diag(1.0 / np.array(spreads)) if spreads else np.zeros((0, 0)),
            ]
        )
        full = np.vstack([np.hstack([rows, padded]), prior])
        covariance = np.linalg.pinv(full.T @ full)
        parts, first, first_inner = [], 0, rows.shape[1]
        for r, t in zip(raw, tangents, strict=True):
            own = [*range(first, first + r.shape[1]), *range(first_inner, first_inner + t.shape[1])]
            parts.append(covariance[np.ix_(own, own)])
            first += r.shape[1]
            first_inner += t.shape[1]
        return tuple(parts)
