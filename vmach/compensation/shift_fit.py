"""Shifts of the path that centre the deviations of the surface which its moves make."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, eye_array, vstack
from scipy.sparse.linalg import splu

from gcode import MoveKind
from vmach.compensation.path_shift import PathShift
from vmach.path_geometry import move_length_mm, position_at, tangent_at

__all__ = ["SurfaceDemand", "centred"]

#: surface that is made within this way of the path is centred together
_WINDOW_MM = 5.0
#: way for which one point is enough
_SEEN_MM = 2.0
#: changes of the shift on a shorter way are smoothed
_SMOOTH_MM = 3.0
#: weights, beside that of the surface, against shifts along a path that goes straight on, and
#: along any path
_STRAIGHT_ON = 0.02
_FACETS = 1e-3
#: weight against shifts that nothing asks for
_NOTHING_ASKS = 1e-6
#: rounds from least squares towards the least largest deviation
_ROUNDS = 16
#: places that are nearer than this are one, and the weight by which they are shifted alike
_SAME_PLACE_MM = 1e-3
_AGAIN_MM = 3.0
#: no point loses more of its weight
_LEAST_WEIGHT = 1e-3
#: a move whose direction has no more beside the tool's axis goes along it
_UPRIGHT = 1e-3
_TINY_MM = 1e-9


@dataclass(frozen=True)
class SurfaceDemand:
    """What P surface points ask of the path.

    Attributes
    ----------
    point : (P,) int64
        Numbers of the points; one that several moves make may ask each of them.
    move : (P,) int64
    parameter : (P,) float64
        Where on the nominal path each was made.
    normal : (P, 3) float64
        Outward.
    shift_mm : (P,) float64
        Shift along the normal that would leave no deviation.
    """

    point: np.ndarray
    move: np.ndarray
    parameter: np.ndarray
    normal: np.ndarray
    shift_mm: np.ndarray

    def beside(self, earlier: SurfaceDemand | None) -> SurfaceDemand:
        """These, and earlier ones of the same points to other moves.

        A move that no longer makes a point, because another one now goes deeper there, would
        take the point back if it were let go.
        """
        if earlier is None:
            return self
        key, old = (np.column_stack([d.point, d.move]) for d in (self, earlier))
        kept = ~np.isin(old @ [1 << 32, 1], key @ [1 << 32, 1])
        names = self.__dataclass_fields__
        return SurfaceDemand(
            *(np.concatenate([getattr(self, n), getattr(earlier, n)[kept]]) for n in names)
        )


def centred(shift: PathShift, demand: SurfaceDemand) -> PathShift:
    """The shift that leaves least on the surface.

    Every point asks for a shift along its normal where the tool made it, and so for a
    combination of the shifts of the knots about it. Where points of one neighbourhood ask for
    different ones, the largest deviation is made small: least squares with weights that grow by
    the deviation that is left (Lawson 1961), by windows of the path, so that no part of the
    surface pays for another. Shifts along the path are held back, and so are changes across it
    within a few millimetres; knots without points follow the others.

    Parameters
    ----------
    shift : PathShift
        Knots.
    demand : SurfaceDemand
    """
    free = np.flatnonzero(shift.free)
    if not len(free) or not len(demand.move):
        return shift
    stretch, surface = _surface_rows(shift, demand)
    path = _path_rows(shift)
    surface, path = surface[:, free], path[:, free]
    held = path.T @ path + _NOTHING_ASKS * eye_array(len(free))
    window = _windows(shift)[stretch]
    way = _way_seen(shift, demand, stretch, window)
    weight, found = np.ones(len(stretch)), np.zeros(len(free))
    for _ in range(_ROUNDS):
        weight = weight / np.bincount(window, weight, len(way))[window]
        weighted = surface.multiply((weight * way[window])[:, None]).tocsr()
        normal = (weighted.T @ surface + held).tocsc()
        found = splu(normal, "MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(
            weighted.T @ demand.shift_mm
        )
        left = np.abs(surface @ found - demand.shift_mm)
        most = np.full(len(way), _TINY_MM)
        np.maximum.at(most, window, left)
        least = _LEAST_WEIGHT / np.maximum(np.bincount(window, minlength=len(way)), 1)
        weight = np.maximum(weight * left / most[window], least[window])
    value = np.zeros(shift.free.size)
    value[free] = found
    return shift.with_values(value.reshape(-1, 3))


def _surface_rows(shift: PathShift, demand: SurfaceDemand) -> tuple[np.ndarray, csr_array]:
    """Stretch of every point, and its shift along the normal by the shifts of the knots."""
    stretch, matrix = shift.matrices(demand.move, demand.parameter)
    factor = np.einsum("pi,pkij->pkj", demand.normal, matrix)
    return stretch, _rows(shift, np.maximum(shift.knot[stretch], 0), factor)


def _path_rows(shift: PathShift) -> csr_array:
    """What holds the shift of the path back, beside the surface: one row, one square."""
    return vstack(
        [
            _across_lines(shift),
            *_across_arcs(shift),
            _along_straight(shift),
            *_along_any(shift),
            _at_same_places(shift),
        ],
        format="csr",
    )


def _across_lines(shift: PathShift) -> csr_array:
    """Changes across straight cuts, and across rapids along the tool's axis."""
    tangent, length = _tangents(shift, shift.start), _lengths_mm(shift)
    upright = np.hypot(tangent[:, 0], tangent[:, 1]) <= _UPRIGHT
    used = np.flatnonzero(~shift.is_arc & (length > 0) & (_cuts(shift) | upright))
    beside = np.eye(3) - tangent[used, :, None] * tangent[used, None, :]
    factor = _SMOOTH_MM / np.sqrt(length[used])[:, None, None] * beside
    knot = np.repeat(shift.knot[used][:, [0, 2]], 3, axis=0)
    factor = factor.reshape(-1, 1, 3)
    return _rows(shift, knot, np.concatenate([-factor, factor], axis=1))


def _across_arcs(shift: PathShift) -> Iterator[csr_array]:
    """Changes of radius and height along arcs."""
    arc = np.flatnonzero(shift.is_arc & (_lengths_mm(shift) > 0))
    stiffness = _SMOOTH_MM / np.sqrt(_lengths_mm(shift)[arc])[:, None]
    radial, axial = shift.frames[arc, :, 0], shift.frames[arc, :, 2]
    for one, two, vector, stiff in (
        (0, 1, radial, stiffness * np.sqrt(2.0)),
        (1, 2, radial, stiffness * np.sqrt(2.0)),
        (0, 2, axial, stiffness),
    ):
        factor = np.stack([-stiff * vector[:, one], stiff * vector[:, two]], axis=1)
        yield _rows(shift, shift.knot[arc][:, [one, two]], factor)


def _along_straight(shift: PathShift) -> csr_array:
    """Shifts along the path where it goes straight on, which change nothing."""
    first = np.flatnonzero(shift.knot[:-1, 2] == shift.knot[1:, 0])
    first = first[_cuts(shift)[first] & _cuts(shift)[first + 1]]
    before, after = _tangents(shift, shift.end)[first], _tangents(shift, shift.start)[first + 1]
    straight = np.maximum(np.einsum("ij,ij->i", before, after), 0.0)
    length = _lengths_mm(shift)
    stiff = straight * np.sqrt(0.5 * _STRAIGHT_ON * (length[first] + length[first + 1]))
    factor = stiff[:, None] * 0.5 * (before + after)
    return _rows(shift, shift.knot[first, 2][:, None], factor[:, None])


def _along_any(shift: PathShift) -> Iterator[csr_array]:
    """Shifts along the path anywhere: normals taken from facets seem to ask for them."""
    cuts = np.flatnonzero(_cuts(shift))
    stiff = np.sqrt(_FACETS * np.minimum(_lengths_mm(shift), _WINDOW_MM))[cuts, None]
    for knot, parameter in ((0, shift.start), (2, shift.end)):
        factor = stiff * _tangents(shift, parameter)[cuts]
        yield _rows(shift, shift.knot[cuts, knot][:, None], factor[:, None])


def _at_same_places(shift: PathShift) -> csr_array:
    """Differences of the shifts where one tool passes a place again, as in a spring pass."""
    knot = np.concatenate([shift.knot[:, 0], shift.knot[:, 2]])
    stretch = np.tile(np.arange(len(shift.move)), 2)
    cuts = _cuts(shift)[stretch]
    knot, first = np.unique(knot[cuts], return_index=True)
    stretch, at_end = stretch[cuts][first], first >= cuts[: len(shift.move)].sum()
    move = shift.move[stretch]
    parameter = np.where(at_end, shift.end[stretch], shift.start[stretch])
    place = np.round(position_at(shift.moves, move, parameter) / _SAME_PLACE_MM)
    key = np.column_stack([shift.moves.tool[move], place])
    order = np.lexsort(key.T)
    same = np.flatnonzero((key[order[1:]] == key[order[:-1]]).all(axis=1))
    pairs = np.stack([knot[order[same]], knot[order[same + 1]]], axis=1)
    factor = np.sqrt(_AGAIN_MM) * np.stack([-np.eye(3), np.eye(3)], axis=1)
    return _rows(shift, np.repeat(pairs, 3, axis=0), np.tile(factor, (len(pairs), 1, 1)))


def _rows(shift: PathShift, knot: np.ndarray, factor: np.ndarray) -> csr_array:
    """Rows of factors (R, k, 3) of knots (R, k), one column a component."""
    column = 3 * knot[:, :, None] + np.arange(3)
    row = np.broadcast_to(np.arange(len(knot))[:, None, None], column.shape)
    shape = (len(knot), shift.free.size)
    return csr_array((factor.ravel(), (row.ravel(), column.ravel())), shape=shape)


def _windows(shift: PathShift) -> np.ndarray:
    """Number of the window of every stretch, (S,): neighbours until the window is long."""
    length, cuts = _lengths_mm(shift), _cuts(shift)
    joined = (shift.knot[:-1, 2] == shift.knot[1:, 0]) & (cuts[:-1] == cuts[1:])
    window, way, number = [], 0.0, 0
    for here, follows in zip(length.tolist(), [False, *joined.tolist()], strict=True):
        if not follows or way + here > _WINDOW_MM:
            number, way = number + 1, 0.0
        way += here
        window.append(number)
    return np.array(window, np.int64)


def _way_seen(
    shift: PathShift, demand: SurfaceDemand, stretch: np.ndarray, window: np.ndarray
) -> np.ndarray:
    """Way in every window on which points were made, mm: where they are few, they weigh less."""
    length = _lengths_mm(shift)
    share = (demand.parameter - shift.start[stretch]) / (shift.end - shift.start)[stretch]
    place = (np.cumsum(length) - length)[stretch] + share * length[stretch]
    bins = np.unique(np.column_stack([window, place // _SEEN_MM]), axis=0)
    return _SEEN_MM * np.bincount(bins[:, 0].astype(np.int64), minlength=window.max() + 1)


def _cuts(shift: PathShift) -> np.ndarray:
    return shift.moves.kind[shift.move] != MoveKind.RAPID


def _lengths_mm(shift: PathShift) -> np.ndarray:
    return (shift.end - shift.start) * move_length_mm(shift.moves)[shift.move]


def _tangents(shift: PathShift, parameter: np.ndarray) -> np.ndarray:
    """Unit tangents of the stretches, (S, 3); zero where nothing moves."""
    tangent = tangent_at(shift.moves, shift.move, parameter)
    return tangent / np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), _TINY_MM)
