"""Shifts of the path that centre the deviations of the surface which its moves make.

Source: C. Lawson (1961): the largest residual made least by least squares with weights that grow
with the residual.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, eye_array
from scipy.sparse.linalg import splu

from vmach.compensation.aim.path_shift import PathShift
from vmach.compensation.aim.path_stiffness import knot_rows, path_rows
from vmach.compensation.aim.surface_demand import SurfaceDemand

__all__ = ["centred"]

#: surface that is made within this way of the path is centred together
_WINDOW_MM = 5.0
#: way for which one point is enough
_SEEN_MM = 2.0
#: weight against shifts that nothing asks for
_NOTHING_ASKS = 1e-6
#: rounds from least squares towards the least largest deviation
_ROUNDS = 16
#: no point loses more of its weight
_LEAST_WEIGHT = 1e-3
_TINY_MM = 1e-9


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
    surface, path = surface[:, free], path_rows(shift)[:, free]
    held = path.T @ path + _NOTHING_ASKS * eye_array(len(free))
    window = _windows(shift)[stretch]
    way = _way_seen(shift, demand, stretch, window)
    weight = np.ones(len(stretch))
    for _ in range(_ROUNDS):
        weight = weight / np.bincount(window, weight, len(way))[window]
        found = _solved(surface, weight * way[window], demand.shift_mm, held)
        left = np.abs(surface @ found - demand.shift_mm)
        weight = _heavier_where_far(weight, left, window)
    value = np.zeros(shift.free.size)
    value[free] = found
    return shift.with_values(value.reshape(-1, 3))


def _solved(
    surface: csr_array, weight: np.ndarray, wanted_mm: np.ndarray, held: csr_array
) -> np.ndarray:
    """Least squares with weights for the points, beside what holds the path."""
    weighted = surface.multiply(weight[:, None]).tocsr()
    matrix = (weighted.T @ surface + held).tocsc()
    solver = splu(matrix, "MMD_AT_PLUS_A", options={"SymmetricMode": True})
    return solver.solve(weighted.T @ wanted_mm)


def _heavier_where_far(weight: np.ndarray, left: np.ndarray, window: np.ndarray) -> np.ndarray:
    """Weights, of sum 1 in every window, times the deviation that is left there."""
    most = np.full(window.max() + 1, _TINY_MM)
    np.maximum.at(most, window, left)
    least = _LEAST_WEIGHT / np.bincount(window)[window]
    return np.maximum(weight * left / most[window], least)


def _surface_rows(shift: PathShift, demand: SurfaceDemand) -> tuple[np.ndarray, csr_array]:
    """Stretch of every point, and its shift along the normal by the shifts of the knots."""
    stretch, matrix = shift.matrices(demand.move, demand.parameter)
    factor = np.einsum("pi,pkij->pkj", demand.normal, matrix)
    return stretch, knot_rows(shift, np.maximum(shift.knot[stretch], 0), factor)


def _windows(shift: PathShift) -> np.ndarray:
    """Number of the window of every stretch, (S,): neighbours until the window is long."""
    length, cuts = shift.length_mm, shift.cuts
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
    length = shift.length_mm
    share = (demand.parameter - shift.start[stretch]) / (shift.end - shift.start)[stretch]
    place = (np.cumsum(length) - length)[stretch] + share * length[stretch]
    bins = np.unique(np.column_stack([window, place // _SEEN_MM]), axis=0)
    return _SEEN_MM * np.bincount(bins[:, 0].astype(np.int64), minlength=window.max() + 1)
