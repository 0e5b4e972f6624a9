"""Effects whose parameters were fitted together: what is not known of them is correlated.

Source: JCGM 100:2008 (GUM), 5.2, correlated input quantities, and eq. 13; closed form derived here:
a triangular root of the matrix of their correlation coefficients.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from vmach.effects.instance import EffectInstance
from vmach.path.toolpath import PathStates

__all__ = ["Key", "acting_together", "patterns_left_open", "with_correlations"]

#: name and target of an effect
Key = tuple[str, str]

#: an eigenvalue of correlation coefficients below minus this contradicts them: what rounding to
#: three decimals makes of a hundred changes at most, 100 times 0.0005
_CONTRADICTS = 0.05


_Acting = TypeVar("_Acting")


def acting_together(effects: Sequence[_Acting]) -> Iterator[list[_Acting]]:
    """Effects that share the changes of their parameters, each group once; most are alone.

    So is what acts beside the effects of a job, as a draw of the machine's tables does.
    """
    numbers = [e.together if isinstance(e, EffectInstance) else 0 for e in effects]
    for k, (effect, number) in enumerate(zip(effects, numbers, strict=True)):
        if not number:
            yield [effect]
        elif number not in numbers[:k]:
            yield [e for e, other in zip(effects, numbers, strict=True) if other == number]


def patterns_left_open(effects: Sequence[EffectInstance], states: PathStates) -> list[np.ndarray]:
    """Displacements at the contact, of unit variance each, that effects leave open, (P, 3, K) mm.

    One array holds what is independent of all others; what correlated parameters do is added.
    """
    found = []
    for group in acting_together(effects):
        patterns = [effect.uncertainty_patterns(states) for effect in group]
        if len(group) == 1:
            found += patterns
            continue
        own = [p.shape[2] - len(e.one_sigma) for e, p in zip(group, patterns, strict=True)]
        found += [p[:, :, :count] for p, count in zip(patterns, own, strict=True)]
        found.append(sum(p[:, :, count:] for p, count in zip(patterns, own, strict=True)))
    return found


def with_correlations(
    effects: Sequence[EffectInstance], coefficients: Mapping[tuple[Key, Key], np.ndarray]
) -> tuple[EffectInstance, ...]:
    """Effects with changes that those of a group share: the k-th of all of them is one.

    Parameters
    ----------
    effects : sequence of EffectInstance
        Each with independent changes of its own.
    coefficients : mapping of two effects to (D, E) float64
        Correlation coefficients of the D changes of the first with the E of the second.

    Raises
    ------
    ValueError
        No quantities have such coefficients, or there are more or fewer of them than changes.
    """
    found = list(effects)
    for number, places in enumerate(_groups(effects, coefficients), start=1):
        group = [effects[k] for k in places]
        root = _root(_matrix(group, coefficients))
        ends = np.cumsum([len(effect.one_sigma) for effect in group])
        for k, own in zip(places, np.split(root, ends[:-1]), strict=True):
            shared = [_change(effects[k].one_sigma, amounts) for amounts in own.T]
            found[k] = replace(effects[k], one_sigma=tuple(shared), together=number)
    return tuple(found)


def _key(effect: EffectInstance) -> Key:
    return effect.effect.name, effect.target


def _groups(
    effects: Sequence[EffectInstance], coefficients: Mapping[tuple[Key, Key], np.ndarray]
) -> list[list[int]]:
    """Numbers of effects that hang together; those whose law is bent have the fewest changes."""
    keys = [_key(effect) for effect in effects]
    group = {key: {key} for key in keys}
    for first, second in coefficients:
        both = group[first] | group[second]
        group |= dict.fromkeys(both, both)
    wholes = {frozenset(some) for some in group.values() if len(some) > 1}
    places = [[k for k, key in enumerate(keys) if key in some] for some in wholes]
    return sorted(sorted(some, key=lambda k: effects[k].is_straight) for some in places)


def _matrix(
    group: Sequence[EffectInstance], coefficients: Mapping[tuple[Key, Key], np.ndarray]
) -> np.ndarray:
    """Correlation coefficients of all changes of a group, (M, M)."""
    counts = [len(effect.one_sigma) for effect in group]
    blocks = [[np.zeros((m, n)) for n in counts] for m in counts]
    for i, first in enumerate(group):
        blocks[i][i] = np.eye(counts[i])
        for j, second in enumerate(group):
            given = coefficients.get((_key(first), _key(second)))
            if given is None:
                continue
            if given.shape != (counts[i], counts[j]):
                raise ValueError(f"{counts[i]} rows of {counts[j]} coefficients")
            blocks[i][j], blocks[j][i] = given, given.T
    return np.block(blocks)


def _root(matrix: np.ndarray) -> np.ndarray:
    """A lower triangle with rows of unit length, whose square is the matrix, (M, M).

    Its diagonal is positive: changes of the first effect are its own.
    """
    squared, axes = np.linalg.eigh(matrix)
    if squared[0] < -_CONTRADICTS:
        raise ValueError("coefficients that quantities can have: some of these contradict others")
    root = axes * np.sqrt(np.maximum(squared, 0.0))
    root /= np.linalg.norm(root, axis=1, keepdims=True)
    lower = np.linalg.qr(root.T, mode="r").T
    return lower * np.where(np.diag(lower) < 0.0, -1.0, 1.0)


def _change(changes: Sequence[Mapping[str, Any]], amounts: np.ndarray) -> dict[str, Any]:
    """So much of each of some changes, together."""
    total: dict[str, Any] = {}
    for change, amount in zip(changes, amounts, strict=True):
        if abs(amount) > 1e-12:
            for name, by in change.items():
                total[name] = total.get(name, 0.0) + amount * np.asarray(by)
    return {name: np.asarray(value).tolist() for name, value in total.items()}
