"""What holds the shift of a path back where the surface asks for nothing.

Source: closed form derived here: quadratic penalties on changes of the shift along the path.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.sparse import csr_array, vstack

from vmach.compensation.aim.path_shift import PathShift
from vmach.path.geometry import position_at

__all__ = ["knot_rows", "path_rows"]

#: changes of the shift on a shorter way are smoothed
_SMOOTH_MM = 3.0
#: weights, beside that of the surface, against shifts along a path that goes straight on, and
#: along any path for so much way
_STRAIGHT_ON = 0.02
_FACETS = 1e-3
_FACETS_MM = 5.0
#: places that are nearer than this are one, and the weight by which they are shifted alike
_SAME_PLACE_MM = 1e-3
_AGAIN_MM = 3.0
#: a move whose direction has no more beside the tool's axis goes along it
_UPRIGHT = 1e-3


def path_rows(shift: PathShift) -> csr_array:
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
    tangent, length = shift.tangents(shift.start), shift.length_mm
    upright = np.hypot(tangent[:, 0], tangent[:, 1]) <= _UPRIGHT
    used = np.flatnonzero(~shift.is_arc & (length > 0) & (shift.cuts | upright))
    beside = np.eye(3) - tangent[used, :, None] * tangent[used, None, :]
    factor = _SMOOTH_MM / np.sqrt(length[used])[:, None, None] * beside
    knot = np.repeat(shift.knot[used][:, [0, 2]], 3, axis=0)
    factor = factor.reshape(-1, 1, 3)
    return knot_rows(shift, knot, np.concatenate([-factor, factor], axis=1))


def _across_arcs(shift: PathShift) -> Iterator[csr_array]:
    """Changes of radius and height along arcs."""
    arc = np.flatnonzero(shift.is_arc & (shift.length_mm > 0))
    stiffness = _SMOOTH_MM / np.sqrt(shift.length_mm[arc])[:, None]
    radial, axial = shift.frames[arc, :, 0], shift.frames[arc, :, 2]
    for one, two, vector, stiff in (
        (0, 1, radial, stiffness * np.sqrt(2.0)),
        (1, 2, radial, stiffness * np.sqrt(2.0)),
        (0, 2, axial, stiffness),
    ):
        factor = np.stack([-stiff * vector[:, one], stiff * vector[:, two]], axis=1)
        yield knot_rows(shift, shift.knot[arc][:, [one, two]], factor)


def _along_straight(shift: PathShift) -> csr_array:
    """Shifts along the path where it goes straight on, which change nothing."""
    first = np.flatnonzero(shift.knot[:-1, 2] == shift.knot[1:, 0])
    first = first[shift.cuts[first] & shift.cuts[first + 1]]
    before, after = shift.tangents(shift.end)[first], shift.tangents(shift.start)[first + 1]
    straight = np.maximum(np.einsum("ij,ij->i", before, after), 0.0)
    length = shift.length_mm
    stiff = straight * np.sqrt(0.5 * _STRAIGHT_ON * (length[first] + length[first + 1]))
    factor = stiff[:, None] * 0.5 * (before + after)
    return knot_rows(shift, shift.knot[first, 2][:, None], factor[:, None])


def _along_any(shift: PathShift) -> Iterator[csr_array]:
    """Shifts along the path anywhere: normals taken from facets seem to ask for them."""
    cuts = np.flatnonzero(shift.cuts)
    stiff = np.sqrt(_FACETS * np.minimum(shift.length_mm, _FACETS_MM))[cuts, None]
    for knot, parameter in ((0, shift.start), (2, shift.end)):
        factor = stiff * shift.tangents(parameter)[cuts]
        yield knot_rows(shift, shift.knot[cuts, knot][:, None], factor[:, None])


def _at_same_places(shift: PathShift) -> csr_array:
    """Differences of the shifts where one tool passes a place again, as in a spring pass."""
    knot = np.concatenate([shift.knot[:, 0], shift.knot[:, 2]])
    stretch = np.tile(np.arange(len(shift.move)), 2)
    cuts = shift.cuts[stretch]
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
    return knot_rows(shift, np.repeat(pairs, 3, axis=0), np.tile(factor, (len(pairs), 1, 1)))


def knot_rows(shift: PathShift, knot: np.ndarray, factor: np.ndarray) -> csr_array:
    """Rows of factors (R, k, 3) of knots (R, k), one column a component."""
    column = 3 * knot[:, :, None] + np.arange(3)
    row = np.broadcast_to(np.arange(len(knot))[:, None, None], column.shape)
    shape = (len(knot), shift.free.size)
    return csr_array((factor.ravel(), (row.ravel(), column.ravel())), shape=shape)
