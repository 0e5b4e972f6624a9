"""The plan of a compensated program: the pieces of its moves, and where they shall lead.

Source: closed form derived here: pieces of moves, each with the place that its end shall reach.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vmach.program_text import Pieces

__all__ = ["Plan"]


@dataclass(frozen=True)
class Plan:
    """Pieces of the whole program, and where they shall lead.

    Attributes
    ----------
    pieces : Pieces
    aim_mm : (K, 3) float64
        Where the tool shall be at their ends, from the nominal path: within the tolerance, so
        that fewer pieces do. The middles of arcs shall be on the nominal path.
    """

    pieces: Pieces
    aim_mm: np.ndarray

    @property
    def move(self) -> np.ndarray:
        """Nominal moves of the pieces, (K,) int64."""
        return self.pieces.move

    def parameter(self, share: float) -> np.ndarray:
        """Parameters of the nominal moves at a share of the pieces, (K,)."""
        pieces = self.pieces
        return pieces.start + share * (pieces.end - pieces.start)

    @cached_property
    def first(self) -> np.ndarray:
        """Parameters of the nominal moves at which the pieces begin, (K,)."""
        return self.parameter(0.0)

    @cached_property
    def last(self) -> np.ndarray:
        """The same at which they end."""
        return self.parameter(1.0)

    @cached_property
    def answered(self) -> np.ndarray:
        """Parameters of the nominal moves whose error the ends of the pieces answer, (K,)."""
        return np.where(self.is_step, self.pieces.settled, self.last)

    @property
    def is_kept(self) -> np.ndarray:
        """Pieces whose blocks stay, (K,) bool."""
        return self.pieces.kept

    @cached_property
    def is_step(self) -> np.ndarray:
        """Pieces without way along the path, (K,) bool."""
        return self.pieces.is_step

    @cached_property
    def ready(self) -> np.ndarray:
        """Share of every piece, (K,), from which on the error is there that its step answers."""
        pieces, share = self.pieces, np.zeros(len(self.pieces))
        span = pieces.end - pieces.start
        step = np.flatnonzero(self.is_step[:-1] & (span[1:] > 0.0))
        late = (pieces.settled - pieces.start)[step] / span[step + 1]
        share[step + 1] = np.minimum(late, 0.5)
        return share

    def refined(
        self, split: np.ndarray, step: np.ndarray, ready: np.ndarray
    ) -> tuple[Plan, np.ndarray]:
        """The plan with some pieces halved, and steps before others.

        Parameters
        ----------
        split, step : (K,) bool
        ready : (K,) float64
            Share of a piece at which the error is there in full that its step answers.

        Returns
        -------
        Plan
        (L,) int64
            The old piece that every new one comes from; -1 - k for one that ends inside or
            before the old piece k.
        """
        old, count = self.pieces, 1 + step.astype(np.int64) + split
        owner = np.repeat(np.arange(len(old)), count)
        place = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
        is_step = step[owner] & (place == 0)
        is_last = place == count[owner] - 1
        is_first_half = ~is_step & ~is_last
        middle = (0.5 * (old.start + old.end))[owner]
        start, end = old.start[owner], old.end[owner]
        pieces = Pieces(
            move=old.move[owner],
            start=np.where(is_last & split[owner], middle, start),
            end=np.where(is_step, start, np.where(is_first_half, middle, end)),
            is_arc=old.is_arc[owner] & ~is_step,
            kept=old.kept[owner] & is_last & ~split[owner],
            settled=np.where(is_step, start + ready[owner] * (old.end - old.start)[owner],
                             np.where(split[owner], 0.0, old.settled[owner])),
        )  # fmt: skip
        origin = np.where(is_last, owner, -1 - owner)
        aim = np.where(is_last[:, None], self.aim_mm[owner], 0.0)
        return Plan(pieces, aim), origin
