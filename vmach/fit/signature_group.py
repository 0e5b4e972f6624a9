"""Signatures of candidates with equally many coefficients, as products that an explanation changes.

Only inner products of the signatures with each other, with the members' columns and with the
readings enter. Those with the members are worked out when members are first there; effects change
all of them by a matrix of low rank.

Source: closed form derived here: what normal variables of unit variance take of inner products.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vmach.fit.base import Base, SizedMembers
from vmach.fit.evidence import Evidence, evidence_at_places
from vmach.fit.remembered import Remembered

__all__ = ["CACHED", "SignatureGroup", "Taken"]

#: numbers that are worked on together, so few that they stay near the processor
CACHED = 200_000
#: numbers up to which signatures are kept wide, 32 MB
_KEPT_WIDE = 4_000_000
#: sizes of members beside which products are kept: those of an explanation, and little ones
_SIZES = 3
#: what an effect takes: its products with columns in mm, (n, e), and of the readings, (e,)
Taken = tuple[np.ndarray, np.ndarray]


class SignatureGroup:
    """Candidates with equally many coefficients K, at P places in all.

    Parameters
    ----------
    base : Base
    raw_mm : sequence of (m, n) float32 or float64
        All their signatures: candidate by candidate, place by place, the rows of each together.
    log_priors : sequence of (G,) float64
        Of the places of each candidate.
    terms : int
        K.
    """

    def __init__(
        self,
        base: Base,
        raw_mm: Sequence[np.ndarray],
        log_priors: Sequence[np.ndarray],
        terms: int,
    ) -> None:
        self._base, self._log_priors, self._terms = base, log_priors, terms
        self._rows = list(_at_once(raw_mm, terms * max(CACHED // (terms * len(base.survey)), 1)))
        if sum(rows.size for rows in self._rows) < _KEPT_WIDE:
            self._rows = [rows.astype(np.float64, copy=False) for rows in self._rows]
        parts = [self._beside_nuisance(rows) for rows in self._rows]
        self._gram, self._seen = map(np.concatenate, zip(*parts, strict=True))
        # products with members' columns: only of those that were there
        self._with_members = np.zeros((len(base.member_of), len(self._seen)))
        self._is_known = np.zeros(len(base.member_of), dtype=bool)
        self._beside = Remembered[_Beside](_SIZES)

    def _beside_nuisance(self, rows_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Products of rows (m, n) with those of the same place, (m / K, K, K), and readings."""
        base, rows = self._base, self._base.noise.white(rows_mm.T).T
        # readings are without what the nuisance can explain: so are their products
        free, seen = np.split(rows @ np.column_stack([base.free, base.y]), [-1], axis=1)
        return _products(self._by_place(rows)) - _products(self._by_place(free)), seen[:, 0]

    def evidence(self, members: SizedMembers, back: np.ndarray, seen: np.ndarray) -> Evidence:
        """Evidence of each; rows times `back` (n, e) are what effects take of them.

        What they take of the readings is `seen`, (e,).
        """
        return self._evidence(self._left(members, back, seen))

    def _evidence(self, left: _Beside) -> Evidence:
        """Of each, from products."""
        return evidence_at_places(left.gram, self._by_place(left.inner[:, None]), self._log_priors)

    def beside_each(
        self, members: SizedMembers, effects: Taken, more: Sequence[Taken]
    ) -> np.ndarray:
        """Log factors of each beside effects, as above, and one effect more of F, (F, C)."""
        left, found = self._left(members, *effects), []
        every = np.concatenate([back for back, _ in more], axis=1)
        together = self._times(every)
        ends = np.cumsum([len(seen) for _, seen in more])[:-1]
        for taken, (_, seen) in zip(np.split(together, ends, axis=1), more, strict=True):
            found.append(self._evidence(left.without(self._by_place(taken), seen)).log_factor[:, 0])
        return np.array(found)

    def _left(self, members: SizedMembers, back: np.ndarray, seen: np.ndarray) -> _Beside:
        """What members and effects leave."""
        beside = self._beside.get(members.sizes, lambda: self._beside_members(members))
        return beside.without(self._by_place(self._times(back)), seen)

    def _times(self, columns: np.ndarray) -> np.ndarray:
        """All rows times columns (n, k), (P K, k)."""
        return np.concatenate([r.astype(np.float64, copy=False) @ columns for r in self._rows])

    def _beside_members(self, members: SizedMembers) -> _Beside:
        """What is left beside members alone."""
        new = members.here[~self._is_known[members.here]]
        if len(new):
            self._with_members[new] = self._times(self._base.back(self._base.z[:, new])).T
            self._is_known[new] = True
        k, taken = members.sizes.factor, members.taken(self._with_members)
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
