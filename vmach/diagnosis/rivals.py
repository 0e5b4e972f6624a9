"""Rivals: which other effects would explain the same readings as well as the one found?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.diagnosis.explanation import MARGIN, Explanation
from vmach.diagnosis.search import Search
from vmach.fit.whitening import orthonormal

__all__ = ["Rivals", "rivals_of"]

#: effects that are always there a little and may join in an imitation
_NEVER_EXACT = ("tool_radius", "tool_length")
#: effects that imitate another one when they act alike on all axes, or on all tools
_TEAMS = ("scale", "tool_radius", "tool_length", "runout")
#: effects with the same signature: one never counts as a team of the other
_SAME_AS = dict.fromkeys(("tool_radius", "runout"), ("tool_radius", "runout"))


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


def rivals_of(search: Search, explanation: Explanation, k: int) -> Rivals:
    """Rivals of term k of an explanation, the other terms staying."""
    assert explanation.fit is not None
    own = explanation.fit.terms[k]
    others = search.without(explanation, k)
    gains = search.gains(others)
    best = max(gains)
    near = [i for i in np.argsort(gains)[::-1] if gains[i] > best - MARGIN]
    labels = [search.candidates[i].label for i in near]
    if own.label not in labels:
        labels.insert(0, own.label)
    names = list(dict.fromkeys(label.split()[0] for label in labels))
    names += [n for n in _teams(search, explanation, k, others) if n not in names]
    names.sort(key=lambda name: name != own.effect.name)
    return Rivals(tuple(names), tuple(labels))


def _teams(search: Search, explanation: Explanation, k: int, others: Explanation) -> list[str]:
    """Effects that do the same when they act on all their targets at once: three scales ..."""
    assert explanation.fit is not None
    absorb = search.absorber(others)
    shown = absorb(search.whiten(explanation.fit.explained_mm(k)))
    own = explanation.fit.terms[k].effect.name
    found = []
    for name in _TEAMS:
        members = [
            i
            for i, candidate in enumerate(search.candidates)
            if candidate.effect.name in (name, *_NEVER_EXACT)
            and candidate.effect.name not in _SAME_AS.get(own, (own,))
        ]
        if own in _SAME_AS.get(name, (name,)) or not members:
            continue
        span = np.hstack([search.bank.columns(i)[:, 0, :] for i in members])
        basis = orthonormal(absorb(span), tolerance=1e-6)
        left = shown - basis @ (basis.T @ shown)
        if left @ left < 2.0 * MARGIN:
            found.append(name)
    return found
