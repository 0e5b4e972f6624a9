"""Signatures of many candidates, weighed together beside members and effects.

Only inner products of the signatures with each other, with the members' columns and with the
readings enter. They are worked out once for a survey; an explanation changes them by a matrix of
low rank.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.linalg import solve_triangular

from vmach.fit.candidates import Candidate
from vmach.fit.evidence import Evidence, evidence_at_places
from vmach.fit.marginal_likelihood import Base, Posterior

__all__ = ["Bank"]

#: numbers that white signatures may take up
_ROOM = 10_000_000


class Bank:
    """Candidates over one base.

    Parameters
    ----------
    base : Base
    candidates : sequence of Candidate
    """

    def __init__(self, base: Base, candidates: Sequence[Candidate]) -> None:
        self._base, self._candidates = base, list(candidates)
        shapes = [c.signatures_mm.shape[1:] for c in candidates]
        # candidates with equally many coefficients lie side by side
        order = sorted(range(len(shapes)), key=lambda c: shapes[c][1])
        self._columns = [candidates[c].signatures_mm.reshape(len(base.y), -1) for c in order]
        sizes = [shapes[c][0] * shapes[c][1] for c in order]
        starts = np.cumsum([0, *sizes])
        self._first = {c: int(start) for c, start in zip(order, starts[:-1], strict=True)}
        self._shapes = shapes
        self._members: dict[int, list[int]] = {}
        for c in order:
            self._members.setdefault(shapes[c][1], []).append(c)
        self._with_members, self._seen = (
            np.zeros((starts[-1], base.z.shape[1])),
            np.zeros(starts[-1]),
        )
        self._gram = {k: np.zeros((0, k, k)) for k in self._members}
        for some in self._batches():
            own = slice(self._first[order[some[0]]], starts[some[-1] + 1])
            rows = base.white(np.hstack([self._columns[c] for c in some])).T
            self._with_members[own], self._seen[own] = rows @ base.z, rows @ base.y
            terms = shapes[order[some[0]]][1]
            new = _products(rows.reshape(-1, terms, rows.shape[1]))
            self._gram[terms] = np.concatenate([self._gram[terms], new])

    def _batches(self) -> Iterator[list[int]]:
        """Candidates, as they lie, whose signatures are whitened together."""
        order = [c for members in self._members.values() for c in members]
        room = _ROOM // max(len(self._base.y), 1)
        start = 0
        while start < len(order):
            end, width = start + 1, self._columns[start].shape[1]
            while end < len(order) and self._shapes[order[end]][1] == self._shapes[order[start]][1]:
                width += self._columns[end].shape[1]
                if width > room:
                    break
                end += 1
            yield list(range(start, end))
            start = end

    def evidence(self, posterior: Posterior) -> Evidence:
        """Evidence of every candidate beside members and effects of a posterior."""
        k, effects = posterior.sizes.factor, posterior.effects
        back = self._base.back(effects.x)
        with_effects = np.concatenate(
            [np.zeros((0, back.shape[1])), *(c.T @ back for c in self._columns)]
        )
        here, root, mean = posterior.present
        split = np.searchsorted(here, self._with_members.shape[1])
        of_members = self._with_members[:, here[:split]]
        shared = np.hstack([of_members, with_effects]) * posterior.scale[here]
        inner = (self._seen - k * (shared @ mean)) / k**2
        taken = solve_triangular(root, shared.T, lower=True, check_finite=False, overwrite_b=True).T
        found = []
        for terms, members in self._members.items():
            part = self._part(taken, terms)
            gram = (self._gram[terms] - _products(part)) / k**2
            priors = [self._candidates[c].log_prior for c in members]
            here = self._part(inner[:, None], terms)
            found.append(evidence_at_places(gram, here, priors))
        listed = [c for members in self._members.values() for c in members]
        return Evidence.joined(found, np.argsort(listed))

    def _part(self, rows: np.ndarray, terms: int) -> np.ndarray:
        """Rows of the candidates with so many coefficients, (places, coefficients, ...)."""
        members = self._members[terms]
        end = self._first[members[-1]] + int(np.prod(self._shapes[members[-1]]))
        return rows[self._first[members[0]] : end].reshape(-1, terms, rows.shape[1])


def _products(rows: np.ndarray) -> np.ndarray:
    """Of the rows (P, K, n) of each place with each other, (P, K, K)."""
    if rows.shape[1] == 1:
        return np.einsum("pkn,pkn->pk", rows, rows)[:, :, None]
    return np.matmul(rows, rows.transpose(0, 2, 1))
