"""Search for the set of effects that explains the measurements.

Candidates are weighed by their evidence on what the effects before them left, absorbed, and
refitted together. Several sets are followed side by side, so that a pair of effects that mask
each other is found even where neither leads alone.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property

import numpy as np

from vmach.diagnosis.absorbing import absorbing
from vmach.diagnosis.explanation import Explanation, may_beat, simplest_of_the_best
from vmach.diagnosis.impossible_sizes import has_impossible_sizes
from vmach.diagnosis.score import evidence_of_set
from vmach.diagnosis.structure import Structure
from vmach.effects import Effect
from vmach.fit.candidates import Candidate
from vmach.fit.evidence import WIDTHS, SignatureBank
from vmach.fit.joint_fit import fit_terms
from vmach.fit.survey import Survey
from vmach.fit.terms import JointFit, Term
from vmach.fit.whitening import Whitening

__all__ = ["Search"]

#: sets followed side by side, and candidates tried on a set of so many effects
_BEAM, _TRIED = 3, (5, 4, 2)
_MOST_EFFECTS = 3
#: times that an effect of the set found may be exchanged for another
_EXCHANGES = 2
#: share of the best candidate's evidence that makes another worth following
_WORTH_TRYING = 0.25
#: an effect whose law leaves no more open than this share ends the search when it explains all
_STIFF = 0.05
_SIMULATIONS = 200
#: log prior odds of a component that the machine file has no table of: it is there, unmeasured
_MISSING_TABLE = 4.0
#: chance of naming something on clean data
_FALSE_ALARM = 0.002


class Search:
    """The search over one survey's candidates.

    Parameters
    ----------
    survey : Survey
    candidates : sequence of Candidate
    whiten : Whitening
        Of the survey.
    excluded : sequence of (Effect, target, why)
        What the survey cannot show.
    seed : int
        Of the simulated clean data that calibrate the threshold.
    """

    def __init__(
        self,
        survey: Survey,
        candidates: Sequence[Candidate],
        whiten: Whitening,
        *,
        excluded: Sequence[tuple[Effect, str, str]] = (),
        seed: int = 1,
    ) -> None:
        self.survey, self.candidates, self.whiten = survey, list(candidates), whiten
        self.excluded = tuple(excluded)
        self.bank = SignatureBank(
            [whiten(c.signatures_mm) for c in self.candidates],
            [c.log_prior for c in self.candidates],
        )
        self._reading = whiten(survey.residual_mm)
        self._seed = seed
        self._known_without: dict[tuple, Explanation] = {}

    @property
    def effects(self) -> list[Effect]:
        """The effects that the search was asked about."""
        both = [*(c.effect for c in self.candidates), *(e for e, _, _ in self.excluded)]
        return list({effect.name: effect for effect in both}.values())

    def on(self, survey: Survey) -> Search:
        """The same search over other readings of the same design, nothing worked out twice."""
        other = copy.copy(self)
        other.__dict__.pop("nothing", None)
        other._known_without = {}
        other.survey, other._reading = survey, self.whiten(survey.residual_mm)
        return other

    @cached_property
    def structure(self) -> Structure:
        """The gate that an explanation has to pass."""
        return Structure(self.survey, self.whiten)

    @cached_property
    def nothing(self) -> Explanation:
        """The empty set."""
        return self.explanation_of(None)

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

    def log_prior(self, candidate: Candidate) -> float:
        """Prior odds of a candidate; a component without a table is expected to be missing."""
        if candidate.label in self.missing_tables:
            return _MISSING_TABLE
        return -candidate.effect.rarity

    @cached_property
    def missing_tables(self) -> frozenset[str]:
        """Components that the machine file has no table of."""
        tables = self.survey.job.machine.components
        components = [c for c in self.candidates if c.effect.name == "component"]
        return frozenset(c.label for c in components if c.target not in tables)

    def candidate(self, label: str) -> Candidate:
        """The candidate with a given name and target."""
        return next(c for c in self.candidates if c.label == label)

    def run(self) -> Explanation:
        """The best set of effects, every one of them above the threshold given the others."""
        beam, finished = [self.nothing], []
        seen = [self.nothing]
        for _ in range(_MOST_EFFECTS):
            grown: dict[frozenset[str], Explanation] = {}
            for explanation in beam:
                has = explanation.labels
                for child in self._children(explanation, tried=_TRIED[len(has)], but=has):
                    known = grown.get(child.labels)
                    if known is None or child.score > known.score:
                        grown[child.labels] = child
            seen += grown.values()
            finished += [e for e in (*beam, *grown.values()) if self.further(e) == 0.0]
            beam = [e for e in grown.values() if self.further(e) > 0.0 and may_beat(e, finished)]
            beam = sorted(beam, key=lambda e: -e.score - self.further(e))[:_BEAM]
            if not beam:
                break
        return self._without_needless(self._exchanged(self._simplest(finished or seen)))

    def _exchanged(self, explanation: Explanation) -> Explanation:
        """With single effects replaced, as long as others do better beside those that stay."""
        for _ in range(_EXCHANGES if len(explanation.labels) > 1 else 0):
            assert explanation.fit is not None
            seen = [explanation]
            for k in range(len(explanation.fit.terms)):
                others = self.without(explanation, [k])
                seen += self._children(others, tried=_TRIED[-1], but=explanation.labels)
            best = self._simplest([e for e in seen if self.further(e) == 0.0] or seen)
            if best is explanation:
                break
            explanation = best
        return explanation

    def _simplest(self, explanations: Sequence[Explanation]) -> Explanation:
        return simplest_of_the_best(explanations, self.missing_tables)

    def further(self, explanation: Explanation) -> float:
        """Evidence of the best candidate on what an explanation leaves, if above threshold."""
        gains = zip(self.gains(explanation), self.candidates, strict=True)
        best = max(gain for gain, c in gains if c.label not in explanation.labels)
        return best if best > self.threshold else 0.0

    def gains(self, explanation: Explanation) -> list[float]:
        """Evidence of every candidate on what an explanation leaves, prior odds included."""
        return [
            float(e.log_factor[0]) + self.log_prior(c)
            for e, c in zip(explanation.evidence, self.candidates, strict=True)
        ]

    def _children(
        self, explanation: Explanation, *, tried: int, but: frozenset[str]
    ) -> Iterator[Explanation]:
        """The explanation with each of the leading candidates `but` some, until one explains all.

        An effect whose law leaves much open ends nothing: it may only imitate stiffer ones.
        """
        gains = self.gains(explanation)
        least = max(self.threshold, _WORTH_TRYING * max(gains))
        leading = [k for k in np.argsort(gains)[::-1][:tried] if gains[k] > least]
        leading = [k for k in leading if self.candidates[k].label not in but]
        for k in leading:
            child = self.extend(explanation, k)
            if child.fit is not None and has_impossible_sizes(child.fit):
                continue
            yield child
            effect = self.candidates[k].effect
            is_loose = effect.is_flexible or effect.is_slow or effect.slack_share > _STIFF
            if not is_loose and self.further(child) == 0.0:
                return

    def extend(self, explanation: Explanation, k: int) -> Explanation:
        """The explanation with candidate k added and everything refitted."""
        terms = [] if explanation.fit is None else list(explanation.fit.terms)
        return self.explain([*terms, self.term(k, explanation)])

    def term(self, k: int, explanation: Explanation) -> Term:
        """Candidate k with its best inner parameters on what an explanation leaves."""
        candidate, evidence = self.candidates[k], explanation.evidence[k]
        place = int(evidence.best[0])
        width = None
        if not candidate.effect.amplitudes:
            width = WIDTHS[int(evidence.best_width[0])]
        return Term(candidate.effect, candidate.target, candidate.grid[place], width)

    def explain(self, terms: Sequence[Term]) -> Explanation:
        """The explanation by given terms."""
        return self.explanation_of(fit_terms(self.survey, terms, self.whiten) if terms else None)

    def explanation_of(self, fit: JointFit | None) -> Explanation:
        """The explanation by a fit; None for the empty set."""
        absorb = None if fit is None else absorbing(self.survey, self.whiten, fit)
        evidence = tuple(self.bank.evidence(self._reading[:, None], absorb))
        if fit is None or absorb is None:
            return Explanation(None, 0.0, evidence, self._reading, self.whiten.degrees)
        degrees = absorb.degrees - (len(self.survey) - self.whiten.degrees)
        return Explanation(fit, self._score(fit), evidence, absorb(self._reading), degrees)

    def _score(self, fit: JointFit) -> float:
        """Log evidence of a set against nothing: whichever of all candidates they might be."""
        usual = sum(self.log_prior(self.candidate(term.label)) for term in fit.terms)
        odds = usual - len(fit.terms) * np.log(len(self.candidates))
        return odds + evidence_of_set(self.survey, self.whiten, fit)

    def absorber(self, explanation: Explanation) -> Callable[[np.ndarray], np.ndarray]:
        """What takes an explanation out of whitened readings or signatures."""
        return (
            absorbing(self.survey, self.whiten, explanation.fit)
            if explanation.fit
            else lambda white: white
        )

    def left_in(self, explanation: Explanation) -> dict[str, float]:
        """What an explanation leaves beyond noise, by kind of pattern; empty where it is noise."""
        fit = explanation.fit
        absorb = absorbing(self.survey, self.whiten, fit) if fit else None
        left = self.structure.left_in(self._reading, explanation.degrees, absorb=absorb)
        if (further := self.further(explanation)) > 0.0:
            left["further effects"] = further
        return left

    def _without_needless(self, explanation: Explanation) -> Explanation:
        """Drop effects, the weakest first, that the others make needless."""
        while explanation.fit is not None:
            gains = [self.gain_of(explanation, k) for k in range(len(explanation.fit.terms))]
            weakest = int(np.argmin(gains))
            if gains[weakest] > self.threshold:
                break
            terms = [t for k, t in enumerate(explanation.fit.terms) if k != weakest]
            explanation = self.explain(terms)
        return explanation

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

    def gain_of(self, explanation: Explanation, k: int) -> float:
        """Evidence for term k of an explanation, given its other terms."""
        assert explanation.fit is not None
        term = explanation.fit.terms[k]
        others = self.without(explanation, [k])
        place = self.candidates.index(self.candidate(term.label))
        return self.gains(others)[place]

    def without(self, explanation: Explanation, ks: Sequence[int]) -> Explanation:
        """The explanation without some of its terms; the others keep their inner parameters."""
        assert explanation.fit is not None
        terms = [t for i, t in enumerate(explanation.fit.terms) if i not in ks]
        if not terms:
            return self.nothing
        key = tuple((t.label, t.width, *t.inner.items()) for t in terms)
        if key not in self._known_without:
            fit = fit_terms(self.survey, terms, self.whiten, refine=False)
            self._known_without[key] = self.explanation_of(fit)
        return self._known_without[key]
