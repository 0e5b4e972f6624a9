"""Effects weighed on a survey's readings: every candidate by its evidence, sets of them fitted."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Self

import numpy as np

from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.gates.absorbing import absorbing
from vmach.diagnosis.residuals.structure import Structure
from vmach.diagnosis.score import evidence_of_set
from vmach.effects import Effect
from vmach.fit.candidates import Candidate
from vmach.fit.evidence import WIDTHS, SignatureBank
from vmach.fit.joint_fit import fit_terms
from vmach.fit.survey import Survey
from vmach.fit.terms import JointFit, Term
from vmach.fit.whitening import Whitening

__all__ = ["Weighing"]

_SIMULATIONS = 200
#: log prior odds of a component that the machine file has no table of: it is there, unmeasured
_MISSING_TABLE = 4.0
#: chance of naming something on clean data
_FALSE_ALARM = 0.002


class Weighing:
    """The candidates of one survey, weighed alone and in sets.

    Parameters
    ----------
    survey : Survey
    candidates : sequence of Candidate
    excluded : sequence of (Effect, target, why)
        What the survey cannot show.
    seed : int
        Of the simulated clean data that calibrate the threshold.

    Attributes
    ----------
    whiten : Whitening
        Of all readings of this design.
    bank : SignatureBank
        Of the candidates, in their order.
    nothing : Explanation
        The empty set.
    """

    def __init__(
        self,
        survey: Survey,
        candidates: Sequence[Candidate],
        *,
        excluded: Sequence[tuple[Effect, str, str]] = (),
        seed: int = 1,
    ) -> None:
        self.candidates, self.whiten = list(candidates), survey.whiten
        self.excluded, self._seed = tuple(excluded), seed
        self.bank = SignatureBank(
            [self.whiten(c.signatures_mm) for c in self.candidates],
            [c.log_prior for c in self.candidates],
        )
        self._read(survey)

    def _read(self, survey: Survey) -> None:
        """Take the readings of a survey of this design; all that depends on others goes."""
        self.survey = survey
        self._reading = self.whiten(survey.residual_mm)
        self.nothing = self.explanation_of(None)
        # rivals, offsets and slack ask for the same sets again
        self._known_without: dict[tuple, Explanation] = {}

    def on(self, survey: Survey) -> Self:
        """The same over other readings of the same design, nothing worked out twice."""
        other = copy.copy(self)
        other._read(survey)
        return other

    def on_part(self, survey: Survey, rows: np.ndarray) -> Self:
        """The same over a part of the survey, its `rows` (n,) bool; their signatures stay."""
        candidates = [replace(c, signatures_mm=c.signatures_mm[rows]) for c in self.candidates]
        return type(self)(survey, candidates, excluded=self.excluded, seed=self._seed)

    # what the design of the survey allows ------------------------------------------------------

    @cached_property
    def structure(self) -> Structure:
        """The gate that an explanation has to pass."""
        return Structure(self.survey, self.whiten)

    @cached_property
    def threshold(self) -> float:
        """Log evidence that clean data exceed with the chance of a false alarm.

        The largest evidence over all candidates on simulated clean data falls off at least as
        fast as exp(-x); from its 90 % point on this bound is used.
        """
        random = np.random.default_rng(self._seed)
        noise = self.whiten.projected(random.standard_normal((len(self.survey), _SIMULATIONS)))
        found = zip(self.bank.evidence(noise), self.candidates, strict=True)
        largest = np.max([e.log_factor + self.log_prior(c) for e, c in found], axis=0)
        return float(np.quantile(largest, 0.9) + np.log(0.1 / _FALSE_ALARM))

    @cached_property
    def missing_tables(self) -> frozenset[str]:
        """Labels of components that the machine file has no table of."""
        tables = self.survey.job.machine.components
        components = [c for c in self.candidates if c.effect.corrects_table]
        return frozenset(c.label for c in components if c.target not in tables)

    def log_prior(self, candidate: Candidate) -> float:
        """Prior odds of a candidate; a component without a table is expected to be missing."""
        if candidate.label in self.missing_tables:
            return _MISSING_TABLE
        return -candidate.effect.rarity

    def index_of(self, label: str) -> int:
        """Which candidate has a given name and target."""
        return next(k for k, c in enumerate(self.candidates) if c.label == label)

    # sets, fitted -----------------------------------------------------------------------------

    def explanation_of(self, fit: JointFit | None) -> Explanation:
        """The explanation by a fit; None for the empty set."""
        reading = self._reading
        if fit is None:
            evidence = self.bank.evidence(reading[:, None])
            return Explanation(None, 0.0, tuple(evidence), reading, self.whiten.degrees)
        absorb = absorbing(self.survey, self.whiten, fit)
        evidence = self.bank.evidence(reading[:, None], absorb)
        degrees = absorb.degrees - (len(self.survey) - self.whiten.degrees)
        return Explanation(fit, self._score(fit), tuple(evidence), absorb(reading), degrees)

    def _score(self, fit: JointFit) -> float:
        """Log evidence of a set against nothing: whichever of all candidates they might be."""
        members = [self.candidates[self.index_of(term.label)] for term in fit.terms]
        usual = sum(self.log_prior(candidate) for candidate in members)
        odds = usual - len(fit.terms) * np.log(len(self.candidates))
        return odds + evidence_of_set(self.survey, self.whiten, fit)

    def explain(self, terms: Sequence[Term], *, refine: bool = True) -> Explanation:
        """The explanation by given terms; `refine` lets their inner parameters move."""
        if not terms:
            return self.explanation_of(None)
        return self.explanation_of(fit_terms(self.survey, terms, self.whiten, refine=refine))

    def extend(self, explanation: Explanation, k: int) -> Explanation:
        """The explanation with candidate k added and everything refitted."""
        return self.explain([*explanation.terms, self.term(k, explanation)])

    def without(self, explanation: Explanation, ks: Sequence[int]) -> Explanation:
        """The explanation without some of its terms; the others keep their inner parameters."""
        left = [term for k, term in enumerate(explanation.terms) if k not in ks]
        if not left:
            return self.nothing
        key = tuple((term.label, term.width, *term.inner.items()) for term in left)
        if key not in self._known_without:
            self._known_without[key] = self.explain(left, refine=False)
        return self._known_without[key]

    def term(self, k: int, explanation: Explanation) -> Term:
        """Candidate k with its best inner parameters on what an explanation leaves."""
        candidate, evidence = self.candidates[k], explanation.evidence[k]
        place = int(evidence.best[0])
        width = None
        if not candidate.effect.amplitudes:
            width = WIDTHS[int(evidence.best_width[0])]
        return Term(candidate.effect, candidate.target, candidate.grid[place], width)

    # candidates, weighed ----------------------------------------------------------------------

    def gains(self, explanation: Explanation) -> list[float]:
        """Evidence of every candidate on what an explanation leaves, prior odds included."""
        return [
            float(e.log_factor[0]) + self.log_prior(c)
            for e, c in zip(explanation.evidence, self.candidates, strict=True)
        ]

    def gain_of(self, explanation: Explanation, k: int) -> float:
        """Evidence for term k of an explanation, given its other terms."""
        place = self.index_of(explanation.terms[k].label)
        return self.gains(self.without(explanation, [k]))[place]

    def further(self, explanation: Explanation) -> float:
        """Evidence of the best candidate on what an explanation leaves; 0 below the threshold."""
        gains = zip(self.gains(explanation), self.candidates, strict=True)
        best = max(gain for gain, c in gains if c.label not in explanation.labels)
        return best if best > self.threshold else 0.0

    def alone(self, k: int) -> tuple[Term, np.ndarray]:
        """Candidate k fitted alone, at a place of its grid: the term and its coefficients (K,)."""
        evidence = self.nothing.evidence[k]
        place, width = int(evidence.best[0]), int(evidence.best_width[0])
        white = self.bank.columns(k)[:, place]
        prior = np.eye(white.shape[1]) / WIDTHS[width] ** 2
        amount = np.linalg.solve(white.T @ white + prior, white.T @ self._reading)
        return self.term(k, self.nothing), amount

    def alone_mm(self, k: int) -> np.ndarray:
        """What candidate k does to the readings when it is fitted alone, (n,) mm."""
        place = int(self.nothing.evidence[k].best[0])
        return self.candidates[k].signatures_mm[:, place] @ self.alone(k)[1]

    # what is left -----------------------------------------------------------------------------

    def absorber(self, explanation: Explanation) -> Callable[[np.ndarray], np.ndarray]:
        """What takes an explanation out of whitened readings or signatures."""
        return self._absorbing(explanation) or (lambda white: white)

    def _absorbing(self, explanation: Explanation) -> Whitening | None:
        fit = explanation.fit
        return None if fit is None else absorbing(self.survey, self.whiten, fit)

    def left_in(self, explanation: Explanation) -> dict[str, float]:
        """What an explanation leaves beyond noise, by kind of pattern; empty where it is noise."""
        absorb = self._absorbing(explanation)
        left = self.structure.left_in(self._reading, explanation.degrees, absorb=absorb)
        if (further := self.further(explanation)) > 0.0:
            left["further effects"] = further
        return left
