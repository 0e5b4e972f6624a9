"""Strokes that go on in nearly one line made one, for programs of very many moves.

A set operation takes some milliseconds a stroke, however short it is, and CAM programs follow
curves by lines of hundredths of a millimetre. So strokes that stay within a distance of a common
chord become that chord. Which of the moves has left a triangle is found from its place.

Source: closed form derived here: distance of points from a chord; a convex tool touches its
envelope where its own outward normal is that of the envelope.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stock.compiled import njit_maker, njit_part
from stock.solid.ring_stack import RingStack
from stock.solid.strokes import Strokes

__all__ = ["JoinedStrokes", "join_strokes"]

#: strokes that are made one at most: each looks at all nodes before it
_MOST_JOINED = 512
#: a tilt counts by what it moves so far from the tip, mm
_ARM_MM = 100.0
_INSIDE = 1.0 - 1e-9


@dataclass(frozen=True)
class JoinedStrokes:
    """Strokes, and those that each has been made of.

    Attributes
    ----------
    strokes : Strokes
        S joined ones; ``move`` is the number of the joined stroke, not of a move.
    key : (P,) float64
        Of every old stroke: number of the joined one plus the share of its chord at which the
        old one ends, 1 for the last.
    move : (P,) int64
        Moves of the old strokes.
    """

    strokes: Strokes
    key: np.ndarray
    move: np.ndarray

    def moves_of(
        self, number: np.ndarray, corners_mm: np.ndarray, stacks: Sequence[RingStack]
    ) -> np.ndarray:
        """Moves that left triangles of the part, (T,) int64.

        Parameters
        ----------
        number : (T,) int64
            Of the joined strokes.
        corners_mm : (T, 3, 3) float64
            Counter-clockwise seen from outside.
        stacks : sequence of RingStack
            One a tool.
        """
        strokes = self.strokes
        start = strokes.start_mm[number]
        way = strokes.end_mm[number] - start
        length2 = np.maximum(np.einsum("ti,ti->t", way, way), np.finfo(float).tiny)
        one, two = corners_mm[:, 1] - corners_mm[:, 0], corners_mm[:, 2] - corners_mm[:, 0]
        normal = np.cross(one, two)
        # facets look up to a chord's angle aside, the envelope itself looks across the way
        along = np.einsum("ti,ti->t", normal, way) / length2
        across = normal - along[:, None] * way
        tip = corners_mm.mean(axis=1) - _touching(across, strokes.tool[number], stacks)
        return self.moves_at(number, np.einsum("ti,ti->t", tip - start, way) / length2)

    def moves_at(self, number: np.ndarray, share: np.ndarray) -> np.ndarray:
        """Moves at shares, (T,), of the joined strokes with these numbers, (T,)."""
        place = number + np.clip(share, 0.0, _INSIDE)
        return self.move[np.searchsorted(self.key, place, side="right")]


def join_strokes(strokes: Strokes, limit_mm: float) -> JoinedStrokes:
    """Make strokes that follow each other one, where their nodes keep within `limit_mm`.

    Of their common chord, in every coordinate, tilt included, and going forward along it.
    """
    first = _run_starts(strokes.start_mm, strokes.end_mm, strokes.start_tilt_rad,
                        strokes.end_tilt_rad, strokes.joined, limit_mm)  # fmt: skip
    last = np.append(first[1:], len(strokes))[: len(first)] - 1
    joined = replace(
        strokes,
        start_mm=strokes.start_mm[first],
        end_mm=strokes.end_mm[last],
        start_tilt_rad=strokes.start_tilt_rad[first],
        end_tilt_rad=strokes.end_tilt_rad[last],
        tool=strokes.tool[first],
        move=np.arange(len(first)),
        joined=strokes.joined[first],
    )
    number = np.repeat(np.arange(len(first)), last - first + 1)
    start, way = joined.start_mm[number], (joined.end_mm - joined.start_mm)[number]
    length2 = np.maximum(np.einsum("si,si->s", way, way), np.finfo(float).tiny)
    share = np.einsum("si,si->s", strokes.end_mm - start, way) / length2
    share[last] = 1.0
    return JoinedStrokes(joined, number + np.clip(share, 0.0, 1.0), strokes.move)


def _touching(direction: np.ndarray, tool: np.ndarray, stacks: Sequence[RingStack]) -> np.ndarray:
    """Point of upright tools, from their tip, that lies farthest against directions, (T, 3) mm."""
    level = np.hypot(direction[:, 0], direction[:, 1])
    outward = -direction[:, :2] / np.maximum(level, np.finfo(float).tiny)[:, None]
    found = np.zeros((len(tool), 3))
    for number, stack in enumerate(stacks):
        rows = np.flatnonzero(tool == number)
        reach = level[rows, None] * stack.rings[:, 0] - direction[rows, 2, None] * stack.rings[:, 1]
        ring = stack.rings[np.argmax(reach, axis=1)]
        found[rows] = np.column_stack([outward[rows] * ring[:, :1], ring[:, 1]])
    return found


@njit_maker()
def _run_starts(start, end, start_tilt, end_tilt, joined, limit):
    """First stroke of each run whose nodes lie near one chord."""
    first = np.empty(len(start), dtype=np.int64)
    runs = 0
    for i in range(len(start)):
        goes_on = i > 0 and joined[i] and i - first[runs - 1] < _MOST_JOINED
        if not (
            goes_on and _near_chord(start, end, start_tilt, end_tilt, first[runs - 1], i, limit)
        ):
            first[runs] = i
            runs += 1
    return first[:runs].copy()


@njit_part()
def _near_chord(start, end, start_tilt, end_tilt, first, last, limit):
    """Whether the nodes between two strokes lie near their common chord, one after the other."""
    length2 = 0.0
    for axis in range(3):
        length2 += (end[last, axis] - start[first, axis]) ** 2
    if length2 == 0.0:
        return False
    before = 0.0
    for k in range(first + 1, last + 1):
        share = 0.0
        for axis in range(3):
            share += (start[k, axis] - start[first, axis]) * (end[last, axis] - start[first, axis])
        share /= length2
        if share < before or share > 1.0:
            return False
        before = share
        for axis in range(3):
            chord = end[last, axis] - start[first, axis]
            if abs(start[k, axis] - start[first, axis] - share * chord) > limit:
                return False
            turned = start_tilt[k, axis] - start_tilt[first, axis]
            turned -= share * (end_tilt[last, axis] - start_tilt[first, axis])
            if abs(turned) * _ARM_MM > limit:
                return False
    return True
