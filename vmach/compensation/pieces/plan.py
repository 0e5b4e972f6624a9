"""The plan of a compensated program: the pieces of its moves, and where they shall lead.

Source: closed form derived here: pieces of moves, each with the place that its end shall reach.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vmach.program_text import Piece

__all__ = ["Plan"]


@dataclass(frozen=True)
class Plan:
    """Pieces of the whole program, and where they shall lead.

    Attributes
    ----------
    pieces : list of Piece
    aim_mm : (K, 3) float64
        Where the tool shall be at their ends, from the nominal path: within the tolerance, so
        that fewer pieces do. The middles of arcs shall be on the nominal path.
    """

    pieces: list[Piece]
    aim_mm: np.ndarray

    @cached_property
    def move(self) -> np.ndarray:
        """Nominal moves of the pieces, (K,) int64."""
        return np.array([p.move for p in self.pieces], np.int64)

    def parameter(self, share: float) -> np.ndarray:
        """Parameters of the nominal moves at a share of the pieces, (K,)."""
        return np.array([p.start + share * (p.end - p.start) for p in self.pieces], np.float64)

    @cached_property
    def answered(self) -> np.ndarray:
        """Parameters of the nominal moves whose error the ends of the pieces answer, (K,)."""
        return np.where(self.is_step, [p.settled for p in self.pieces], self.parameter(1.0))

    @cached_property
    def is_kept(self) -> np.ndarray:
        """Pieces whose blocks stay, (K,) bool."""
        return np.array([p.kept for p in self.pieces], bool)

    @cached_property
    def is_step(self) -> np.ndarray:
        """Pieces without way along the path, (K,) bool."""
        return np.array([p.is_step for p in self.pieces], bool)

    @cached_property
    def ready(self) -> np.ndarray:
        """Share of every piece, (K,), from which on the error is there that its step answers."""
        share = np.zeros(len(self.pieces))
        for k in np.flatnonzero(self.is_step[:-1]):
            step, following = self.pieces[k], self.pieces[k + 1]
            span = following.end - following.start
            if span > 0:
                share[k + 1] = min((step.settled - step.start) / span, 0.5)
        return share

    def refined(self, split: np.ndarray, step: np.ndarray) -> tuple[Plan, np.ndarray]:
        """The plan with some pieces halved, and steps before others.

        Parameters
        ----------
        split, step : (K,) bool

        Returns
        -------
        Plan
        (L,) int64
            The old piece that every new one comes from; -1 - k for one that ends inside or
            before the old piece k.
        """
        pieces: list[Piece] = []
        origin: list[int] = []
        for k, piece in enumerate(self.pieces):
            start = piece.start
            if step[k]:
                pieces.append(Piece(piece.move, start, start, settled=start))
                origin.append(-1 - k)
            if split[k]:
                middle = 0.5 * (start + piece.end)
                pieces.append(Piece(piece.move, start, middle, is_arc=piece.is_arc))
                origin.append(-1 - k)
                piece = Piece(piece.move, middle, piece.end, is_arc=piece.is_arc)
            pieces.append(piece)
            origin.append(k)
        old = np.array(origin, np.int64)
        aim = np.where((old >= 0)[:, None], self.aim_mm[np.maximum(old, 0)], 0.0)
        return Plan(pieces, aim), old
