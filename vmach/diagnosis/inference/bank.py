"""Signatures of many candidates, weighed together beside members and effects.

Only inner products of the signatures with each other, with the members' columns and with the
readings enter. They are worked out once for a survey; an explanation changes them by a matrix of
low rank.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vmach.fit.base import Base, SizedMembers
from vmach.fit.candidates import Candidate
from vmach.fit.columns import Columns
from vmach.fit.evidence import Evidence, evidence_at_places
from vmach.fit.marginal_likelihood import Posterior
from vmach.fit.remembered import Remembered

__all__ = ["Bank"]

#: numbers that are widened together, so few that they stay near the processor
_CACHED = 200_000
#: numbers up to which signatures are kept wide, 32 MB
_KEPT_WIDE = 4_000_000
#: numbers that white signatures may take up
_ROOM = 2_000_000
#: share of the largest variance of effects that is none
_NOTHING = 1e-14
#: sizes of members beside which products are kept: those of an explanation, and little ones
_SIZES = 3
#: what an effect takes: its products with columns in mm, (n, e), and of the readings, (e,)
_Taken = tuple[np.ndarray, np.ndarray]


class Bank:
    """Candidates over one base.

    Parameters
    ----------
    base : Base
    candidates : sequence of Candidate
    """

    def __init__(self, base: Base, candidates: Sequence[Candidate]) -> None:
        self._base = base
        # candidates with equally many coefficients are weighed together, curves by themselves
        groups: dict[tuple[int, bool], list[int]] = {}
        for c, candidate in enumerate(candidates):
            key = candidate.signatures_mm.shape[2], candidate.is_curve
            groups.setdefault(key, []).append(c)
        self._listed = list(groups.values())
        self._place = np.argsort(np.concatenate([*self._listed, []]).astype(int))
        self._groups = [
            _Group(base, [candidates[c] for c in g], terms) for (terms, _), g in groups.items()
        ]

    def evidence(self, posterior: Posterior) -> Evidence:
        """Evidence of every candidate beside members and effects of a posterior."""
        white, seen = _apart(posterior)
        back = self._base.back(white)
        parts = [group.evidence(posterior.members, back, seen) for group in self._groups]
        return Evidence.joined(parts, self._place)

    def beside_each(self, posterior: Posterior, firsts: Sequence[Columns]) -> np.ndarray:
        """Log factors of every candidate beside a posterior and one effect more, of F, (F, C).

        Minus infinity for candidates that are curves.

        Parameters
        ----------
        posterior : Posterior
        firsts : sequence of Columns
            Each effect's, of unit prior variance.
        """
        white, seen = _apart(posterior)
        back, more = self._base.back(white), _each_apart(posterior, firsts)
        found = np.full((len(firsts), len(self._place)), -np.inf)
        for group, own in zip(self._groups, self._listed, strict=True):
            if not group.are_curves:
                found[:, own] = group.beside_each(posterior.members, (back, seen), more)
        return found


class _Group:
    """Candidates with equally many coefficients K, at P places in all."""

    def __init__(self, base: Base, candidates: Sequence[Candidate], terms: int) -> None:
        self._log_priors = [c.log_prior for c in candidates]
        self._terms = terms
        self.are_curves = all(c.is_curve for c in candidates)
        raw = [candidate.rows_mm for candidate in candidates]
        parts = []
        wide = len(base.survey)
        for some in _at_once(raw, terms * max(_ROOM // (terms * wide), 1)):
            rows = base.white(some.T).T
            parts.append((rows @ base.z, rows @ base.y, _products(self._by_place(rows))))
        self._rows = list(_at_once(raw, max(_CACHED // wide, 1)))
        if sum(rows.size for rows in self._rows) < _KEPT_WIDE:
            self._rows = [np.concatenate(self._rows).astype(np.float64)]
        self._with_members, self._seen, self._gram = map(np.concatenate, zip(*parts, strict=True))
        self._beside = Remembered[_Beside](_SIZES)

    def evidence(self, members: SizedMembers, back: np.ndarray, seen: np.ndarray) -> Evidence:
        """Evidence of each; rows times `back` (n, e) are what effects take of them.

        What they take of the readings is `seen`, (e,).
        """
        return self._evidence(self._left(members, back, seen))

    def _evidence(self, left: _Beside) -> Evidence:
        """Of each, from products."""
        return evidence_at_places(left.gram, self._by_place(left.inner[:, None]), self._log_priors)

    def beside_each(
        self, members: SizedMembers, effects: _Taken, more: Sequence[_Taken]
    ) -> np.ndarray:
        """Log factors of each beside effects, as above, and one effect more of F, (F, C)."""
        left, found = self._left(members, *effects), []
        every = np.concatenate([back for back, _ in more], axis=1)
        together = np.concatenate([self._times(rows, every) for rows in self._rows])
        ends = np.cumsum([len(seen) for _, seen in more])[:-1]
        for taken, (_, seen) in zip(np.split(together, ends, axis=1), more, strict=True):
            found.append(self._evidence(left.without(self._by_place(taken), seen)).log_factor[:, 0])
        return np.array(found)

    def _left(self, members: SizedMembers, back: np.ndarray, seen: np.ndarray) -> _Beside:
        """What members and effects leave."""
        beside = self._beside.get(members.sizes, lambda: self._beside_members(members))
        taken = np.concatenate([self._times(rows, back) for rows in self._rows])
        return beside.without(self._by_place(taken), seen)

    def _times(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Rows (m, n) times columns (n, k)."""
        return rows.astype(np.float64, copy=False) @ columns

    def _beside_members(self, members: SizedMembers) -> _Beside:
        """What is left beside members alone."""
        k, taken = members.sizes.factor, members.taken(self._with_members.T)
        gram = (self._gram - _products(self._by_place(taken.T))) / k**2
        return _Beside(gram, self._seen / k**2 - taken.T @ members.seen / k)

    def _by_place(self, rows: np.ndarray) -> np.ndarray:
        """Rows (P K, n) as (P, K, n)."""
        return rows.reshape(len(rows) // self._terms, self._terms, rows.shape[1])


@dataclass(frozen=True)
class _Beside:
    """Products of candidates beside members of given sizes.

    Attributes
    ----------
    gram : (P, K, K) float64
    inner : (P K,) float64
        With the readings.
    """

    gram: np.ndarray
    inner: np.ndarray

    def without(self, taken: np.ndarray, seen: np.ndarray) -> _Beside:
        """What effects leave, that take (P, K, e) of the candidates and (e,) of the readings."""
        return _Beside(self.gram - _products(taken), self.inner - (taken @ seen).ravel())


def _apart(posterior: Posterior) -> tuple[np.ndarray, np.ndarray]:
    """What the effects of a posterior take of columns and readings, beside its members.

    Products of the first, (r, e), with white columns; the second, (e,), for the readings. Effects
    that do the same are one.

    Source: derived here: of 1 + E^T E = V (1 + m) V^T, E V (1 + m)^-1/2 where m is not zero.
    """
    members, root, own = posterior.members, posterior.bordered, posterior.effects.columns
    k = members.sizes.factor
    squared, axes = np.linalg.eigh(root.own @ root.own.T)
    there = squared > 1.0 + _NOTHING * max(squared[-1:].max(initial=0.0), 1.0)
    axes = axes[:, there] / np.sqrt(squared[there])
    amount = np.zeros((len(own.cross), axes.shape[1]))
    amount[members.here] = members.given_back(root.border @ axes)
    white = own.summed(axes) / k - posterior.base.z @ amount
    return white / k, axes.T @ (root.own @ root.seen_effects)


def _each_apart(posterior: Posterior, effects: Sequence[Columns]) -> list[_Taken]:
    """The same of each of several effects more, beside a posterior; products with columns in mm."""
    together, base = Columns.joined(effects), posterior.base
    gram, seen = posterior.products(together)
    back = base.back(posterior.left_of(together))
    ends, found = np.cumsum([0, *map(len, effects)]).tolist(), []
    for own in itertools.starmap(slice, itertools.pairwise(ends)):
        squared, axes = np.linalg.eigh(gram[own, own] + np.eye(own.stop - own.start))
        axes = axes / np.sqrt(squared)
        found.append((back[:, own] @ axes, axes.T @ seen[own]))
    return found


def _at_once(rows: Sequence[np.ndarray], many: int) -> Iterator[np.ndarray]:
    """Rows (P K, n) of several candidates, so many at once."""
    few: list[np.ndarray] = []
    for own in rows:
        for k in range(0, len(own), many):
            some = own[k : k + many]
            if few and sum(map(len, few)) + len(some) > many:
                yield _joined(few)
                few = []
            few.append(some)
    yield _joined(few)


def _joined(rows: list[np.ndarray]) -> np.ndarray:
    """One behind the other; a single one shares its memory."""
    return rows[0] if len(rows) == 1 else np.concatenate(rows)


def _products(rows: np.ndarray) -> np.ndarray:
    """Of the rows (P, K, n) of each place with each other, (P, K, K)."""
    if rows.shape[1] == 1:
        return np.einsum("pkn,pkn->pk", rows, rows)[:, :, None]
    return np.matmul(rows, rows.transpose(0, 2, 1))
