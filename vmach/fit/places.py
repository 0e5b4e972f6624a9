"""Signatures of an effect at many places, by what changes from each place to the next.

A shift at one moment changes the readings between two moments only, so products of all places
with other columns cost little more than those of one.

Source: derived here: a signature is the sum of the changes up to it, and products are linear.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_array, vstack

from vmach.effects import Effect

if TYPE_CHECKING:
    from vmach.fit.base import Base

__all__ = ["Inner", "Places", "Step", "steps_along"]

#: numbers of signatures that are made white together
_AT_ONCE = 1_000_000
#: inner parameters, by name
Inner = tuple[tuple[str, float], ...]


@dataclass(frozen=True, eq=False)
class Step:
    """From one place to the next; K columns.

    Attributes
    ----------
    change_mm : (K, n) sparse
    cross : (K, q) float64
        Of the change with the members' columns.
    seen : (K,) float64
        With the readings.
    gram : (K, K) float64
        Of the signature at the next place with itself.
    """

    change_mm: csr_array
    cross: np.ndarray
    seen: np.ndarray
    gram: np.ndarray

    @property
    def size(self) -> int:
        """Numbers that it takes up."""
        return 2 * self.change_mm.nnz + self.cross.size


class Places:
    """Signatures of K columns each at U places.

    Parameters
    ----------
    back : callable
        White columns (n, e) by the transpose of the map that makes signatures white.
    steps : sequence of Step
        To the first place and on from each to the next.
    which : (G,) int
        Which of them each of G places is like that were asked for.

    Attributes
    ----------
    cross, seen : (q, U K), (U K,) float64
        Products with the members' columns and with the readings.
    gram : (U, K, K) float64
    """

    def __init__(
        self,
        back: Callable[[np.ndarray], np.ndarray],
        steps: Sequence[Step],
        which: np.ndarray,
    ) -> None:
        self._back, self.which = back, which
        self.gram = np.stack([step.gram for step in steps])
        self._changes = csr_array(vstack([step.change_mm for step in steps]))
        self.cross = self._summed(np.concatenate([step.cross for step in steps])).T
        self.seen = self._summed(np.concatenate([step.seen for step in steps])[:, None])[:, 0]

    def with_columns(self, white: np.ndarray) -> np.ndarray:
        """Products with white columns (n, e), which nuisance cannot explain, (e, U K)."""
        return self._summed(self._changes @ self._back(white)).T

    def _summed(self, of_changes: np.ndarray) -> np.ndarray:
        """Products of places (U K, m) from those of changes."""
        by_place = of_changes.reshape(*self.gram.shape[:2], of_changes.shape[1])
        return np.cumsum(by_place, axis=0).reshape(of_changes.shape)


def steps_along(
    base: Base, effect: Effect, target: str, pairs: Sequence[tuple[Inner | None, Inner]]
) -> list[Step]:
    """Steps from inner parameters to others; from nothing where there are none before."""
    members, readings = (base.back(c) if pairs else c for c in (base.z, base.y[:, None]))
    many = max(_AT_ONCE // len(base.y), 1)
    found = []
    here: tuple[Inner | None, np.ndarray | float] = None, 0.0
    for k in range(0, len(pairs), many):
        changes, signatures = [], []
        for before, after in pairs[k : k + many]:
            if before != here[0]:
                here = before, base.survey.signature(effect, target, dict(before or ()))
            columns = base.survey.signature(effect, target, dict(after))
            changes.append(csr_array((columns - here[1]).T))
            signatures.append(columns.T)
            here = after, columns
        rows = base.white(np.concatenate(signatures).T).T
        for change, own in zip(changes, np.split(rows, len(changes)), strict=True):
            found.append(Step(change, change @ members, (change @ readings)[:, 0], own @ own.T))
    return found
