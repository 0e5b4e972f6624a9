"""Shifts of the path that centre the deviations of the surface which its moves make."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, eye_array, vstack
from scipy.sparse.linalg import splu

from gcode import MoveKind
from vmach.compensation.path_shift import PathShift
from vmach.path_geometry import move_length_mm, tangent_at

__all__ = ["SurfaceDemand", "centred"]

#: surface that is made within this way of the path is centred together
_WINDOW_MM = 5.0
#: changes of the shift on a shorter way are smoothed
_SMOOTH_MM = 3.0
#: weight, beside that of the surface, against shifts along a path that goes straight on
_ALONG = 0.02
#: weight against shifts that nothing asks for
_NOTHING_ASKS = 1e-6
#: rounds from least squares towards the least largest deviation
_ROUNDS = 16
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
    move : (P,) int64
    parameter : (P,) float64
        Where on the nominal path each was made.
    normal : (P, 3) float64
        Outward.
    shift_mm : (P,) float64
        Shift along the normal that would leave no deviation.
    """

    move: np.ndarray
    parameter: np.ndarray
    normal: np.ndarray
    shift_mm: np.ndarray


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
    window = _windows(shift)
    way = np.bincount(window, weights=_lengths_mm(shift))
    window = window[stretch]
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
    return vstack([_across_lines(shift), *_across_arcs(shift), _along(shift)], format="csr")


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


def _along(shift: PathShift) -> csr_array:
    """Shifts along the path where it goes straight on."""
    first = np.flatnonzero(shift.knot[:-1, 2] == shift.knot[1:, 0])
    first = first[_cuts(shift)[first] & _cuts(shift)[first + 1]]
    before, after = _tangents(shift, shift.end)[first], _tangents(shift, shift.start)[first + 1]
    straight = np.maximum(np.einsum("ij,ij->i", before, after), 0.0)
    length = _lengths_mm(shift)
    stiff = straight * np.sqrt(0.5 * _ALONG * (length[first] + length[first + 1]))
    factor = stiff[:, None] * 0.5 * (before + after)
    return _rows(shift, shift.knot[first, 2][:, None], factor[:, None])


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


def _cuts(shift: PathShift) -> np.ndarray:
    return shift.moves.kind[shift.move] != MoveKind.RAPID


def _lengths_mm(shift: PathShift) -> np.ndarray:
    return (shift.end - shift.start) * move_length_mm(shift.moves)[shift.move]


def _tangents(shift: PathShift, parameter: np.ndarray) -> np.ndarray:
    """Unit tangents of the stretches, (S, 3); zero where nothing moves."""
    tangent = tangent_at(shift.moves, shift.move, parameter)
    return tangent / np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), _TINY_MM)
