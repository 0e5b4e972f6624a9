"""Joint fit of several effects: amplitudes by generalised least squares, inner parameters around.

The amplitudes are eliminated at every step (variable projection); a component's correction curve
is held by its smoothness prior, everything else is free. Only products of columns enter; what
counts as noise beside the effects, and what alignment and zeros leave free, is in them.

Source: G. Golub and V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413 (variable projection); its
curvature without second derivatives, as L. Kaufman, BIT 15 (1975) 49.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vmach.fit.columns import Columns
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.terms import FREE, JointFit, Term

__all__ = ["fit_terms", "taken_off"]

#: step of logarithms in a derivative
_STEP = 1e-5
#: steps at most, none longer than this; lengths that are tried of each
_STEPS, _STRIDE, _LENGTHS = 12, 1.5, (1.0, 0.25, 0.06)
#: half the sum of squares that a further step has to promise
_GAIN = 1e-4


def fit_terms(posterior: Posterior, terms: Sequence[Term], *, refine: bool = True) -> JointFit:
    """Fit terms to the readings of a survey.

    Parameters
    ----------
    posterior : Posterior
        Of what counts as noise beside them.
    terms : sequence of Term
        With starting values.
    refine : bool
        Whether inner parameters move from their starting values.
    """
    problem = _Problem(posterior, tuple(terms))
    if refine:
        problem = problem.at_best_places()
        if len(problem.logarithms):
            problem = problem.refined()
    return problem.solve()


@dataclass(frozen=True)
class _Problem:
    """The fit at given inner parameters; I of them, in all, are free to move.

    Attributes
    ----------
    posterior : Posterior
    terms : tuple of Term
        Their coefficients are K in all.
    """

    posterior: Posterior
    terms: tuple[Term, ...]

    @cached_property
    def logarithms(self) -> np.ndarray:
        """Where the free inner parameters are, (I,)."""
        values = [term.inner[name] for term in self.terms for name in term.free_inner]
        return np.log(np.maximum(values, 1e-9)) if values else np.zeros(0)

    def refined(self) -> _Problem:
        """The problem at the inner parameters that fit best."""
        ends = [(p.low, p.high) for term in self.terms for p in term.free_parameters]
        low, high = np.log(ends).T
        here = self.at(np.clip(self.logarithms, low, high))
        for _ in range(_STEPS):
            better = here._stepped(low, high)
            if better is None:
                break
            here = better
        return here

    def _stepped(self, low: np.ndarray, high: np.ndarray) -> _Problem | None:
        """The problem one step on between bounds (I,), or None where none gains anything."""
        slope, curvature = self._slope_and_curvature()
        place = self.logarithms
        is_free = ~(((place <= low) & (slope > 0.0)) | ((place >= high) & (slope < 0.0)))
        step = np.zeros(len(slope))
        step[is_free] = -np.linalg.solve(curvature[is_free][:, is_free], slope[is_free])
        step = np.clip(step, -_STRIDE, _STRIDE)
        for length in _LENGTHS:
            aim = np.clip(place + length * step, low, high)
            if slope @ (place - aim) < 2.0 * _GAIN:
                break
            trial = self.at(aim)
            if trial._cost < self._cost:
                return trial
        return None

    def at(self, logarithms: np.ndarray) -> _Problem:
        """The problem with its free inner parameters at given logarithms, (I,)."""
        places = _stretches([len(term.free_parameters) for term in self.terms])
        moved = []
        for term, own in zip(self.terms, places, strict=True):
            values = np.exp(logarithms[own]).tolist()
            update = dict(zip(term.free_inner, values, strict=True))
            moved.append(replace(term, inner={**term.inner, **update}))
        return _Problem(self.posterior, tuple(moved))

    def at_best_places(self) -> _Problem:
        """Terms that have places to choose among at the best of them, given the others."""
        terms, survey = self.terms, self.posterior.base.survey
        for k, term in enumerate(self.terms):
            places, log_prior = survey.places(term.effect, term.target, term.inner)
            if places:
                others = _Problem(self.posterior, (*terms[:k], *terms[k + 1 :]))
                gains = others.gains_of(term, places) + log_prior
                moved = replace(term, inner=places[int(np.argmax(gains))])
                terms = (*terms[:k], moved, *terms[k + 1 :])
        return _Problem(self.posterior, terms)

    def gains_of(self, term: Term, places: Sequence[Mapping[str, float]]) -> np.ndarray:
        """Half of what a further term at each of some places (G,) takes off the sum of squares."""
        beside = self._as_noise
        gram, seen = beside.products_at(beside.base.places(term.effect, term.target, places))
        gram += np.eye(gram.shape[1]) / FREE**2
        return taken_off(gram, seen, np.array([p.is_size for p in term.effect.amplitudes]))

    @property
    def _as_noise(self) -> Posterior:
        """What counts as noise, the terms with it."""
        here = self.posterior
        columns = here.effects.columns.beside(self._columns.scaled(self._widths))
        return Posterior(here.base, here.sizes, Effects(columns))

    @cached_property
    def _signatures(self) -> list[Columns]:
        return self._at([term.inner for term in self.terms], self.terms)

    def _at(self, inner: Sequence[Mapping[str, float]], terms: Sequence[Term]) -> list[Columns]:
        """Signatures of terms with inner parameters."""
        asked = [(t.effect, t.target, own) for t, own in zip(terms, inner, strict=True)]
        return self.posterior.base.signatures(asked)

    @cached_property
    def _columns(self) -> Columns:
        """Signatures of all terms."""
        none = self.posterior.base.no_columns
        return Columns.joined([none, *self._signatures])

    @cached_property
    def _widths(self) -> np.ndarray:
        """Prior standard deviation of every coefficient, (K,)."""
        counts = [len(columns) for columns in self._signatures]
        return np.repeat([term.prior_width for term in self.terms], counts)

    @cached_property
    def _normal(self) -> tuple[np.ndarray, np.ndarray]:
        """Precision of all coefficients, from readings and priors, (K, K), and their aim (K,)."""
        gram, seen = self.posterior.products(self._columns)
        return gram + np.diag(self._widths**-2.0), seen

    @cached_property
    def _solution(self) -> np.ndarray:
        """The most probable coefficients, (K,)."""
        return np.linalg.solve(*self._normal)

    @cached_property
    def _cost(self) -> float:
        """Half the sum of squares that is left, priors with it, up to a constant."""
        unusual = sum(float(term.unusual @ term.unusual) for term in self.terms)
        return 0.5 * (unusual - float(self._normal[1] @ self._solution))

    @property
    def _stretches(self) -> list[slice]:
        """Where among the K the coefficients of each term stand."""
        return _stretches([len(columns) for columns in self._signatures])

    @cached_property
    def _tangents(self) -> list[Columns]:
        """Change of each fitted term with each of its free inner logarithms, own I."""
        steps = [
            (term, term.inner_at(_STEP * unit))
            for term in self.terms
            for unit in np.eye(len(term.free_parameters))
        ]
        near = iter(self._at([inner for _, inner in steps], [term for term, _ in steps]))
        found = []
        for term, here, own in zip(self.terms, self._signatures, self._stretches, strict=True):
            weight = np.concatenate([self._solution[own], -self._solution[own]])[:, None] / _STEP
            moved = itertools.islice(near, len(term.free_parameters))
            slopes = [Columns.joined([one, here]).times(weight) for one in moved]
            found.append(Columns.joined([self.posterior.base.no_columns, *slopes]))
        return found

    @cached_property
    def _open(self) -> Columns:
        """Signatures and tangents of all terms."""
        return self._columns.beside(Columns.joined(self._tangents))

    @cached_property
    def _whole(self) -> tuple[np.ndarray, np.ndarray]:
        """Precision of coefficients and inner logarithms together, with their aim, (K + I,)."""
        gram, seen = self.posterior.products(self._open)
        spreads = [term.spread_of_inner for term in self.terms]
        widths = np.concatenate([self._widths, *spreads])
        return gram + np.diag(widths**-2.0), seen

    def _slope_and_curvature(self) -> tuple[np.ndarray, np.ndarray]:
        """Of the cost by the logarithms, (I,) and (I, I), the coefficients always the best."""
        whole, seen = self._whole
        count = len(self._solution)
        shared = whole[:count, count:]
        unusual = [term.unusual / term.spread_of_inner for term in self.terms]
        slope = shared.T @ self._solution - seen[count:] + np.concatenate(unusual)
        weight = np.linalg.solve(whole[:count, :count], shared)
        return slope, whole[count:, count:] - shared.T @ weight

    def solve(self) -> JointFit:
        """The best coefficients where the inner parameters are, with their covariance."""
        tangents, places = self._tangents, self._stretches
        covariance = np.linalg.pinv(self._whole[0], hermitian=True)
        inner = _stretches([len(t) for t in tangents], start=len(self._solution))
        number = np.arange(len(covariance))
        own = [np.concatenate([number[c], number[i]]) for c, i in zip(places, inner, strict=True)]
        return JointFit(
            terms=self.terms,
            coefficients=tuple(self._solution[k] for k in places),
            joint_covariance=covariance,
            places=tuple(own),
            signatures=tuple(self._signatures),
            tangents=tuple(tangents),
            open=self._open,
            posterior=self.posterior,
        )


def _stretches(counts: Sequence[int], *, start: int = 0) -> list[slice]:
    """Stretches of so many each, one behind the other."""
    ends = np.cumsum([start, *counts]).tolist()
    return [slice(*both) for both in itertools.pairwise(ends)]


def taken_off(gram: np.ndarray, seen: np.ndarray, is_size: np.ndarray) -> np.ndarray:
    """Half of what K coefficients at each of G places take off a sum of squares, (G,).

    Those that are sizes stay at zero where they would go below: exact for one and two.

    Parameters
    ----------
    gram : (G, K, K) float64
        Products of the signatures with each other, with the precision of the prior.
    seen : (G, K) float64
        With the readings.
    is_size : (K,) bool
    """
    stays = np.ones(seen.shape, dtype=bool)
    while True:
        both, aim = stays[:, :, None] & stays[:, None, :], np.where(stays, seen, 0.0)
        amount = np.linalg.solve(np.where(both, gram, np.eye(len(is_size))), aim[:, :, None])
        below = is_size & (amount[:, :, 0] < 0.0)
        if not below.any():
            return 0.5 * (aim * amount[:, :, 0]).sum(axis=1)
        stays &= ~below
