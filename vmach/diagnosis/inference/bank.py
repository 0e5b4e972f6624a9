"""Signatures of many candidates, weighed together beside members and effects.

Only inner products of the signatures with each other, with the members' columns and with the
readings enter. They are worked out once for a survey; an explanation changes them by a matrix of
low rank.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vmach.fit.base import Base, SizedMembers, solved
from vmach.fit.candidates import Candidate
from vmach.fit.evidence import Evidence, evidence_at_places
from vmach.fit.marginal_likelihood import Bordered, Posterior
from vmach.fit.means import Means
from vmach.fit.sizes import Sizes

__all__ = ["Bank"]

#: numbers that are widened together, so few that they stay near the processor
_CACHED = 200_000
#: numbers that white signatures may take up
_ROOM = 2_000_000


class Bank:
    """Candidates over one base.

    Parameters
    ----------
    base : Base
    candidates : sequence of Candidate
    """

    def __init__(self, base: Base, candidates: Sequence[Candidate]) -> None:
        self._base = base
        # candidates with equally many coefficients are weighed together
        groups: dict[int, list[int]] = {}
        for c, candidate in enumerate(candidates):
            groups.setdefault(candidate.at_sites_mm.shape[2], []).append(c)
        listed = [c for members in groups.values() for c in members]
        self._place = np.argsort(np.array(listed, dtype=int))
        self._groups = [_Group(base, [candidates[c] for c in g], k) for k, g in groups.items()]

    def evidence(self, posterior: Posterior) -> Evidence:
        """Evidence of every candidate beside members and effects of a posterior."""
        back = self._base.back(posterior.effects.columns.white)
        parts = [g.evidence(posterior.members, posterior.bordered, back) for g in self._groups]
        return Evidence.joined(parts, self._place)


class _Group:
    """Candidates with equally many coefficients K, at P places in all."""

    def __init__(self, base: Base, candidates: Sequence[Candidate], terms: int) -> None:
        self._log_priors = [c.log_prior for c in candidates]
        self._terms = terms
        self._rows_of = base.rows_of
        raw = [candidate.rows_mm for candidate in candidates]
        parts, means = [], []
        wide = max(len(base.survey) if base.pooled is None else 0, *(r.shape[1] for r in raw))
        for some in _at_once(raw, terms * max(_ROOM // (terms * wide), 1)):
            rows = base.white(some.T).T
            if isinstance(base.noise, Means):
                means.append(rows.astype(np.float32))
            parts.append((rows @ base.z, rows @ base.y, _products(self._by_place(rows))))
        # means are few: they are kept white
        self._rows = means or _side_by_side(raw)
        self._with_members, self._seen, self._gram = map(np.concatenate, zip(*parts, strict=True))
        self._beside: tuple[Sizes, _Beside] | None = None

    def evidence(self, members: SizedMembers, root: Bordered, back: np.ndarray) -> Evidence:
        """Evidence of each; rows times `back` (n, k) are products with the posterior's effects."""
        k, beside = members.sizes.factor, self._beside_members(members)
        with_effects = np.concatenate([self._times(rows, back) for rows in self._rows])
        taken = solved(root.own, with_effects.T / k - root.border.T @ beside.taken)
        inner = beside.inner - taken.T @ root.seen_effects / k
        gram = beside.gram - _products(self._by_place(taken.T)) / k**2
        return evidence_at_places(gram, self._by_place(inner[:, None]), self._log_priors)

    def _times(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Rows (m, n) times columns (n, k), some at a time where they have to be widened first."""
        many = max(_CACHED // max(len(columns), 1), 1)
        found = np.empty((len(rows), columns.shape[1]))
        for k in range(0, len(rows), many):
            some = rows[k : k + many].astype(np.float64, copy=False)
            if some.shape[1] != len(columns):
                some = self._rows_of(some.T).T
            found[k : k + many] = some @ columns
        return found

    def _beside_members(self, members: SizedMembers) -> _Beside:
        """What is left beside members alone; the last is remembered."""
        if self._beside is None or self._beside[0] != members.sizes:
            k, taken = members.sizes.factor, members.taken(self._with_members.T)
            gram = (self._gram - _products(self._by_place(taken.T))) / k**2
            inner = self._seen / k**2 - taken.T @ members.seen / k
            self._beside = members.sizes, _Beside(taken, gram, inner)
        return self._beside[1]

    def _by_place(self, rows: np.ndarray) -> np.ndarray:
        """Rows (P K, n) as (P, K, n)."""
        return rows.reshape(len(rows) // self._terms, self._terms, rows.shape[1])


@dataclass(frozen=True)
class _Beside:
    """Products of candidates beside members of given sizes.

    Attributes
    ----------
    taken : (p, P K) float64
        What the members take, by their root.
    gram : (P, K, K) float64
    inner : (P K,) float64
        With the readings.
    """

    taken: np.ndarray
    gram: np.ndarray
    inner: np.ndarray


def _side_by_side(rows: list[np.ndarray]) -> list[np.ndarray]:
    """Rows of several candidates together; those of float32 are kept by the candidates anyway."""
    kinds = {(own.dtype, own.shape[1]) for own in rows}
    return [np.concatenate(rows)] if kinds == {(np.float64, rows[0].shape[1])} else rows


def _at_once(rows: Sequence[np.ndarray], many: int) -> Iterator[np.ndarray]:
    """Rows (P K, n) of several candidates, so many at once."""
    few: list[np.ndarray] = []
    for own in rows:
        for k in range(0, len(own), many):
            some = own[k : k + many]
            # some are at readings, others at sites
            if few and (sum(map(len, few)) + len(some) > many or few[0].shape[1] != some.shape[1]):
                yield np.concatenate(few)
                few = []
            few.append(some)
    yield np.concatenate(few)


def _products(rows: np.ndarray) -> np.ndarray:
    """Of the rows (P, K, n) of each place with each other, (P, K, K)."""
    if rows.shape[1] == 1:
        return np.einsum("pkn,pkn->pk", rows, rows)[:, :, None]
    return np.matmul(rows, rows.transpose(0, 2, 1))
