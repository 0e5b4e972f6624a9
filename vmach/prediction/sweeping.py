"""From a toolpath and the displacement at its nodes to the sweeps of the removal engine.

Source: closed form derived here: cubic Hermite interpolation of the displacement between two
nodes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from stock import Sweeps
from stock.compiled import njit_kernel, read_only
from vmach.machine import RigidDisplacement
from vmach.path.geometry import position_at
from vmach.path.toolpath import PathStates, Toolpath

__all__ = ["build_sweeps", "join_sweeps"]


def build_sweeps(
    path: Toolpath, displacement: RigidDisplacement, *, zero_mm: np.ndarray, tool_index: np.ndarray
) -> Sweeps:
    """Sweeps of every piece of the path in workpiece coordinates.

    Parameters
    ----------
    path : Toolpath
    displacement : RigidDisplacement
        Of the tool at the K nodes.
    zero_mm : (3,) float64
        Workpiece zero in machine coordinates.
    tool_index : (T,) int
        Index into the engine's sequence of tools for tool number k.
    """
    return Sweeps(**_columns(path, displacement, zero_mm, tool_index))


def join_sweeps(
    parts: Iterable[Toolpath],
    displaced: Callable[[PathStates], RigidDisplacement],
    *,
    count: int,
    zero_mm: np.ndarray,
    tool_index: np.ndarray,
) -> Sweeps:
    """Sweeps of a path that is displaced part by part, so that long ones need little memory.

    Parameters
    ----------
    parts : iterable of Toolpath
        As `Toolpath.parts` gives them.
    displaced : callable
        Displacement of the tool at the nodes of a part.
    count : int
        Pieces of all parts.
    zero_mm, tool_index
        As in `build_sweeps`.
    """
    whole: dict[str, np.ndarray] = {}
    done = 0
    for part in parts:
        rows = slice(done, done + len(part.first_node))
        done = rows.stop
        for name, values in _columns(part, displaced(part.nodes), zero_mm, tool_index).items():
            if name not in whole:
                whole[name] = np.zeros((count, *values.shape[1:]), values.dtype)
            if values.any():  # memory that nobody writes to takes no room
                whole[name][rows] = values
    return Sweeps(**whole)


def _columns(
    path: Toolpath, displacement: RigidDisplacement, zero_mm: np.ndarray, tool_index: np.ndarray
) -> dict[str, np.ndarray]:
    """The fields of the sweeps of a path; arguments as of `build_sweeps`."""
    nodes = path.nodes
    first = path.first_node
    tip = position_at(nodes.moves, nodes.move, nodes.parameter) + nodes.tool_mm - zero_mm
    move = path.piece_move
    share = nodes.parameter[first + 1] - nodes.parameter[first]
    arc = nodes.moves.sweep_rad[move] != 0
    to_tip = nodes.tool_mm[first] - zero_mm
    axis = nodes.moves.axis[move]
    centre = nodes.moves.centre_mm[move] + to_tip
    centre += np.einsum("ij,ij->i", tip[first] - centre, axis)[:, None] * axis
    shift, shift_slope = _pairs(displacement.shift_mm, first, move)
    tilt, tilt_slope = _pairs(displacement.tilt_rad, first, move)
    return dict(
        start_mm=tip[first],
        end_mm=tip[first + 1],
        centre_mm=np.where(arc[:, None], centre, 0.0),
        axis=axis,
        sweep_rad=nodes.moves.sweep_rad[move] * share,
        tool=tool_index[nodes.tool[first]],
        move=move,
        shift_mm=shift,
        shift_slope_mm=shift_slope,
        tilt_rad=tilt,
        tilt_slope_rad=tilt_slope,
    )


def _pairs(
    values: np.ndarray, first: np.ndarray, move: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Values of nodes (K, 3) at both ends of each piece, and derivatives there, each (E, 2, 3).

    Inside a move derivatives are central differences of the neighbouring nodes; at its ends those
    of the parabola through the three nearest nodes. A direction memory that flips from move to
    move therefore never smears over the corner.
    """
    pairs, slopes = np.empty((len(first), 2, 3)), np.empty((len(first), 2, 3))
    _fill_pairs(read_only(values), read_only(first), read_only(move), pairs, slopes)
    return pairs, slopes


@njit_kernel()
def _fill_pairs(
    values: np.ndarray, first: np.ndarray, move: np.ndarray, pairs: np.ndarray, slopes: np.ndarray
) -> None:
    """Write the values and derivatives of `_pairs`; neighbours of one move join at a node."""
    last = len(first) - 1
    for e in range(len(first)):
        before = e > 0 and move[e - 1] == move[e]
        after = e < last and move[e + 1] == move[e]
        node = first[e]
        for j in range(3):
            start, end = values[node, j], values[node + 1, j]
            pairs[e, 0, j], pairs[e, 1, j] = start, end
            chord = end - start
            at_start = at_end = chord
            if before:
                at_start = 0.5 * (start - values[first[e - 1], j] + chord)
            if after:
                at_end = 0.5 * (chord + (values[first[e + 1] + 1, j] - end))
            if after and not before:
                at_start = 2.0 * chord - at_end
            if before and not after:
                at_end = 2.0 * chord - at_start
            slopes[e, 0, j], slopes[e, 1, j] = at_start, at_end
