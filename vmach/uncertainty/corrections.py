"""Corrections of estimates: what may be wrong by how much, and what it does to P quantities.

A table, a measuring point, a fitted parameter are estimates. The quantity that is drawn is the
correction which each would need; it has the mean zero and the estimate's uncertainty. So the
values are those that the deviation may have, given what is known (JCGM 101, 5.1), and not those
that a repetition of the measurement would lead to.

Source: JCGM 101:2008, 6.4.7 (normal), 6.4.9 (t-distribution); JCGM 100:2008, eq. 13.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vmach.uncertainty.tables import STATED, Pool

__all__ = ["Corrections", "Part"]

#: a cause that moves no quantity by more is left out, mm
_BLIND_MM = 1e-12


@dataclass(frozen=True)
class Part:
    """Corrections of one thing.

    Attributes
    ----------
    label : str
    signature_mm : (P, Q) float64
        For one standard uncertainty of each.
    pool : Pool
    curved_mm : (P, Q, Q) float64 or None
        Factor of the product of two of them, the lower triangle; of second order.
    """

    label: str
    signature_mm: np.ndarray
    pool: Pool = STATED
    curved_mm: np.ndarray | None = None


@dataclass(frozen=True)
class Corrections:
    """All corrections that P quantities feel.

    Attributes
    ----------
    labels : tuple of str
        Of every column.
    pools : tuple of Pool
        Of every column.
    signature_mm : (P, Q) float64
    pairs : (R, 2) int64
        Columns whose product acts.
    curved_mm : (P, R) float64
    """

    labels: tuple[str, ...]
    pools: tuple[Pool, ...]
    signature_mm: np.ndarray
    pairs: np.ndarray
    curved_mm: np.ndarray

    @classmethod
    def of(cls, parts: Sequence[Part], count: int, *, has_all: bool = False) -> Corrections:
        """Put parts side by side; `count` quantities. `has_all` keeps what moves none of them."""
        labels, pools, straight = [], [], [np.zeros((count, 0))]
        pairs, curved = [np.zeros((0, 2), int)], [np.zeros((count, 0))]
        for part in parts:
            if part.curved_mm is not None:
                first, second = np.tril_indices(part.signature_mm.shape[1])
                pairs.append(len(labels) + np.stack([first, second], axis=1))
                curved.append(part.curved_mm[:, first, second])
            labels += [part.label] * part.signature_mm.shape[1]
            pools += [part.pool] * part.signature_mm.shape[1]
            straight.append(part.signature_mm)
        found = cls(tuple(labels), tuple(pools), np.hstack(straight), np.vstack(pairs),
                    np.hstack(curved))  # fmt: skip
        return found if has_all else found._that_act()

    def _that_act(self) -> Corrections:
        """Without the columns that move nothing."""
        acts = np.abs(self.signature_mm).max(axis=0, initial=0.0) > _BLIND_MM
        acts[self.pairs.ravel()] = True
        number = np.cumsum(acts) - 1
        kept = np.flatnonzero(acts)
        return Corrections(
            tuple(self.labels[k] for k in kept),
            tuple(self.pools[k] for k in kept),
            np.ascontiguousarray(self.signature_mm[:, kept]),
            number[self.pairs],
            self.curved_mm,
        )

    def __len__(self) -> int:
        return len(self.signature_mm)

    def rows(self, rows: slice) -> Corrections:
        """The same for some of the quantities."""
        return Corrections(
            self.labels, self.pools, self.signature_mm[rows], self.pairs, self.curved_mm[rows]
        )

    @property
    def u_mm(self) -> np.ndarray:
        """Combined standard uncertainty of first order, (P,) (GUM eq. 13)."""
        return np.sqrt(np.square(self.signature_mm).sum(axis=1))

    def for_drawing(self) -> Corrections:
        """The same distribution of the quantities from as few columns as can make it.

        Normal columns of a pool may be turned among themselves: of Q columns on P < Q quantities
        P are left. Columns whose products act stay as they are.
        """
        alone = np.ones(len(self.labels), dtype=bool)
        alone[self.pairs.ravel()] = False
        kept = np.flatnonzero(~alone)
        labels, pools = [self.labels[k] for k in kept], [self.pools[k] for k in kept]
        parts = [self.signature_mm[:, kept]]
        for pool in dict.fromkeys(self.pools):
            own = [k for k in np.flatnonzero(alone) if self.pools[k] == pool]
            part = self.signature_mm[:, own]
            if len(own) > len(self):
                part = np.linalg.qr(part.T, mode="r").T
            parts.append(part)
            labels += [pool.name] * part.shape[1]
            pools += [pool] * part.shape[1]
        place = np.cumsum(~alone) - 1
        return Corrections(
            tuple(labels), tuple(pools), np.hstack(parts), place[self.pairs], self.curved_mm
        )

    def variance_by_label(self) -> dict[str, np.ndarray]:
        """Variance of first order that each label adds, (P,) mm2."""
        found: dict[str, np.ndarray] = {}
        for label in dict.fromkeys(self.labels):
            own = [k for k, name in enumerate(self.labels) if name == label]
            found[label] = np.square(self.signature_mm[:, own]).sum(axis=1)
        return found

    def draw(self, random: np.random.Generator, count: int) -> np.ndarray:
        """Corrections in their standard uncertainties, (Q, count)."""
        drawn = random.standard_normal((len(self.labels), count))
        for pool in dict.fromkeys(self.pools):
            if np.isfinite(pool.degrees_of_freedom):
                own = [k for k, one in enumerate(self.pools) if one == pool]
                chi = random.chisquare(pool.degrees_of_freedom, count)
                drawn[own] *= np.sqrt(pool.degrees_of_freedom / chi)
        return drawn

    def values_mm(self, drawn: np.ndarray) -> np.ndarray:
        """What drawn corrections (Q, M) do to the quantities, (P, M) mm."""
        moved = self.signature_mm @ drawn
        if len(self.pairs):
            moved += self.curved_mm @ (drawn[self.pairs[:, 0]] * drawn[self.pairs[:, 1]])
        return moved
