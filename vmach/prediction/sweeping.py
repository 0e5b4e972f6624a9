"""From a toolpath and the displacement at its nodes to the sweeps of the removal engine.

Source: closed form derived here: cubic Hermite interpolation of the displacement between two
nodes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from stock import Sweeps
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
    return dict(
        start_mm=tip[first],
        end_mm=tip[first + 1],
        centre_mm=np.where(arc[:, None], centre, 0.0),
        axis=axis,
        sweep_rad=nodes.moves.sweep_rad[move] * share,
        tool=tool_index[nodes.tool[first]],
        move=move,
        shift_mm=_pairs(displacement.shift_mm, first),
        shift_slope_mm=_pairs_of_slopes(displacement.shift_mm, path),
        tilt_rad=_pairs(displacement.tilt_rad, first),
        tilt_slope_rad=_pairs_of_slopes(displacement.tilt_rad, path),
    )


def _pairs(values: np.ndarray, first: np.ndarray) -> np.ndarray:
    return np.stack([values[first], values[first + 1]], axis=1)


def _pairs_of_slopes(values: np.ndarray, path: Toolpath) -> np.ndarray:
    """Derivatives per piece at both ends of each piece, (E, 2, 3).

    Inside a move they are central differences of the neighbouring nodes; at its ends those of
    the parabola through the three nearest nodes. A direction memory that flips from move to move
    therefore never smears over the corner.
    """
    first = path.first_node
    chord = values[first + 1] - values[first]
    same_move = path.piece_move[1:] == path.piece_move[:-1]
    before = np.concatenate([[False], same_move])[:, None]
    after = np.concatenate([same_move, [False]])[:, None]
    previous, following = np.roll(chord, 1, axis=0), np.roll(chord, -1, axis=0)
    central_start, central_end = 0.5 * (previous + chord), 0.5 * (chord + following)
    start = np.where(before, central_start, np.where(after, 2 * chord - central_end, chord))
    end = np.where(after, central_end, np.where(before, 2 * chord - central_start, chord))
    return np.stack([start, end], axis=1)
