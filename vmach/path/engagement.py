"""How much material the tool took where it made the surface: across the surface, and above.

Source: closed form derived here: the way along the normal to the nearest earlier pass, a disc or
a stadium of the tool's radius; what lies above the middle of that way was cut by passes over it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from gcode import MoveKind, Moves
from stock.threads import run_in_parts
from vmach.base.alike_rows import alike_rows
from vmach.path.geometry import move_length_mm, position_at
from vmach.path.toolpath import PathStates

__all__ = ["Engagement", "engagement"]

_ARC_STEP_RAD = np.radians(1.5)
#: how far chords of an arc may lie from it
_ARC_SAG_MM = 0.01
#: way across the tool axis just before the contact, in tool radii, that belongs to the same cut
_SAME_CUT_RADII = 3.0
#: an earlier pass this near to the final surface leaves nothing to cut
_NOTHING_MM = 1e-4
#: a pass that comes this much closer to the surface would have cut the surface itself away
_GOUGE_MM = 0.05
#: a normal with less than this across the tool axis counts as vertical
_VERTICAL = 1e-6
#: sine or cosine of an angle below which two lines count as parallel or square
_PARALLEL = 1e-9
#: contacts that are worth a thread; each looks at all that was cut before
_LEAST = 32


class Engagement(NamedTuple):
    """What the last cut found in front of a surface, at P contacts.

    `radial_mm` (P,) is the thickness of material on the final surface before, along the horizontal
    part of the normal; `top_mm` (P,) is the lowest height in machine coordinates at which earlier
    passes went over the middle of it, inf where none did.
    """

    radial_mm: np.ndarray
    top_mm: np.ndarray


class _Contacts(NamedTuple):
    """Where the tool made the surface, P contacts in machine coordinates.

    `position_mm` is (P, 3), `direction` (P, 2) the horizontal part of the normal as a unit
    vector, zero where there is none; `way_mm` (P,) is the program's across the tool axis up to
    the contact, `radius_mm` (P,) the tool's.
    """

    position_mm: np.ndarray
    direction: np.ndarray
    way_mm: np.ndarray
    radius_mm: np.ndarray


class _Chords(NamedTuple):
    """Straight pieces of the tip's path at feed, M in the order of the program.

    `start_mm` and `end_mm` are (M, 3); `way_radius_mm` (M, 2) is the way of the program up to the
    start, and the tool's radius; `cut` (M,) is the number of the cut, from one rapid to the next.
    `middle_reach_mm` (M, 3) is a circle about all that a piece sweeps: X, Y and radius.
    """

    start_mm: np.ndarray
    end_mm: np.ndarray
    way_radius_mm: np.ndarray
    cut: np.ndarray
    middle_reach_mm: np.ndarray


def engagement(states: PathStates, normal: np.ndarray, radii_mm: np.ndarray) -> Engagement:
    """What the last cut found in front of the final surface.

    For every contact, the line along the horizontal part of the normal is met with the stadiums
    that the tool's earlier passes swept at that depth; material begins where the first of them
    is entered: the radial depth. It is bounded by the tool's diameter, and zero where the normal
    is vertical. A cut, from one rapid to the next, that would have taken the surface itself away
    is not counted: the surface was measured, so that cut is not as it is written, or the point is
    of another feature.

    Parameters
    ----------
    states : PathStates
        At contacts with a surface.
    normal : (P, 3) float64
        Of that surface, outward.
    radii_mm : (T,) float64
        Of tool number k at index k; NaN where there is no such tool.
    """
    first, of = alike_rows([states.move, states.parameter, states.contact_mm, normal])
    radial_mm, top_mm = _of_each(states[first], normal[first], radii_mm)
    return Engagement(radial_mm[of], top_mm[of])


def _of_each(
    states: PathStates, normal: np.ndarray, radii_mm: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    flat = np.hypot(normal[:, 0], normal[:, 1])
    sideways = flat > _VERTICAL
    direction = normal[:, :2] / np.where(sideways, flat, 1.0)[:, None]
    length = _across_axis_mm(states.moves)
    way = np.cumsum(length) - length
    contacts = _Contacts(
        states.nose_mm + states.tool_mm + states.contact_mm,
        np.where(sideways[:, None], direction, 0.0),
        way[states.move] + states.parameter * length[states.move],
        radii_mm[states.tool],
    )
    chords = _chords(states, radii_mm, way_mm=way, length_mm=length)
    radial, top = np.zeros(len(normal)), np.full(len(normal), np.inf)

    def kernel(begin: int, end: int) -> None:
        _find_depths(begin, end, contacts, chords, radial, top)

    run_in_parts(kernel, len(normal), least=_LEAST)
    return radial, top


def _across_axis_mm(moves: Moves) -> np.ndarray:
    """Way of every move, (N,), of straight ones across the tool axis: a plunge takes none.

    The hole that a tool plunged into is no earlier pass of the wall beside it.
    """
    flat = np.hypot(*(moves.end_mm - moves.start_mm)[:, :2].T)
    return np.where(moves.kind == MoveKind.ARC, move_length_mm(moves), flat)


def _chords(
    states: PathStates, radii_mm: np.ndarray, *, way_mm: np.ndarray, length_mm: np.ndarray
) -> _Chords:
    """Chords of the whole program; of each move the way before it and its length, (N,)."""
    moves, lengths = states.moves, states.tool_lengths_mm
    tool_length = lengths[np.minimum(moves.tool, len(lengths) - 1)]
    index = np.flatnonzero(np.isfinite(tool_length) & moves.at_feed)
    radius = np.linalg.norm(moves.start_mm[index] - moves.centre_mm[index], axis=1)
    arc_step = np.minimum(_ARC_STEP_RAD, np.sqrt(8.0 * _ARC_SAG_MM / np.maximum(radius, 1e-9)))
    pieces = np.maximum(np.ceil(np.abs(moves.sweep_rad[index]) / arc_step), 1).astype(int)
    move = np.repeat(index, pieces)
    step = np.arange(len(move)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    count = np.repeat(pieces, pieces)
    drop = np.column_stack([np.zeros((len(move), 2)), tool_length[move]])
    way, radii = way_mm[move] + step / count * length_mm[move], radii_mm[moves.tool[move]]
    start = position_at(moves, move, step / count) - drop
    end = position_at(moves, move, (step + 1) / count) - drop
    half = 0.5 * (end - start)[:, :2]
    return _Chords(
        start,
        end,
        np.column_stack([way, radii]),
        np.cumsum(moves.kind == MoveKind.RAPID)[move],
        np.column_stack([start[:, :2] + half, np.hypot(*half.T) + radii]),
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _find_depths(begin, end, contacts, chords, depth, top):
    """Depth at some contacts, and the height to which material before it reached, (P,) mm."""
    for k in range(begin, end):
        if contacts.direction[k, 0] != 0.0 or contacts.direction[k, 1] != 0.0:
            depth[k] = _depth(contacts, k, chords)
            top[k] = _top(contacts, k, chords, 0.5 * depth[k])


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _top(contacts, k, chords, before):
    """Lowest tip of earlier passes over what lies `before` contact k, mm outwards; inf if none."""
    start, end, height = chords.start_mm, chords.end_mm, contacts.position_mm[k, 2]
    x = contacts.position_mm[k, 0] + before * contacts.direction[k, 0]
    y = contacts.position_mm[k, 1] + before * contacts.direction[k, 1]
    way, top = contacts.way_mm[k] - _SAME_CUT_RADII * contacts.radius_mm[k], np.inf
    for c in range(len(start)):
        left = way - chords.way_radius_mm[c, 0]
        if left <= 0.0:
            break
        tip = max(start[c, 2], end[c, 2])
        if tip < height or tip >= top or _is_beyond(chords, c, (x, y), 0.0):
            continue
        chord_x, chord_y = end[c, 0] - start[c, 0], end[c, 1] - start[c, 1]
        share = min(1.0, left / max(math.hypot(chord_x, chord_y), left))
        offset, chord = (x - start[c, 0], y - start[c, 1]), (share * chord_x, share * chord_y)
        if _distance(offset, chord) < chords.way_radius_mm[c, 1]:
            top = tip
    return top


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _depth(contacts, k, chords):
    """Way from contact k to the nearest pass of an earlier cut that leaves the surface, mm."""
    point, start, end, cut = contacts.position_mm[k], chords.start_mm, chords.end_mm, chords.cut
    normal = (contacts.direction[k, 0], contacts.direction[k, 1])
    way = contacts.way_mm[k] - _SAME_CUT_RADII * contacts.radius_mm[k]
    nearest = 2.0 * contacts.radius_mm[k]
    in_cut, gouges = nearest, False
    for c in range(len(start)):
        if c > 0 and cut[c] != cut[c - 1]:
            nearest = nearest if gouges else min(nearest, in_cut)
            in_cut, gouges = nearest, False
        left = way - chords.way_radius_mm[c, 0]
        if left <= 0.0:
            break
        if min(start[c, 2], end[c, 2]) > point[2] or _is_beyond(chords, c, point, in_cut):
            continue
        x, y = end[c, 0] - start[c, 0], end[c, 1] - start[c, 1]
        # of the chord that the tool is on, only what lies well behind it
        share = min(1.0, left / max(math.sqrt(x * x + y * y), left))
        offset = (point[0] - start[c, 0], point[1] - start[c, 1])
        chord, radius = (share * x, share * y), chords.way_radius_mm[c, 1]
        in_cut = min(in_cut, _entry(offset, normal, chord, radius))
        gouges = gouges or _distance(offset, chord) < radius - _GOUGE_MM
    return max(nearest if gouges else min(nearest, in_cut), 0.0)


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _is_beyond(chords, c, point, way):
    """Whether nothing that chord c sweeps lies within some way of a point."""
    x, y = chords.middle_reach_mm[c, 0] - point[0], chords.middle_reach_mm[c, 1] - point[1]
    reach = chords.middle_reach_mm[c, 2] + way
    return x * x + y * y > reach * reach


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _distance(offset, chord):
    """Distance of a point from a chord that begins at the origin."""
    squared = chord[0] * chord[0] + chord[1] * chord[1]
    along = offset[0] * chord[0] + offset[1] * chord[1]
    share = min(max(along / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    return math.hypot(offset[0] - share * chord[0], offset[1] - share * chord[1])


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _entry(offset, normal, chord, radius):
    """Where the line offset + s normal enters the stadium about a chord from 0, s >= 0.

    inf if it misses. A stadium is a disc at each end and the strip between them.
    """
    from_end = (offset[0] - chord[0], offset[1] - chord[1])
    discs = min(_into_disc(offset, normal, radius), _into_disc(from_end, normal, radius))
    return min(discs, _into_strip(offset, normal, chord, radius))


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _into_disc(offset, normal, radius):
    """Where the line enters the disc about 0; inf if it misses."""
    middle = -(offset[0] * normal[0] + offset[1] * normal[1])
    aside_squared = offset[0] * offset[0] + offset[1] * offset[1] - middle * middle
    half_squared = radius * radius - aside_squared
    if half_squared <= 0.0:
        return np.inf
    half = math.sqrt(half_squared)
    return max(middle - half, 0.0) if middle + half > _NOTHING_MM else np.inf


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _into_strip(offset, normal, chord, radius):
    """Where the line enters the rectangle of half width `radius` along a chord; inf if never."""
    length = math.sqrt(chord[0] * chord[0] + chord[1] * chord[1])
    if length == 0.0:
        return np.inf
    tx, ty = chord[0] / length, chord[1] / length
    slope = normal[0] * -ty + normal[1] * tx
    if abs(slope) < _PARALLEL:
        return np.inf
    aside = offset[0] * -ty + offset[1] * tx
    first, last = (-radius - aside) / slope, (radius - aside) / slope
    low, high = min(first, last), max(first, last)
    # the part of the line over the chord itself
    rate, base = normal[0] * tx + normal[1] * ty, offset[0] * tx + offset[1] * ty
    if abs(rate) >= _PARALLEL:
        first, last = -base / rate, (length - base) / rate
        low, high = max(low, min(first, last)), min(high, max(first, last))
    elif base < 0.0 or base > length:
        return np.inf
    return max(low, 0.0) if high > max(low, _NOTHING_MM) else np.inf
