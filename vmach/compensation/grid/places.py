"""Points of the control's grid that the ends of pieces may be written at.

Source: closed form derived here: points of a cubic grid next to a line.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gcode import MoveKind
from vmach.compensation.pieces.plan import Plan
from vmach.path.geometry import tangent_at
from vmach.program_text import Rewriter, Target
from vmach.program_text.frame_shift import turned_about_z

__all__ = ["Grid", "GridPlaces"]

#: steps along the path that an end of the user's goes at most
_PROGRAMMED = np.arange(-1, 2)
#: an inserted one, every step near by, and on lines shares of the shorter piece beside it
_NEAR, _ON = np.arange(-40, 41), np.arange(45, 201, 5)
_INSERTED = np.concatenate([-_ON[::-1], _NEAR, _ON])
_FAR = np.concatenate([np.linspace(-0.4, -0.025, 16), np.linspace(0.025, 0.4, 16)])
#: an arc turns by no more when an end goes along it: between what planning makes, 181 degrees, and
#: what is written as an arc, 190 degrees
_LARGEST_SWEEP_RAD = np.radians(185.0)
#: newton steps to the place where the path crosses the grid
_CROSSING = 2
#: in the two axes across
_UP_OR_DOWN = ((0, 0), (0, 1), (1, 0), (1, 1))
_NO_LENGTH_MM = 1e-9
_NO_SPAN = 1e-12


@dataclass(frozen=True)
class GridPlaces:
    """C grid points for each of E ends.

    Attributes
    ----------
    parameter : (E, C) float64
        Of the nominal move: which place of it the end stands for.
    wanted_mm : (E, C, 3) float64
        Correction that is wanted there, machine axes.
    off_mm : (E, C, 3) float64
        Grid point minus wanted place, machine axes.
    """

    parameter: np.ndarray
    wanted_mm: np.ndarray
    off_mm: np.ndarray

    @classmethod
    def empty(cls, ends: int, count: int) -> GridPlaces:
        """Room for so many."""
        return cls(np.zeros((ends, count)), np.zeros((ends, count, 3)), np.zeros((ends, count, 3)))

    @property
    def count(self) -> int:
        """C."""
        return self.parameter.shape[1]

    def taken(self, choice: np.ndarray) -> GridPlaces:
        """Some of the points of every end, (E, D) int64."""
        row = np.arange(len(choice))[:, None]
        return GridPlaces(
            self.parameter[row, choice], self.wanted_mm[row, choice], self.off_mm[row, choice]
        )

    def put(self, ends: np.ndarray, places: GridPlaces) -> None:
        """Fill in the points of the ends with numbers (K,)."""
        self.parameter[ends] = places.parameter
        self.wanted_mm[ends] = places.wanted_mm
        self.off_mm[ends] = places.off_mm


class Grid:
    """Finds grid points near the ends of a plan's pieces.

    Where the path crosses a plane of the grid, across its main axis, the four points around it in
    that plane are taken: at the end and at other places of the path before and behind it.

    Parameters
    ----------
    rewriter : Rewriter
    plan : Plan
    target : Target
    step_mm : (K,) float64
        Of the grid, for every piece.

    Attributes
    ----------
    inserted : (K,) bool
        Ends that may stand for other places of their move: the next piece goes on alike.
    """

    def __init__(self, rewriter: Rewriter, plan: Plan, target: Target, step_mm: np.ndarray) -> None:
        self.rewriter, self.plan, self.target, self.step_mm = rewriter, plan, target, step_mm
        self.first, self.last = plan.first, plan.last
        self.inserted = _inserted(rewriter, plan)

    def length_mm(self, pieces: np.ndarray | slice) -> np.ndarray:
        """Lengths of some pieces, (E,)."""
        move = self.plan.move[pieces]
        return (self.last[pieces] - self.first[pieces]) * self.rewriter.length_mm[move]

    def _span(self, pieces: np.ndarray) -> np.ndarray:
        return np.maximum(self.last[pieces] - self.first[pieces], _NO_SPAN)

    def of_inserted(self, ends: np.ndarray) -> GridPlaces:
        """Points beside the path of their move, for ends (K,) that may stand for other places."""
        axis, per_axis, _ = self._main_axis(ends, self.last[ends])
        step = self.step_mm[ends][:, None]
        length = self.rewriter.length_mm[self.plan.move[ends]][:, None]
        aside = self._ways(ends, step * per_axis) / length
        for _ in range(_CROSSING):
            along = _component(self._wanted(ends, aside), axis)
            aside += (np.round(along / step) * step - along) * per_axis / length
        place = self._wanted(ends, aside)
        return GridPlaces(
            np.repeat(self.last[ends][:, None] + aside, 4, axis=1),
            np.repeat(self._correction(ends, aside), 4, axis=1),
            self._off(ends, _around(place, axis, step), place),
        )

    def _ways(self, ends: np.ndarray, step_mm: np.ndarray) -> np.ndarray:
        """Ways from the ends, (E, C) mm, by steps, and far ones on lines."""
        before, after = self.length_mm(ends)[:, None], self.length_mm(ends + 1)[:, None]
        is_line = self.rewriter.moves.kind[self.plan.move[ends]] == MoveKind.LINE
        far = _FAR * np.minimum(before, after) * is_line[:, None]
        ways = np.concatenate([_INSERTED * step_mm, far], axis=1)
        ways = np.clip(ways, -_FAR.max() * before, _FAR.max() * after)
        longest = self._longest_arc_mm(ends)
        return np.clip(ways, np.minimum(after - longest, 0.0), np.maximum(longest - before, 0.0))

    def _longest_arc_mm(self, ends: np.ndarray) -> np.ndarray:
        """Length (E, 1) that an arc beside an end may get; infinite on lines."""
        move = self.plan.move[ends]
        sweep_rad = np.abs(self.rewriter.moves.sweep_rad[move])
        is_arc = self.rewriter.moves.kind[move] == MoveKind.ARC
        longest = np.full(len(ends), np.inf)
        np.divide(
            _LARGEST_SWEEP_RAD * self.rewriter.length_mm[move], sweep_rad, out=longest, where=is_arc
        )
        return longest[:, None]

    def of_programmed(self, ends: np.ndarray) -> GridPlaces:
        """Points about the ends (K,), more of them along the moves that meet there."""
        following = np.minimum(ends + 1, len(self.last) - 1)
        place, step = self._wanted(ends, np.zeros((len(ends), 1))), self.step_mm[ends][:, None]
        around = []
        for piece, at in (ends, self.last[ends]), (following, self.first[following]):
            axis, along = self._along_main_axis(piece, at)
            here = _component(place, axis)
            way = (np.round(here / step) + _PROGRAMMED) * step - here
            around.append(_around(place + way[..., None] * along[:, None], axis, step))
        off = self._off(ends, np.concatenate(around, axis=1), place)
        count = off.shape[1]
        return GridPlaces(
            np.repeat(self.last[ends][:, None], count, axis=1),
            np.repeat(self.target.ends_mm[ends][:, None], count, axis=1),
            off,
        )

    def one_of_programmed(self, ends: np.ndarray, number: np.ndarray) -> GridPlaces:
        """Of the points of `of_programmed` the ones with these numbers, (K,), as one for each."""
        following = np.minimum(ends + 1, len(self.last) - 1)
        behind, number = np.divmod(number, 4 * len(_PROGRAMMED))
        way_number, corner = np.divmod(number, 4)
        piece = np.where(behind == 0, ends, following)
        at = np.where(behind == 0, self.last[ends], self.first[following])
        place, step = self._wanted(ends, np.zeros((len(ends), 1))), self.step_mm[ends][:, None]
        axis, along = self._along_main_axis(piece, at)
        here = _component(place, axis)
        way = (np.round(here / step) + _PROGRAMMED[way_number, None]) * step - here
        around = _around(place + way[..., None] * along[:, None], axis, step)
        chosen = around[np.arange(len(ends)), corner][:, None]
        return GridPlaces(self.last[ends][:, None], self.target.ends_mm[ends][:, None],
                          self._off(ends, chosen, place))  # fmt: skip

    def _off(self, ends: np.ndarray, points: np.ndarray, places: np.ndarray) -> np.ndarray:
        """Points (E, n C, 3) minus places (E, C, 3), n for each, in machine axes."""
        off = points - np.repeat(places, points.shape[1] // places.shape[1], axis=1)
        return turned_about_z(off, self.rewriter.angle[self.plan.move[ends]][:, None])

    def _tangent(self, piece: np.ndarray, parameter: np.ndarray) -> np.ndarray:
        """Unit tangents in program coordinates, (E, 3); X where there is no way."""
        move = self.plan.move[piece]
        tangent = tangent_at(self.rewriter.moves, move, parameter)
        length = np.linalg.norm(tangent, axis=1, keepdims=True)
        tangent = tangent / np.maximum(length, _NO_LENGTH_MM)
        tangent = np.where(length > _NO_LENGTH_MM, tangent, np.eye(3)[0])
        return turned_about_z(tangent, -self.rewriter.angle[move])

    def _along_main_axis(self, piece: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Axis that the path goes along most, (E,), and the path's way for way along it, (E, 3)."""
        axis, per_axis, tangent = self._main_axis(piece, at)
        return axis, tangent * per_axis

    def _main_axis(
        self, piece: np.ndarray, at: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Axis that the path goes along most, (E,), its way for way along it, (E, 1); tangent."""
        tangent = self._tangent(piece, at)
        axis = np.abs(tangent).argmax(axis=1)
        return axis, 1.0 / np.take_along_axis(tangent, axis[:, None], axis=1), tangent

    def _correction(self, ends: np.ndarray, aside: np.ndarray) -> np.ndarray:
        """Wanted corrections at parameters (E, C) beside the ends: straight from end to end."""
        ends_mm, last = self.target.ends_mm, len(self.last) - 1
        here, following = ends_mm[ends], np.minimum(ends + 1, last)
        before = np.where((ends > 0)[:, None], ends_mm[np.maximum(ends - 1, 0)], 0.0)
        back = (here - before) / self._span(ends)[:, None]
        on = (ends_mm[following] - here) / self._span(following)[:, None]
        slope = np.where((aside < 0.0)[..., None], back[:, None], on[:, None])
        return here[:, None] + aside[..., None] * slope

    def _wanted(self, ends: np.ndarray, aside: np.ndarray) -> np.ndarray:
        """Wanted places (E, C, 3), program coordinates."""
        move = np.repeat(self.plan.move[ends], aside.shape[1])
        parameter = (self.last[ends][:, None] + aside).ravel()
        correction = self._correction(ends, aside).reshape(-1, 3)
        return self.rewriter.places(move, parameter, correction).reshape(*aside.shape, 3)


def _inserted(rewriter: Rewriter, plan: Plan) -> np.ndarray:
    kind = rewriter.moves.kind[plan.move]
    is_arc = plan.pieces.is_arc
    plain = ~plan.is_kept & ~plan.is_step & (kind != MoveKind.RAPID)
    plain &= is_arc == (kind == MoveKind.ARC)
    found = np.zeros(len(plan.pieces), bool)
    found[:-1] = plain[:-1] & plain[1:] & (plan.move[1:] == plan.move[:-1])
    return found


def _component(vectors: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """The component (E, C) of vectors (E, C, 3) along one axis for every row."""
    return np.take_along_axis(vectors, axis[:, None, None], axis=2)[..., 0]


def _around(place: np.ndarray, axis: np.ndarray, step: np.ndarray) -> np.ndarray:
    """The four grid points around places (E, C, 3) in the plane across an axis, (E, 4 C, 3)."""
    in_steps = (place / step[..., None])[:, :, None]
    is_axis = (np.arange(3) == axis[:, None])[:, None, None]
    # the two other axes in turn: up or down in the first, in the second
    first = np.arange(3) == ((axis + 1) % 3)[:, None]
    up = np.stack([first * one + ~first * two for one, two in _UP_OR_DOWN], axis=1)[:, None]
    points = np.where(is_axis, np.round(in_steps), np.floor(in_steps) + up)
    return points.reshape(len(place), 4 * place.shape[1], 3) * step[..., None]
