"""Rivals: which other effects would explain the same readings as well as the one found?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear
from scipy.special import logsumexp

from vmach.diagnosis.gates.impossible_sizes import has_impossible_sizes
from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.effects import catalogue
from vmach.fit.candidates import Candidate

__all__ = ["Rivals", "credible", "in_other_sets", "rivals_of"]


@dataclass(frozen=True)
class Rivals:
    """Effects that the data cannot tell from one that was found.

    Attributes
    ----------
    names : tuple of str
        Names of effects, the most plausible first, the one found among them.
    labels : tuple of str
        The same with targets.
    """

    names: tuple[str, ...]
    labels: tuple[str, ...]


def rivals_of(weighing: Weighing, explanation: Explanation, k: int) -> Rivals:
    """Rivals of term k of an explanation, the other terms staying."""
    assert explanation.fit is not None
    own = explanation.fit.terms[k]
    others = weighing.without(explanation, [k], resize=False)
    gains = weighing.gains(others)
    near = [
        i
        for i in credible(gains)
        # what is less probable than nothing in its place is no rival
        if gains[i] > 0.0
        and weighing.candidates[i].label not in others.labels
        and not _needs_impossible_size(weighing, others, i)
    ]
    labels = [weighing.candidates[i].label for i in near]
    beside = in_other_sets(weighing, own.label, alone=labels)
    labels += [label for label in beside if label not in labels]
    if own.label not in labels:
        labels.insert(0, own.label)
    names = list(dict.fromkeys(label.split()[0] for label in labels))
    alike = _jointly(weighing, explanation, k, others) + _at_once(weighing, explanation, k, others)
    names += [n for n in dict.fromkeys(alike) if n not in names]
    names.sort(key=lambda name: name != own.effect.name)
    return Rivals(tuple(names), tuple(labels))


def credible(gains: np.ndarray) -> np.ndarray:
    """The fewest candidates that hold all probability but a share of exp(-CLEARLY)."""
    order = np.argsort(-gains)
    probability = np.exp(gains[order] - logsumexp(gains))
    before = np.cumsum(probability) - probability
    return order[before < 1.0 - np.exp(-CLEARLY)]


def in_other_sets(weighing: Weighing, label: str, *, alone: Sequence[str] = ()) -> list[str]:
    """Effects in the place of one, in sets that are nearly as probable as the best.

    What stands there beside effects that can do so without it, as those that can `alone`, does
    nothing in its place.
    """
    tried = weighing.tried
    best = max(tried, key=lambda labels: tried[labels], default=frozenset())
    sets = [best, *(labels for labels in tried if best - labels == {label})]
    near = credible(np.array([tried.get(labels, 0.0) for labels in sets]))
    instead = [sets[k] - best for k in near if sets[k] != best]
    fewer = [*instead, *(frozenset({one}) for one in alone)]
    least = (labels for labels in instead if not any(one < labels for one in fewer))
    return sorted({other for labels in least for other in labels})


def _needs_impossible_size(weighing: Weighing, others: Explanation, i: int) -> bool:
    """Whether a candidate in place of the effect would fit with a size that nature has not."""
    if not any(p.is_bounded or p.is_essential for p in weighing.candidates[i].effect.parameters):
        return False
    fit = weighing.extend(others, i, resize=False).fit
    return fit is not None and has_impossible_sizes(fit)


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
    left = 2.0 * lsq_linear(columns, shown, bounds=(least, np.inf)).cost
    return left < 2.0 * CLEARLY
