"""How probable effects are before any reading."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.special import gammaln

from vmach.diagnosis.inference.rules import UNMEASURED
from vmach.effects import Effect
from vmach.fit.candidates import Candidate
from vmach.fit.survey import Survey

__all__ = ["Priors", "is_usual", "log_odds_of", "log_probability_of_count"]


@dataclass(frozen=True, eq=False)
class Priors:
    """Of candidates.

    Attributes
    ----------
    log_odds : (C,) float64
        Even at most: none is there before any reading says so.
    is_counted : (C,) bool
        Whether it is one of those of which a machine has an unknown number.
    """

    log_odds: np.ndarray
    is_counted: np.ndarray

    @classmethod
    def over(cls, survey: Survey, candidates: Sequence[Candidate]) -> Self:
        """Of all candidates of a survey."""
        odds = np.array([log_odds_of(survey, c.effect, c.target) for c in candidates])
        counted = [not is_usual(survey, c.effect, c.target) for c in candidates]
        return cls(np.minimum(odds - np.log(max(len(odds), 1)), 0.0), np.array(counted, bool))

    def then(self, places: Sequence[int], given: Sequence[float]) -> Self:
        """Of some of these, and behind them of others with given odds, which are not counted."""
        odds = np.concatenate([self.log_odds[places], given])
        return type(self)(odds, np.append(self.is_counted[places], np.zeros(len(given), bool)))

    def beside(self, count: int) -> np.ndarray:
        """Log odds of each beside so many effects that are counted, (C,)."""
        more = log_probability_of_count(count + 1) - log_probability_of_count(count)
        return self.log_odds + more * self.is_counted


def is_usual(survey: Survey, effect: Effect, target: str) -> bool:
    """Whether every machine has some of it, and how much nobody measured or is the question."""
    return effect.is_unmeasured(survey.job.machine, target) or survey.is_tested(effect, target)


def log_odds_of(survey: Survey, effect: Effect, target: str) -> float:
    """Log odds for an effect, beside one that machines often have."""
    return UNMEASURED if is_usual(survey, effect, target) else -effect.rarity


def log_probability_of_count(count: int) -> float:
    """Log probability of so many effects, beside what all sets share: one more has even odds.

    Sets of k effects share it; odds of each alone would make k a Poisson variable of mean one.

    Source: derived here, from k! (N - k)! / N! of a set as in J. Scott and J. Berger, Bayes
    and empirical-Bayes multiplicity adjustment in the variable-selection problem, Ann. Stat.
    38 (2010) 2587, with a geometric number of mean one.
    """
    return float(gammaln(count + 1) - count * np.log(2.0))
