"""Where and in which directions the place of the tool counts, and what is left there.

Source: closed form derived here: to first order a shift s of the tool changes the deviation by n
. s.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vmach.compensation.aim.part_view import PartDeviation
from vmach.compensation.written_run import WrittenRun
from vmach.path.geometry import tangent_at

__all__ = ["Probes", "near_surface", "path_probes", "surface_probes"]

#: distance of the places on the path, and how many a piece has
_SPACING_MM = 2.0
_FEWEST, _MOST = 3, 40
#: way within which surface tells what a place of the path makes, and what counts without any
_NEAR_MM = 2.0
_UNSEEN = 0.2
_NO_LENGTH_MM = 1e-9
_INSIDE = 1.0 - 1e-9
#: places that are looked at in one go
_AT_ONCE = 1 << 18


@dataclass(frozen=True)
class Probes:
    """P places of the nominal path with a direction each.

    Attributes
    ----------
    move : (P,) int64
        Nominal moves.
    parameter : (P,) float64
    normal : (P, 3) float64
        Unit vectors, machine axes.
    left_mm : (P,) float64
        Deviation along them before rounding.
    path_length_mm : (P,) float64
        Way of the path that each stands for.
    only_below : (P,) bool
        Counts where it is negative: where it is not, another move leaves less.
    """

    move: np.ndarray
    parameter: np.ndarray
    normal: np.ndarray
    left_mm: np.ndarray
    path_length_mm: np.ndarray
    only_below: np.ndarray

    @cached_property
    def key(self) -> np.ndarray:
        """Number of the move plus parameter, (P,), the latter below 1: in order of the path."""
        return self.move + np.minimum(self.parameter, _INSIDE)

    def in_order(self) -> Probes:
        """The same along the path."""
        if (self.key[1:] >= self.key[:-1]).all():
            return self
        order = np.argsort(self.key, kind="stable")
        return Probes(*(getattr(self, name)[order] for name in self.__dataclass_fields__))

    def part(self, rows: slice) -> Probes:
        """Some of them."""
        return Probes(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))

    def beside(self, others: Probes) -> Probes:
        """These and others along the path, these first where they are at one place."""
        order = np.argsort(np.concatenate([self.key, others.key]), kind="stable")
        names = self.__dataclass_fields__
        return Probes(
            *(np.concatenate([getattr(self, n), getattr(others, n)])[order] for n in names)
        )


def path_probes(run: WrittenRun) -> Probes:
    """Two directions across the path at places of every piece that cuts.

    Parameters
    ----------
    run : WrittenRun
        Before rounding.
    """
    plan, moves = run.plan, run.again.path.nodes.moves
    cuts = run.cuts[~plan.is_step[run.written[run.cuts]]]
    length = np.linalg.norm(tangent_at(moves, run.row[cuts], np.zeros(len(cuts))), axis=1)
    cuts, length = cuts[length > _NO_LENGTH_MM], length[length > _NO_LENGTH_MM]
    count = np.clip(np.ceil(length / _SPACING_MM).astype(np.int64), _FEWEST, _MOST)
    rows = np.repeat(cuts, count)
    number = np.arange(len(rows)) - np.repeat(np.cumsum(count) - count, count)
    at = (number + 0.5) / np.repeat(count, count)
    sides = _across(tangent_at(moves, run.row[rows], at))
    left = np.einsum("psi,pi->ps", sides, run.miss(at, rows))
    piece = run.written[rows]
    first, last = plan.parameter(0.0)[piece], plan.parameter(1.0)[piece]
    return Probes(
        move=np.repeat(plan.move[piece], 2),
        parameter=np.repeat(first + at * (last - first), 2),
        normal=sides.reshape(-1, 3),
        left_mm=left.ravel(),
        path_length_mm=np.repeat(length / count, count).repeat(2),
        only_below=np.zeros(2 * len(rows), bool),
    )


def near_surface(path: Probes, surface: Probes, length_mm: np.ndarray) -> Probes:
    """Probes of the path that count as far as the surface does which is made near them.

    Points of a surface are a sample: blocks that are shorter than its spacing may have none. What
    their neighbours make, they make as well.

    Parameters
    ----------
    path, surface : Probes
    length_mm : (M,) float64
        Of the moves.
    """
    before_mm = np.cumsum(length_mm) - length_mm
    surface = surface.in_order()
    here, there = (before_mm[p.move] + p.parameter * length_mm[p.move] for p in (path, surface))
    first, last = (np.searchsorted(there, here + way) for way in (-_NEAR_MM, _NEAR_MM))
    pairs = np.einsum("pi,pj->pij", surface.normal, surface.normal)
    total = np.concatenate([np.zeros((1, 3, 3)), np.cumsum(pairs, axis=0)])
    seen = np.empty(len(first))
    for begin in range(0, len(seen), _AT_ONCE):
        part = slice(begin, begin + _AT_ONCE)
        seen[part] = np.einsum("pij,pi,pj->p", total[last[part]] - total[first[part]],
                               path.normal[part], path.normal[part])  # fmt: skip
    share = _UNSEEN + (1.0 - _UNSEEN) * seen / np.maximum(last - first, 1)
    return replace(path, path_length_mm=share * path.path_length_mm)


def surface_probes(
    deviation: PartDeviation, normal: np.ndarray, *, left_mm: np.ndarray, path_length_mm: float,
    only_below: bool = False,
) -> Probes:  # fmt: skip
    """The normals of surface points where the tool makes them.

    Parameters
    ----------
    deviation : PartDeviation
    normal : (Q, 3) float64
    left_mm : (Q,) float64
        Before rounding.
    path_length_mm : float
        Way of the path for every point.
    only_below : bool
        The points are made by other moves unless these go deeper.
    """
    count = len(deviation.row)
    return Probes(deviation.move, deviation.parameter, normal, left_mm,
                  np.full(count, path_length_mm), np.full(count, only_below))  # fmt: skip


def _across(tangent: np.ndarray) -> np.ndarray:
    """Two unit vectors across every tangent, (P, 2, 3)."""
    along = tangent / np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), _NO_LENGTH_MM)
    one = np.cross(along, np.eye(3)[np.argmin(np.abs(along), axis=1)])
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    return np.stack([one, np.cross(along, one)], axis=1)
