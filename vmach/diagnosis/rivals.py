"""Rivals: which other effects would explain the same readings as well as the one found?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.diagnosis.explanation import MARGIN, Explanation
from vmach.diagnosis.search import Search
from vmach.effects.sudden import Sudden
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
    others = search.without(explanation, [k])
    gains = search.gains(others)
    best = max(gains)
    near = [i for i in np.argsort(gains)[::-1] if gains[i] > best - MARGIN]
    labels = [search.candidates[i].label for i in near]
    if own.label not in labels:
        labels.insert(0, own.label)
    names = list(dict.fromkeys(label.split()[0] for label in labels))
    alike = _teams(search, explanation, k, others) + _at_once(search, explanation, k, others)
    names += [n for n in dict.fromkeys(alike) if n not in names]
    names.sort(key=lambda name: name != own.effect.name)
    return Rivals(tuple(names), tuple(labels))


def _teams(search: Search, explanation: Explanation, k: int, others: Explanation) -> list[str]:
    """Effects that do the same when they act on all their targets at once: three scales ..."""
    assert explanation.fit is not None
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
        span = np.hstack([search.candidates[i].signatures_mm[:, 0, :] for i in members])
        if _can_imitate(span, search, others, explanation.fit.explained_mm(k)):
            found.append(name)
    return found


def _at_once(search: Search, explanation: Explanation, k: int, others: Explanation) -> list[str]:
    """Sudden effects that do the same at the same moment: the part jumped, or the tool."""
    assert explanation.fit is not None
    own = explanation.fit.terms[k]
    if not isinstance(own.effect, Sudden):
        return []
    found = []
    for candidate in search.candidates:
        effect, target = candidate.effect, candidate.target
        if isinstance(effect, Sudden) and effect is not own.effect:
            span = search.survey.signature(effect, target, own.inner)
            if _can_imitate(span, search, others, explanation.fit.explained_mm(k)):
                found.append(effect.name)
    return found


def _can_imitate(
    span: np.ndarray, search: Search, others: Explanation, explained_mm: np.ndarray
) -> bool:
    """Whether columns (n, P) mm can do what an effect does (n,) mm, the other effects fitted."""
    absorb = search.absorber(others)
    shown = absorb(search.whiten(explained_mm))
    basis = orthonormal(absorb(search.whiten(span)), tolerance=1e-6)
    left = shown - basis @ (basis.T @ shown)
    return float(left @ left) < 2.0 * MARGIN
