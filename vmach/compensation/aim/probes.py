"""Where and in which directions the place of the tool counts, and what is left there.

Source: closed form derived here: to first order a shift s of the tool changes the deviation by n
. s.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, reduce
from operator import is_

import numpy as np

from vmach.compensation.aim.part_view import PartDeviation
from vmach.compensation.written_run import WrittenRun
from vmach.path.geometry import tangent_at

__all__ = ["PathPlaces", "ProbeSets", "Probes", "near_surface", "path_probes", "surface_probes"]

#: distance of the places on the path, and how many a piece has
_SPACING_MM = 2.0
_FEWEST, _MOST = 3, 40
#: way within which surface tells what a place of the path makes, and what counts without any
_NEAR_MM = 2.0
_UNSEEN = 0.2
_NO_LENGTH_MM = 1e-9
_INSIDE = 1.0 - 1e-9
#: places that are looked at in one go
_AT_ONCE = 1 << 17
#: pieces whose places are found in one go, or a share of all: directions take a look at all moves
_PIECES_AT_ONCE, _SHARE_AT_ONCE = 1 << 16, 4


@dataclass(frozen=True)
class Probes:
    """P places of the nominal path with a direction each.

    Attributes
    ----------
    move : (P,) int
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
        return _key(self.move, self.parameter)

    def in_order(self) -> Probes:
        """The same along the path."""
        key = _key(self.move, self.parameter)  # not kept: of a long path it takes much memory
        if (key[1:] >= key[:-1]).all():
            return self
        order = np.argsort(key, kind="stable")
        return Probes(*(getattr(self, name)[order] for name in self.__dataclass_fields__))

    def between(self, first: float, stop: float) -> Probes:
        """Those from one `Probes.key` on, before another, of probes in order."""
        rows = _rows_between(self, first, stop)
        return Probes(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))

    def beside(self, others: Probes) -> Probes:
        """These and others along the path, these first where they are at one place."""
        order = np.argsort(np.concatenate([self.key, others.key]), kind="stable")
        names = self.__dataclass_fields__
        return Probes(
            *(np.concatenate([getattr(self, n), getattr(others, n)])[order] for n in names)
        )


@dataclass(frozen=True)
class PathPlaces:
    """Q places along the nominal path, with a probe to either side of two across it.

    What both have in common is kept once, as a long path has millions of them.

    Attributes
    ----------
    move : (Q,) int
    parameter : (Q,) float64
    tangent : (Q, 3) float64
        Of the written path.
    left_mm, path_length_mm : (Q, 2) float64
        As of `Probes`.
    """

    move: np.ndarray
    parameter: np.ndarray
    tangent: np.ndarray
    left_mm: np.ndarray
    path_length_mm: np.ndarray

    def probes(self, rows: slice) -> Probes:
        """Those of some places."""
        move, normal = np.repeat(self.move[rows], 2), _across(self.tangent[rows]).reshape(-1, 3)
        return Probes(move, np.repeat(self.parameter[rows], 2), normal, self.left_mm[rows].ravel(),
                      self.path_length_mm[rows].ravel(), np.zeros(len(move), bool))  # fmt: skip

    def in_order(self) -> PathPlaces:
        """The same: places are found along the path."""
        return self

    def between(self, first: float, stop: float) -> Probes:
        """Those from one `Probes.key` on, before another."""
        return self.probes(_rows_between(self, first, stop))


@dataclass(frozen=True)
class ProbeSets:
    """Sets of probes that go along one path; they are brought together a stretch at a time.

    Those of the path of a million moves take hundreds of MB, which are never copied so.

    Attributes
    ----------
    sets : tuple of Probes or PathPlaces
        Each along the path.
    """

    sets: tuple[Probes | PathPlaces, ...]

    @classmethod
    def of(cls, *sets: Probes | PathPlaces) -> ProbeSets:
        """Sets in any order of their places."""
        return cls(tuple(one.in_order() for one in sets))

    def beside(self, others: Probes) -> ProbeSets:
        """These and others."""
        return ProbeSets((*self.sets, others.in_order()))

    def begin_with(self, others: ProbeSets) -> bool:
        """Whether these are others, with nothing or more beside them."""
        own = self.sets[: len(others.sets)]
        return len(own) == len(others.sets) and all(map(is_, own, others.sets))

    def keys_beyond(self, others: ProbeSets) -> np.ndarray:
        """`Probes.key` in order of all that is beside others that these begin with."""
        sets = self.sets[len(others.sets) :]
        return np.sort(np.concatenate([[], *(_key(one.move, one.parameter) for one in sets)]))

    def between(self, first: float, stop: float) -> Probes:
        """Those from one `Probes.key` on, before another; of one place the earlier set's first."""
        return reduce(Probes.beside, [one.between(first, stop) for one in self.sets])


def _key(move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
    return move + np.minimum(parameter, _INSIDE)


def _rows_between(probes: Probes | PathPlaces, first: float, stop: float) -> slice:
    return slice(_place(probes, first), _place(probes, stop))


def _place(probes: Probes | PathPlaces, key: float) -> int:
    """How many of the probes, which are in order, come before a key."""
    if key == np.inf:
        return len(probes.move)
    move = probes.move.dtype.type(np.floor(key))  # of another kind, all would be converted
    of_move = [probes.move.searchsorted(move, side) for side in ("left", "right")]
    same = slice(*of_move)
    return int(of_move[0] + np.searchsorted(_key(probes.move[same], probes.parameter[same]), key))


def path_probes(run: WrittenRun) -> PathPlaces:
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
    total = int(count.sum())
    found = PathPlaces(
        move=np.empty(total, np.int32), parameter=np.empty(total), tangent=np.empty((total, 3)),
        left_mm=np.empty((total, 2)),
        path_length_mm=np.repeat(length / count, 2 * count).reshape(-1, 2),
    )  # fmt: skip
    done, at_once = 0, max(_PIECES_AT_ONCE, len(cuts) // _SHARE_AT_ONCE + 1)
    for begin in range(0, len(cuts), at_once):
        part = slice(begin, begin + at_once)
        block = slice(done, done + int(count[part].sum()))
        _fill_places(run, cuts[part], count[part], found, block)
        done = block.stop
    return found


def _fill_places(
    run: WrittenRun, cuts: np.ndarray, count: np.ndarray, found: PathPlaces, block: slice
) -> None:
    """Write the places of some pieces; (C,) cuts, places of each."""
    rows = np.repeat(cuts, count)
    number = np.arange(len(rows)) - np.repeat(np.cumsum(count) - count, count)
    at = (number + 0.5) / np.repeat(count, count)
    tangent = tangent_at(run.again.path.nodes.moves, run.row[rows], at)
    piece = run.written[rows]
    first, last = run.plan.first[piece], run.plan.last[piece]
    found.tangent[block] = tangent
    found.left_mm[block] = np.einsum("psi,pi->ps", _across(tangent), run.miss(at, rows))
    found.move[block] = run.plan.move[piece]
    found.parameter[block] = first + at * (last - first)


def near_surface(path: PathPlaces, surface: Probes, length_mm: np.ndarray) -> PathPlaces:
    """Probes of the path that count as far as the surface does which is made near them.

    Points of a surface are a sample: blocks that are shorter than its spacing may have none. What
    their neighbours make, they make as well.

    Parameters
    ----------
    path : PathPlaces
    surface : Probes
    length_mm : (M,) float64
        Of the moves.
    """
    before_mm = np.cumsum(length_mm) - length_mm
    surface = surface.in_order()
    there = before_mm[surface.move] + surface.parameter * length_mm[surface.move]
    pairs = np.einsum("pi,pj->pij", surface.normal, surface.normal)
    total = np.concatenate([np.zeros((1, 3, 3)), np.cumsum(pairs, axis=0)])
    weight = np.empty((len(path.move), 2))
    for begin in range(0, len(weight), _AT_ONCE):
        places = slice(begin, begin + _AT_ONCE)
        own = path.probes(places)
        here = before_mm[own.move] + own.parameter * length_mm[own.move]
        first, last = (np.searchsorted(there, here + way) for way in (-_NEAR_MM, _NEAR_MM))
        seen = np.einsum("pij,pi,pj->p", total[last] - total[first], own.normal, own.normal)
        share = _UNSEEN + (1.0 - _UNSEEN) * seen / np.maximum(last - first, 1)
        weight[places] = (share * own.path_length_mm).reshape(-1, 2)
    return replace(path, path_length_mm=weight)


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
