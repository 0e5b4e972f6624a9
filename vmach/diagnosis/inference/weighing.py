"""Sets of effects weighed beside the discrepancy: each by the probability of all readings."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from vmach.base.memory import give_back_free_memory
from vmach.diagnosis.gates.absorbing import stated_slack
from vmach.diagnosis.gates.parameters_in_bounds import log_factor_of_bounds
from vmach.diagnosis.inference.bank import Bank
from vmach.diagnosis.inference.careful_fit import careful_fit
from vmach.diagnosis.inference.priors import Priors, log_odds_of, log_probability_of_count
from vmach.effects import Effect
from vmach.fit.base import Base
from vmach.fit.candidates import Candidate
from vmach.fit.columns import Columns
from vmach.fit.deletion_residuals import deletion_residuals
from vmach.fit.evidence import WIDTHS, Evidence, width_of
from vmach.fit.joint_fit import fit_terms
from vmach.fit.marginal_likelihood import Effects, Posterior, best_sizes
from vmach.fit.noise.discrepancy import members_of
from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.remembered import Remembered
from vmach.fit.sizes import Sizes
from vmach.fit.survey import Survey
from vmach.fit.terms import JointFit, Term, pull_of_prior

__all__ = ["Explanation", "Weighing"]

#: sizes in u that a search starts from
_START = 0.3
#: readings of the explanations that are remembered
_ROOM = 100_000
#: share of their stated inexactness that laws may have as well, with even odds; chosen: nature is
#: sometimes as simple as a law
_EXACT = 0.2


@dataclass(frozen=True)
class Explanation:
    """A set of effects, fitted, with the sizes of what stands beside them.

    Attributes
    ----------
    fit : JointFit or None
        None for the empty set.
    posterior : Posterior
    """

    fit: JointFit | None
    posterior: Posterior

    @cached_property
    def score(self) -> float:
        """Log probability of readings, set and sizes, up to what all sets share."""
        within = log_factor_of_bounds(self.fit, self.posterior) if self.fit else 0.0
        return self.posterior.log_probability + within

    @property
    def terms(self) -> tuple[Term, ...]:
        """The effects in the set, as fitted."""
        return self.fit.terms if self.fit else ()

    @property
    def labels(self) -> frozenset[str]:
        """Their names and targets."""
        return frozenset(term.label for term in self.terms)


class Weighing:
    """The candidates of one survey, weighed alone and in sets.

    Parameters
    ----------
    survey : Survey
    candidates : sequence of Candidate
    excluded : sequence of (Effect, target, why)
        What the survey cannot show.
    """

    def __init__(
        self,
        survey: Survey,
        candidates: Sequence[Candidate],
        *,
        excluded: Sequence[tuple[Effect, str, str]] = (),
        noise: FeatureNoise | None = None,
    ) -> None:
        self.survey, self.candidates = survey, list(candidates)
        self.excluded = tuple(excluded)
        self._list(Priors.over(survey, self.candidates))
        self.members = members_of(survey, self._plain_mm())
        self._take(noise or FeatureNoise(survey.u_mm, survey.group, np.ones(len(survey))))

    def _list(self, priors: Priors) -> None:
        """Where each candidate stands, and how probable each is beforehand."""
        self._place = {c.label: k for k, c in enumerate(self.candidates)}
        self.priors = priors

    def _plain_mm(self) -> np.ndarray:
        """What laws of one amplitude do that every machine has and nobody measured, (n, k)."""
        every = zip(self.candidates, self.priors.is_counted, strict=True)
        usual = [c.signatures_mm for c, is_counted in every if not is_counted]
        plain = [own[:, 0] for own in usual if own.shape[1:] == (1, 1)]
        return np.hstack([np.zeros((len(self.survey), 0)), *plain])

    def _take(self, noise: FeatureNoise) -> None:
        self.base = Base(self.survey, noise, self.members)
        self._none = Effects(self.base.no_columns)
        self._forget()
        #: log probability of every set that a search weighed, by the labels of its effects
        self.tried: dict[frozenset[str], float] = {}
        self.alone = self._empty(Sizes(1.0, (0.0,) * len(self.members.names)))

    def _forget(self) -> None:
        """What was worked out is of other candidates, or beside another noise."""
        self._bank: Bank | None = None
        room = _ROOM / len(self.survey)
        # by identity of the effects: a posterior is asked again and again
        self._known = Remembered[tuple[Effects, Evidence]](room)
        self._fits = Remembered[JointFit](room)
        self._slacks = Remembered[tuple[JointFit, Columns | None]](room)
        self._careful_fits = Remembered[tuple[Explanation, JointFit | None]](room)
        self._deleted = Remembered[tuple[Explanation, np.ndarray]](room)
        # a search, and the odds of what it found, leave the same terms out
        self._fewer = Remembered[tuple[Explanation, Explanation]](room)

    @property
    def effects(self) -> list[Effect]:
        """Those of the candidates, each once."""
        return list(dict.fromkeys(candidate.effect for candidate in self.candidates))

    @property
    def bank(self) -> Bank:
        """The candidates' signatures, made ready when first asked for."""
        self._bank = self._bank or Bank(self.base, self.candidates)
        return self._bank

    def _empty(self, sizes: Sizes) -> Explanation:
        """The empty set beside members of given sizes."""
        return Explanation(None, Posterior(self.base, sizes, self._none))

    def on(self, survey: Survey) -> Self:
        """The same over other readings of the same design."""
        other = copy.copy(self)
        other.candidates = list(self.candidates)
        other.survey = survey
        other._take(FeatureNoise(survey.u_mm, survey.group, np.ones(len(survey))))
        return other

    def with_noise(self, noise: FeatureNoise) -> Self:
        """The same with another covariance of single readings."""
        if noise.is_as(self.base.noise):
            return self
        other = copy.copy(self)
        other._take(noise)
        self.forget()
        return other

    def forget(self) -> None:
        """What takes much memory, where another weighing takes its place and goes on."""
        self._forget()
        self.forget_columns()

    def forget_columns(self) -> None:
        """What fits worked out, where others take its place; not what candidates are weighed by."""
        self.base.forget()
        give_back_free_memory()

    def release(self) -> None:
        """Candidates too, and those of the weighings that this was made of: none is asked again."""
        self.forget()
        self.candidates.clear()

    def with_candidates(self, candidates: Sequence[Candidate]) -> Self:
        """The same with other candidates."""
        return self._of(candidates, Priors.over(self.survey, candidates))

    def with_others(
        self, own: Sequence[Candidate], others: Sequence[Candidate], log_odds: Sequence[float]
    ) -> Self:
        """The same with some of its candidates, and others whose log odds are given."""
        places = [self.index_of(c.label) for c in own]
        other = self._of([*own, *others], self.priors.then(places, log_odds))
        other.tried = {}
        return other

    def _of(self, candidates: Sequence[Candidate], priors: Priors) -> Self:
        other = copy.copy(self)
        other.candidates = list(candidates)
        other._list(priors)
        other._forget()
        return other

    def prior_of(self, effect: Effect, target: str) -> float:
        """Log odds for an effect beforehand, beside one that machines often have."""
        return log_odds_of(self.survey, effect, target)

    def _count(self, terms: Sequence[Term]) -> int:
        """How many of some effects are counted ones."""
        return sum(bool(self.priors.is_counted[self.index_of(term.label)]) for term in terms)

    def index_of(self, label: str) -> int:
        """Which candidate has a given name and target."""
        return self._place[label]

    # sets, fitted -----------------------------------------------------------------------------

    def nothing(self, start: Sizes | None = None) -> Explanation:
        """The empty set."""
        start = start or Sizes(1.0, (_START,) * len(self.members.names))
        return Explanation(None, best_sizes(self.base, start, self._none))

    def small(self) -> Explanation:
        """The empty set beside a discrepancy that leaves effects to show."""
        return self._empty(Sizes(1.0, (_START,) * len(self.members.names)))

    def explain(
        self, terms: Sequence[Term], sizes: Sizes, *, refine: bool = True, resize: bool = True
    ) -> Explanation:
        """The explanation by given terms.

        Parameters
        ----------
        terms : sequence of Term
        sizes : Sizes
            Of what stands beside, to start from.
        refine : bool
            Whether inner parameters move.
        resize : bool
            Whether the sizes do.
        """
        if not terms:
            return self.nothing(sizes) if resize else self._empty(sizes)
        return self._weighed(self._fitted(terms, sizes, refine=refine), sizes, resize=resize)

    def _fitted(self, terms: Sequence[Term], sizes: Sizes, *, refine: bool) -> JointFit:
        """The fit of terms beside members of given sizes; the last ones are remembered."""
        key = tuple((t.place, t.width) for t in terms), sizes, refine
        beside = Posterior(self.base, sizes, self._none)
        return self._fits.get(key, lambda: fit_terms(beside, terms, refine=refine))

    def _weighed(self, fit: JointFit, sizes: Sizes, *, resize: bool) -> Explanation:
        """A fit with the sizes beside it, and how inexact its laws are: as stated, or less."""
        slack = self._slack(fit)
        if slack is None:
            return self._sized(fit, None, sizes, resize=resize)
        stated = self._sized(fit, slack, sizes, resize=resize)
        closer = replace(fit, slack_scale=_EXACT)
        less = self._sized(closer, slack, stated.posterior.sizes, resize=False)
        if less.score < stated.score:
            return stated
        return self._sized(closer, slack, stated.posterior.sizes, resize=resize)

    def _sized(
        self, fit: JointFit, slack: Columns | None, sizes: Sizes, *, resize: bool
    ) -> Explanation:
        shown = fit.open.scaled(self.prior_widths(fit))
        log_prior = self._log_prior_of(fit)
        if slack is not None:
            shown = shown.beside(slack.scaled(np.full(len(slack), fit.slack_scale)))
            log_prior -= np.log(2.0)
        effects = Effects(shown, log_prior)
        if resize:
            return Explanation(fit, best_sizes(self.base, sizes, effects))
        return Explanation(fit, Posterior(self.base, sizes, effects))

    def _slack(self, fit: JointFit) -> Columns | None:
        """Columns of what the laws leave open, as far as stated."""

        def made() -> tuple[JointFit, Columns | None]:
            slack = stated_slack(self.survey, fit)
            return fit, self.base.columns(slack) if slack.shape[1] else None

        return self._slacks.get(id(fit), made)[1]

    def prior_widths(self, fit: JointFit) -> np.ndarray:
        """Prior deviations of all amplitudes, then of all inner parameters, of a fit."""
        widths = [
            np.full(len(c), term.width or width_of(c))
            for term, c in zip(fit.terms, fit.coefficients, strict=True)
        ]
        return np.concatenate([*widths, *(term.spread_of_inner for term in fit.terms)])

    def _log_prior_of(self, fit: JointFit) -> float:
        total = log_probability_of_count(self._count(fit.terms))
        for k, term in enumerate(fit.terms):
            place = self.index_of(term.label)
            looked_at = 1.0 if term.free_inner else len(self.candidates[place].grid)
            if term.effect.is_sudden:
                looked_at = self.survey.moments_like(term.effect, term.target, term.inner)
            total += self.priors.log_odds[place] - np.log(looked_at * len(WIDTHS))
            total -= 0.5 * float(np.sum(term.unusual**2)) + pull_of_prior(fit, k)
        return total

    def extend(
        self, explanation: Explanation, k: int, *, refine: bool = True, resize: bool = True
    ) -> Explanation:
        """The explanation with candidate k added and everything refitted, but what shall stay."""
        terms = [*explanation.terms, self.term(k, explanation)]
        return self.explain(terms, explanation.posterior.sizes, refine=refine, resize=resize)

    def resized(self, explanation: Explanation, start: Sizes) -> Explanation:
        """The same effects beside the most probable sizes near other ones."""
        posterior = best_sizes(self.base, start, explanation.posterior.effects)
        return replace(explanation, posterior=posterior)

    def remembered(self, explanation: Explanation) -> Explanation:
        """An explanation, noted among those that were tried."""
        before = self.tried.get(explanation.labels, -np.inf)
        self.tried[explanation.labels] = max(before, explanation.score)
        return explanation

    def remembered_as(self, before: Weighing, found: Explanation) -> Explanation:
        """An explanation, noted with sets that were tried beside it and slightly other noise."""
        more = found.score - before.tried.get(found.labels, np.inf)
        self.tried |= {one: score + more for one, score in before.tried.items()}
        return self.remembered(found)

    def careful(self, explanation: Explanation) -> JointFit | None:
        """The fit with what laws and weights leave open counted as uncertainty of the readings."""

        def made() -> tuple[Explanation, JointFit | None]:
            fit, sizes = explanation.fit, explanation.posterior.sizes
            sizes = replace(sizes, factor=sizes.factor * self.base.noise.widening)
            return explanation, careful_fit(self.base, fit, sizes) if fit else None

        return self._careful_fits.get(id(explanation), made)[1]

    def deletion_residuals(self, explanation: Explanation) -> np.ndarray:
        """How far each reading lies from what all others say of it, (n,); remembered."""

        def made() -> tuple[Explanation, np.ndarray]:
            return explanation, deletion_residuals(explanation.posterior)

        return self._deleted.get(id(explanation), made)[1]

    def without(
        self, explanation: Explanation, ks: Sequence[int], *, resize: bool = True
    ) -> Explanation:
        """The explanation without some of its terms; the others keep their inner parameters."""

        def fewer() -> tuple[Explanation, Explanation]:
            left = [term for k, term in enumerate(explanation.terms) if k not in ks]
            sizes = explanation.posterior.sizes
            return explanation, self.explain(left, sizes, refine=False, resize=resize)

        return self._fewer.get((id(explanation), tuple(ks), resize), fewer)[1]

    def term(self, k: int, explanation: Explanation) -> Term:
        """Candidate k with its best inner parameters on what an explanation leaves."""
        candidate, evidence = self.candidates[k], self.evidence(explanation)
        width = None
        if candidate.is_curve:
            width = WIDTHS[evidence.best_width[k, 0]]
        return Term(candidate.effect, candidate.target, candidate.grid[evidence.best[k, 0]], width)

    # candidates, weighed ----------------------------------------------------------------------

    def evidence(self, explanation: Explanation) -> Evidence:
        """Of every candidate beside an explanation, at its sizes."""
        posterior = explanation.posterior
        effects, key = posterior.effects, (id(posterior.effects), posterior.sizes)
        return self._known.get(key, lambda: (effects, self.bank.evidence(posterior)))[1]

    def gains(self, explanation: Explanation) -> np.ndarray:
        """Log odds of every candidate beside an explanation, at its sizes."""
        evidence = self.evidence(explanation)
        return evidence.log_factor[:, 0] + self.priors.beside(self._count(explanation.terms))

    def pair_gains(
        self, explanation: Explanation, firsts: Sequence[int] | None = None
    ) -> np.ndarray:
        """Log odds of every two candidates beside an explanation, at its sizes, (C, C).

        They only say what is worth a fit: the first, in rows, is at its best place. Minus infinity
        for curves, and for what is there; and for rows that are not asked, where some are.
        """
        gains, count = self.gains(explanation), self._count(explanation.terms)
        odds = np.full((len(gains),) * 2, -np.inf)
        free = [
            k
            for k, c in enumerate(self.candidates)
            if c.label not in explanation.labels and not c.is_curve
        ]
        asked = free if firsts is None else list(firsts)
        if not asked:
            return odds
        firsts = [self.base.columns(self._at_best(k, explanation)) for k in asked]
        odds[asked] = self.bank.beside_each(explanation.posterior, firsts)
        beside = [self.priors.beside(count + more) for more in (0, 1)]
        for k in asked:
            odds[k] += gains[k] + beside[int(self.priors.is_counted[k])]
        odds[:, np.setdiff1d(np.arange(len(gains)), free)] = -np.inf
        np.fill_diagonal(odds, -np.inf)
        return odds

    def _at_best(self, k: int, explanation: Explanation) -> np.ndarray:
        """Candidate k at its best place and width beside an explanation, (n, K) mm."""
        evidence = self.evidence(explanation)
        width = WIDTHS[evidence.best_width[k, 0]]
        return width * self.candidates[k].signatures_mm[:, evidence.best[k, 0]]

    def fitted_alone(self, k: int) -> tuple[Term, np.ndarray]:
        """Candidate k fitted alone at its best place: the term and its coefficients (K,)."""
        evidence = self.evidence(self.alone)
        white = self.base.white(self.candidates[k].signatures_mm[:, evidence.best[k, 0]])
        prior = np.eye(white.shape[1]) / WIDTHS[evidence.best_width[k, 0]] ** 2
        amounts = np.linalg.solve(white.T @ white + prior, white.T @ self.base.y)
        return self.term(k, self.alone), amounts

    def alone_mm(self, k: int) -> np.ndarray:
        """What candidate k does to the readings when it is fitted alone, (n,) mm."""
        place = self.evidence(self.alone).best[k, 0]
        return self.candidates[k].signatures_mm[:, place] @ self.fitted_alone(k)[1]
