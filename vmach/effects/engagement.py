"""How much material the tool took where it made the surface: radial depth along the normal."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from gcode import MoveKind, Moves
from vmach.path_geometry import move_length_mm, position_at

__all__ = ["radial_depth_mm"]

_ARC_STEP_RAD = np.radians(1.5)
#: how far chords of an arc may lie from it
_ARC_SAG_MM = 0.01
#: way just before the contact, in tool radii, that belongs to the same cut
_SAME_CUT_RADII = 3.0
#: an earlier pass this near to the final surface leaves nothing to cut
_NOTHING_MM = 1e-4
#: a pass that comes this much closer to the surface would have cut the surface itself away
_GOUGE_MM = 0.05
#: a normal with less than this across the tool axis counts as vertical
_VERTICAL = 1e-6


def radial_depth_mm(
    moves: Moves,
    move: np.ndarray,
    *,
    parameter: np.ndarray,
    tip_mm: np.ndarray,
    tool_lengths_mm: np.ndarray,
    radii_mm: np.ndarray,
    contact_mm: np.ndarray,
    normal: np.ndarray,
) -> np.ndarray:
    """Thickness of material on the final surface before the last cut, (P,) mm.

    For every contact, the line along the horizontal part of the normal is met with the stadiums
    that the tool's earlier passes swept at that depth; material begins where the first of them
    is entered. Bounded by the tool's diameter; zero where the normal is vertical. A cut, from one
    rapid to the next, that would have taken the surface itself away is not counted: the surface
    was measured, so that cut is not as it is written, or the point is of another feature.

    Parameters
    ----------
    moves : Moves
    move, parameter : (P,)
        Where the contact was made.
    tip_mm, contact_mm, normal : (P, 3)
        Tool tip, contact from it, normal of the surface.
    tool_lengths_mm, radii_mm : (T,) float64
        Of tool number k at index k; NaN where there is no such tool.
    """
    flat = np.hypot(normal[:, 0], normal[:, 1])
    sideways = flat > _VERTICAL
    direction = normal[:, :2] / np.where(sideways, flat, 1.0)[:, None]
    length = move_length_mm(moves)
    before = np.cumsum(length) - length
    start, end, owner, share = _chords(moves, tool_lengths_mm)
    return _depths(
        tip_mm + contact_mm,
        np.where(sideways[:, None], direction, 0.0),
        before[move] + parameter * length[move],
        radii_mm[moves.tool[move]],
        np.column_stack([before[owner] + share * length[owner], radii_mm[moves.tool[owner]]]),
        np.cumsum(moves.kind == MoveKind.RAPID)[owner],
        start,
        end,
    )


def _chords(
    moves: Moves, tool_lengths_mm: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Straight pieces of the tip's path at feed: start, end (M, 3), move and parameter (M,)."""
    length = tool_lengths_mm[np.minimum(moves.tool, len(tool_lengths_mm) - 1)]
    feeding = moves.at_feed
    index = np.flatnonzero(np.isfinite(length) & feeding)
    radius = np.linalg.norm(moves.start_mm[index] - moves.centre_mm[index], axis=1)
    arc_step = np.minimum(_ARC_STEP_RAD, np.sqrt(8.0 * _ARC_SAG_MM / np.maximum(radius, 1e-9)))
    pieces = np.maximum(np.ceil(np.abs(moves.sweep_rad[index]) / arc_step), 1).astype(int)
    owner = np.repeat(index, pieces)
    step = np.arange(len(owner)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    count = np.repeat(pieces, pieces)
    drop = np.column_stack([np.zeros((len(owner), 2)), length[owner]])
    start = position_at(moves, owner, step / count) - drop
    end = position_at(moves, owner, (step + 1) / count) - drop
    return start, end, owner, step / count


@njit(cache=True, nogil=True, error_model="numpy")
def _depths(point, direction, way, radius, chord_way_and_radius, cut, start, end):
    depth = np.zeros(len(point))
    for k in range(len(point)):
        normal = (direction[k, 0], direction[k, 1])
        if normal[0] == 0.0 and normal[1] == 0.0:
            continue
        nearest = 2.0 * radius[k]
        in_cut, gouges = nearest, False
        for c in range(len(start)):
            if c > 0 and cut[c] != cut[c - 1]:
                nearest = nearest if gouges else min(nearest, in_cut)
                in_cut, gouges = nearest, False
            left = way[k] - _SAME_CUT_RADII * radius[k] - chord_way_and_radius[c, 0]
            if left <= 0.0:
                break
            if min(start[c, 2], end[c, 2]) > point[k, 2]:
                continue
            x, y, z = end[c, 0] - start[c, 0], end[c, 1] - start[c, 1], end[c, 2] - start[c, 2]
            # of the chord that the tool is on, only what lies well behind it
            share = min(1.0, left / max(math.sqrt(x * x + y * y + z * z), left))
            offset = (point[k, 0] - start[c, 0], point[k, 1] - start[c, 1])
            chord = (share * x, share * y)
            in_cut = min(in_cut, _entry(offset, normal, chord, chord_way_and_radius[c, 1]))
            gouges = gouges or _apart(offset, chord) < chord_way_and_radius[c, 1] - _GOUGE_MM
        depth[k] = max(nearest if gouges else min(nearest, in_cut), 0.0)
    return depth


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _apart(offset, chord):
    """Distance of a point from a chord that begins at the origin."""
    squared = chord[0] * chord[0] + chord[1] * chord[1]
    along = offset[0] * chord[0] + offset[1] * chord[1]
    share = min(max(along / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    return math.hypot(offset[0] - share * chord[0], offset[1] - share * chord[1])


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _entry(offset, normal, chord, radius):
    """Where the line offset + s normal enters the stadium about a chord from 0, s >= 0.

    inf if it misses.
    """
    best = np.inf
    nx, ny = normal
    for share in (0.0, 1.0):
        dx, dy = offset[0] - share * chord[0], offset[1] - share * chord[1]
        middle = -(dx * nx + dy * ny)
        across = radius * radius - (dx * dx + dy * dy - middle * middle)
        if across > 0.0:
            half = math.sqrt(across)
            if middle + half > _NOTHING_MM:
                best = min(best, max(middle - half, 0.0))
    length = math.sqrt(chord[0] * chord[0] + chord[1] * chord[1])
    if length == 0.0:
        return best
    tx, ty = chord[0] / length, chord[1] / length
    slope = nx * -ty + ny * tx
    if abs(slope) < 1e-9:
        return best
    aside = offset[0] * -ty + offset[1] * tx
    low = min((-radius - aside) / slope, (radius - aside) / slope)
    high = max((-radius - aside) / slope, (radius - aside) / slope)
    # the part of the line over the chord itself
    rate, base = nx * tx + ny * ty, offset[0] * tx + offset[1] * ty
    if abs(rate) < 1e-9:
        if base < 0.0 or base > length:
            return best
    else:
        low = max(low, min(-base / rate, (length - base) / rate))
        high = min(high, max(-base / rate, (length - base) / rate))
    if high > max(low, _NOTHING_MM):
        best = min(best, max(low, 0.0))
    return best
