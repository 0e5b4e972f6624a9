"""Signatures of many candidates, weighed together beside members and effects.

Those with equally many coefficients make a group, whose products are worked out once for a survey.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from vmach.fit.base import Base
from vmach.fit.candidates import Candidate
from vmach.fit.columns import Columns
from vmach.fit.evidence import Evidence
from vmach.fit.marginal_likelihood import Posterior
from vmach.fit.signature_group import SignatureGroup, Taken

__all__ = ["Bank", "apart"]

#: share of the largest variance of effects that is none
_NOTHING = 1e-14


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
        self._are_curves = [is_curve for _, is_curve in groups]
        self._groups = [
            SignatureGroup(
                base,
                [candidates[c].rows_mm for c in own],
                [candidates[c].log_prior for c in own],
                terms,
            )
            for (terms, _), own in groups.items()
        ]

    def evidence(self, posterior: Posterior) -> Evidence:
        """Evidence of every candidate beside members and effects of a posterior."""
        white, seen = apart(posterior)
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
        white, seen = apart(posterior)
        back, more = self._base.back(white), _each_apart(posterior, firsts)
        found = np.full((len(firsts), len(self._place)), -np.inf)
        each = zip(self._groups, self._listed, self._are_curves, strict=True)
        for group, own, are_curves in each:
            if not are_curves:
                found[:, own] = group.beside_each(posterior.members, (back, seen), more)
        return found


def apart(posterior: Posterior) -> tuple[np.ndarray, np.ndarray]:
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


def _each_apart(posterior: Posterior, effects: Sequence[Columns]) -> list[Taken]:
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
