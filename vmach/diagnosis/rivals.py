"""Rivals: which other effects would explain the same readings as well as the one found?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy  # its parts are loaded when they are first used
from scipy.special import logsumexp

from vmach.diagnosis.gates.impossible_sizes import impossible_terms
from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.effects import catalogue
from vmach.fit.candidates import Candidate

__all__ = ["OtherSet", "Rivals", "credible", "other_sets", "rivals_of"]


#: candidates that are fitted in the place of one effect; chosen: what its own law leaves open is in
#: no estimate, and one that came third by it was 28 in log odds more probable
_FITTED = 6
#: sets that exchange several effects, and are told of one at most; chosen
_TOLD = 4


@dataclass(frozen=True)
class OtherSet:
    """A set of effects that is nearly as probable as the one that was found.

    Attributes
    ----------
    without : frozenset of str
        Names and targets of what was found, and is not in it.
    instead : frozenset of str
        What is in it instead.
    odds : float
        Log odds for it against the set that was found.
    """

    without: frozenset[str]
    instead: frozenset[str]
    odds: float

    @property
    def is_one_for_one(self) -> bool:
        """Whether one effect stands in the place of one."""
        return len(self.without) == len(self.instead) == 1

    def does_idly_more_than(self, other: OtherSet) -> bool:
        """Whether it exchanges more than another one, and is not more probable for it."""
        more = other.without <= self.without and other.instead <= self.instead
        return more and self != other and other.odds >= self.odds

    def words(self, label: str) -> str:
        """What stands in the place of one effect, and of which others."""
        others = sorted(self.without - {label})
        beside = f" in the place of it and {' and '.join(others)}" if others else ""
        return f"{' with '.join(sorted(self.instead))}{beside}"


@dataclass(frozen=True)
class Rivals:
    """Effects that the data cannot tell from one that was found.

    Attributes
    ----------
    names : tuple of str
        Names of effects, the most plausible first, the one found among them.
    labels : tuple of str
        The same with targets, of those that each stand in its place.
    sets : tuple of OtherSet
        Where several stand in its place, or one in its place and that of others.
    """

    names: tuple[str, ...]
    labels: tuple[str, ...]
    sets: tuple[OtherSet, ...] = ()

    @property
    def in_sets(self) -> frozenset[str]:
        """Names and targets of those that stand there with others, or for others too."""
        return frozenset().union(*(one.instead for one in self.sets))


def rivals_of(weighing: Weighing, explanation: Explanation, k: int) -> Rivals:
    """Rivals of term k of an explanation, the other terms staying."""
    assert explanation.fit is not None
    own = explanation.fit.terms[k]
    others = weighing.without(explanation, [k], resize=False)
    gains = _gains_instead(weighing, explanation, own.label, others)
    # what is less probable than nothing in its place is no rival
    near = [i for i in credible(gains) if gains[i] > 0.0]
    labels = [weighing.candidates[i].label for i in near]
    odds = gains - gains[weighing.index_of(own.label)]
    alone = {labels[k]: odds[i] for k, i in enumerate(near)}
    sets = other_sets(weighing, explanation, own.label, alone)
    beside = sorted(label for one in sets if one.is_one_for_one for label in one.instead)
    labels += [label for label in beside if label not in labels]
    if own.label not in labels:
        labels.insert(0, own.label)
    joint = tuple(one for one in sets if not one.is_one_for_one)[:_TOLD]
    rivals = Rivals((), tuple(labels), joint)
    names = list(dict.fromkeys(label.split()[0] for label in (*labels, *sorted(rivals.in_sets))))
    alike = _jointly(weighing, explanation, k, others) + _at_once(weighing, explanation, k, others)
    names += [n for n in dict.fromkeys(alike) if n not in names]
    names.sort(key=lambda name: name != own.effect.name)
    return replace(rivals, names=tuple(names))


def credible(gains: np.ndarray) -> np.ndarray:
    """The fewest candidates that hold all probability but a share of exp(-CLEARLY)."""
    order = np.argsort(-gains)
    probability = np.exp(gains[order] - logsumexp(gains))
    before = np.cumsum(probability) - probability
    return order[before < 1.0 - np.exp(-CLEARLY)]


def other_sets(
    weighing: Weighing, found: Explanation, label: str, alone: Mapping[str, float]
) -> tuple[OtherSet, ...]:
    """Sets without one effect that are nearly as probable as the one found, the best first.

    The one found may hold effects that are not certain beside those that are told.

    One that exchanges more than another one, and is not more probable for it, is not told. So what
    stands there beside an effect that can do as well `alone`, with its log odds, is no rival.
    """
    tried = weighing.tried
    holding = [labels for labels in tried if labels >= found.labels]
    best = max(holding, key=lambda labels: tried[labels], default=None)
    if best is None:
        return ()
    every = [OtherSet(best - one, one - best, tried[one] - tried[best]) for one in tried]
    sets = [one for one in every if one.instead or not one.without]
    near = [sets[k] for k in credible(np.array([one.odds for one in sets]))]
    known = [OtherSet(frozenset({label}), frozenset({k}), odds) for k, odds in alone.items()]
    exchanged = [one for one in near if one.without]
    least = (
        one
        for one in exchanged
        if not any(one.does_idly_more_than(other) for other in (*exchanged, *known))
    )
    return tuple(one for one in least if label in one.without)


def _gains_instead(
    weighing: Weighing, explanation: Explanation, label: str, others: Explanation
) -> np.ndarray:
    """Log odds of every candidate in the place of an effect, the leading ones fitted, (C,).

    Minus infinity for one that is there already, or would need a size that nature has not.
    """
    gains = weighing.gains(others).copy()
    taken = [weighing.index_of(term.label) for term in others.terms]
    gains[taken] = -np.inf
    gains[weighing.index_of(label)] = explanation.score - others.score
    before = _impossible(explanation)
    for i in np.argsort(-gains)[:_FITTED]:
        if weighing.candidates[i].label != label:
            one = weighing.extend(others, i, resize=False)
            gains[i] = one.score - others.score if _impossible(one) <= before else -np.inf
    return gains


def _impossible(one: Explanation) -> set[str]:
    """Names and targets of effects with a size that nature has not."""
    return {one.terms[k].label for k in impossible_terms(one.fit)} if one.fit else set()


def _jointly(
    weighing: Weighing, explanation: Explanation, k: int, others: Explanation
) -> list[str]:
    """Effects that do the same when they act on all their targets at once: three scales ..."""
    assert explanation.fit is not None
    fit, own = explanation.fit, explanation.fit.terms[k].effect

    def can_imitate(candidates: Sequence[Candidate]) -> bool:
        span = [candidate.signatures_mm[:, 0, :] for candidate in candidates]
        return bool(span) and _can_imitate(np.hstack(span), others, fit.explained_mm(k))

    rest = [c for c in weighing.candidates if c.effect.is_never_exact]
    found = []
    for one in catalogue().values():
        if not one.imitates_as_team or one.is_twin_of(own):
            continue
        team = [c for c in weighing.candidates if c.effect.name == one.name]
        helpers = [c for c in rest if c.effect.name != one.name and not c.effect.is_twin_of(own)]
        # what the helpers do alone is not its work
        if team and can_imitate([*team, *helpers]) and not can_imitate(helpers):
            found.append(one.name)
    return found


def _at_once(
    weighing: Weighing, explanation: Explanation, k: int, others: Explanation
) -> list[str]:
    """Sudden effects that do the same at the same moment: the part jumped, or the tool."""
    assert explanation.fit is not None
    own = explanation.fit.terms[k]
    if not own.effect.is_sudden:
        return []
    found = []
    for candidate in weighing.candidates:
        effect, target = candidate.effect, candidate.target
        if effect.is_sudden and effect is not own.effect:
            span = weighing.survey.signature(effect, target, own.inner)
            least = [0.0 if p.is_size else -np.inf for p in effect.amplitudes]
            if _can_imitate(span, others, explanation.fit.explained_mm(k), least=least):
                found.append(effect.name)
    return found


def _can_imitate(
    span: np.ndarray,
    others: Explanation,
    explained_mm: np.ndarray,
    *,
    least: Sequence[float] | float = -np.inf,
) -> bool:
    """Whether columns (n, P) mm can do what an effect does (n,) mm, the other effects fitted.

    No column less than `least` times: a size is not below zero.
    """
    whiten = others.posterior.whiten
    shown, columns = whiten(explained_mm), whiten(span)
    left = 2.0 * scipy.optimize.lsq_linear(columns, shown, bounds=(least, np.inf)).cost
    return left < 2.0 * CLEARLY
