"""Collisions along the program: rapid moves in material, shank or holder in the stock.

The stock is followed as dexels while the program cuts it. Each body is a shape of revolution
seen as a table of its lowest and highest point over the radius; it stops at closely spaced
places along every stroke and is held against the lines below it. What is reported is real on
that line; a contact that is narrower than a cell, or no deeper than the clearance, is not
reported.

Source: T. Van Hook, Real-time shaded NC milling display, SIGGRAPH 1986 (dexels); closed form
derived here: bodies of revolution as lowest and highest height over the radius.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from stock.collision.dexels import Dexels, dexels_of, overlap, remove
from stock.compile_ahead import await_compiled
from stock.compiled import njit_kernel, njit_part
from stock.errors import StockError
from stock.solid.blank import blank_solid
from stock.solid.joined_strokes import JoinedStrokes, join_strokes
from stock.solid.ring_stack import ring_stack
from stock.solid.strokes import Strokes, strokes_of
from stock.sweeps import Sweeps
from stock.tools import Tool

__all__ = ["Collision", "find_collisions", "follow"]

#: what a collision is called, by the body that meets material
KINDS = ("rapid in material", "shank", "holder")
_CUTTER = 0
#: radii at which a body's lowest and highest point are tabulated
_RADII = 1025
#: most cells that the default grid has
_CELLS = 400_000
#: strokes between two calls of `progress`
_BATCH = 2000
#: more strokes than this are joined where they keep to one line within this share of the clearance
_FEW_STROKES, _JOINED = 100_000, 0.1

Outline = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Collision:
    """One move that brings a part of the tool where it must not be.

    Attributes
    ----------
    move : int
        The move of the program.
    kind : str
        ``rapid in material``, ``shank`` or ``holder``.
    depth_mm : float
        Height of the material inside the body where it is greatest.
    place_mm : (3,) float64
        Where that is: the lowest point of that material, workpiece coordinates.
    """

    move: int
    kind: str
    depth_mm: float
    place_mm: np.ndarray


def find_collisions(
    sweeps: Sweeps,
    tools: Sequence[Tool],
    blank: Any,
    *,
    rapid_moves: Sequence[int] | np.ndarray = (),
    shanks: Sequence[Outline | None] | None = None,
    holders: Sequence[Outline | None] | None = None,
    cell_mm: float | None = None,
    clearance_mm: float = 0.02,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Collision, ...]:
    """Follow the program through the stock and name the moves that collide.

    Parameters
    ----------
    sweeps : Sweeps
        In cutting order, rapid moves included.
    tools : sequence of Tool
        What ``sweeps.tool`` points into; their cutting part may meet material at feed.
    blank : pair of (3,) float64, or a mesh
        See `stock.solid.blank.blank_solid`.
    rapid_moves : sequence of int
        The moves, in the sense of ``sweeps.move``, that must not touch material at all.
    shanks, holders : sequence of outlines, optional
        One a tool, each None or points (r, z) in mm from the lowest upwards, z from the tool
        tip. The body fills its outline from the axis; between the lowest and the highest
        point over a radius it counts as full.
    cell_mm : float, optional
        Distance of the lines; contacts narrower than it can be missed. By default a tenth of
        the smallest tool's diameter, or what gives 400,000 lines if that is more.
    clearance_mm : float
        Contacts no deeper than this, in radius or height, are none: more than the machine's
        errors, which make tools rub where the nominal program is free.
    progress : callable, optional
        Called now and then with how many of how many strokes are done.

    Returns
    -------
    tuple of Collision
        One a move and kind, in cutting order.

    Raises
    ------
    StockError
        If the blank is no solid, a sweep has no tool, the cell or the clearance makes no
        sense, or there is not one outline a tool.
    """
    sweeps.check_tools(len(tools))
    solid = blank_solid(blank)
    low, high = np.reshape(solid.bounding_box(), (2, 3))
    if cell_mm is None:
        smallest = min(tool.diameter_mm for tool in tools)
        cell_mm = max(smallest / 10, np.sqrt(np.prod((high - low)[:2]) / _CELLS))
    if not (cell_mm > 0 and clearance_mm >= 0):
        raise StockError(
            f"cells of {cell_mm!r} mm and a clearance of {clearance_mm!r} mm",
            accepted="a positive cell and a clearance of zero or more",
        )
    tables = np.stack(
        [
            [_table(_tool_outline(tool)) for tool in tools],
            [_table(outline) for outline in _one_a_tool("shanks", shanks, len(tools))],
            [_table(outline) for outline in _one_a_tool("holders", holders, len(tools))],
        ],
        axis=1,
    )
    strokes, rapid, joined = _strokes(sweeps, rapid_moves, cell_mm, clearance_mm)
    await_compiled(follow)
    worst = _walk(strokes, rapid, tables, dexels_of(solid, cell_mm), clearance_mm, progress)
    return _by_move(strokes, joined, worst, clearance_mm)


def _strokes(
    sweeps: Sweeps, rapid_moves: Sequence[int] | np.ndarray, cell_mm: float, clearance_mm: float
) -> tuple[Strokes, np.ndarray, JoinedStrokes | None]:
    """Strokes, which of them are rapid, and what very many of them were joined of."""
    strokes = strokes_of(sweeps, cell_mm / 10)
    rapid = np.isin(strokes.move, np.asarray(rapid_moves, dtype=np.int64))
    if len(strokes) <= _FEW_STROKES:
        return strokes, rapid, None
    alike = np.append(True, rapid[1:] == rapid[:-1])
    joined = join_strokes(replace(strokes, joined=strokes.joined & alike), _JOINED * clearance_mm)
    first = np.searchsorted(joined.key, np.arange(len(joined.strokes)), side="right")
    return joined.strokes, rapid[first], joined


def _one_a_tool(
    name: str, outlines: Sequence[Outline | None] | None, count: int
) -> Sequence[Outline | None]:
    if outlines is None:
        return [None] * count
    if len(outlines) != count:
        raise StockError(f"{len(outlines)} {name} for {count} tools", accepted="one a tool")
    return outlines


def _tool_outline(tool: Tool) -> np.ndarray:
    return ring_stack(tool, tool.diameter_mm * 1e-4).rings[:, :2]


def _table(outline: Outline | None) -> np.ndarray:
    """Radius step, then lowest and highest height over each radius, (1 + 2 x `_RADII`,).

    A body that is not there has a radius step of zero.
    """
    table = np.zeros(1 + 2 * _RADII)
    if outline is None or len(outline) == 0:
        return table
    points = np.asarray(outline, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise StockError(
            f"an outline of a shank or holder is no list of points: {points.tolist()}",
            accepted="points (r, z), finite numbers in mm",
        )
    if len(points) < 2 or (points[:, 0] < 0).any() or not points[:, 0].max() > 0:
        raise StockError(
            f"an outline of a shank or holder encloses no volume: {points.tolist()}",
            accepted="at least two points (r, z) with r >= 0, from the lowest upwards",
        )
    radii = np.linspace(0.0, points[:, 0].max(), _RADII)
    lowest, highest = np.full(_RADII, np.inf), np.full(_RADII, -np.inf)
    for (r0, z0), (r1, z1) in pairwise(points):
        covered = radii <= max(r0, r1)
        slope = (z1 - z0) / (r1 - r0) if r1 != r0 else 0.0
        crossing = z0 + slope * (radii - r0)
        ends = np.where(radii <= r0, z0, crossing), np.where(radii <= r1, z1, crossing)
        lowest[covered] = np.minimum(lowest, np.minimum(*ends))[covered]
        highest[covered] = np.maximum(highest, np.maximum(*ends))[covered]
    table[0] = radii[1]
    table[1 : 1 + _RADII], table[1 + _RADII :] = lowest, highest
    return table


def _walk(
    strokes: Strokes,
    rapid: np.ndarray,
    tables: np.ndarray,
    dexels: Dexels,
    clearance_mm: float,
    progress: Callable[[int, int], None] | None,
) -> np.ndarray:
    """Worst overlap of each stroke and body, its place, and the share of the stroke, (S, 3, 5)."""
    worst = np.zeros((len(strokes), len(KINDS), 5))
    d = dexels
    grid = (d.origin_mm, d.cell_mm, d.low_mm, d.high_mm, d.count, d.top_mm)
    for begin in range(0, len(strokes), _BATCH):
        batch = slice(begin, begin + _BATCH)
        follow(
            np.stack([strokes.start_mm[batch], strokes.end_mm[batch]], axis=1),
            strokes.tool[batch],
            rapid[batch],
            tables,
            grid,
            clearance_mm,
            worst[batch],
        )
        if progress:
            progress(min(begin + _BATCH, len(strokes)), len(strokes))
    return worst


def _by_move(
    strokes: Strokes, joined: JoinedStrokes | None, worst: np.ndarray, clearance_mm: float
) -> tuple[Collision, ...]:
    found: dict[tuple[int, int], Collision] = {}
    stroke, kind = np.nonzero(worst[..., 0] > clearance_mm)
    contacts = worst[stroke, kind]
    move = strokes.move[stroke] if joined is None else joined.moves_at(stroke, contacts[:, 4])
    for key, contact in zip(zip(move.tolist(), kind.tolist(), strict=True), contacts, strict=True):
        if key not in found or contact[0] > found[key].depth_mm:
            found[key] = Collision(key[0], KINDS[key[1]], float(contact[0]), contact[1:4].copy())
    return tuple(found.values())


@njit_kernel()
def follow(ends, tool, rapid, tables, dexels, clearance, worst) -> None:
    """Hold all bodies against the stock along strokes with `ends`, and let the cutters cut."""
    cell, top = dexels[1], dexels[5]
    for s in range(len(ends)):
        x, y, z = ends[s, 0, 0], ends[s, 0, 1], ends[s, 0, 2]
        dx, dy, dz = ends[s, 1, 0] - x, ends[s, 1, 1] - y, ends[s, 1, 2] - z
        stops = max(int(np.ceil(2 * np.sqrt(dx * dx + dy * dy + dz * dz) / cell)), 1)
        first = 1 if _goes_on(ends, tool, rapid, s) else 0
        cutter = tables[tool[s], _CUTTER]
        if rapid[s]:
            for stop in range(first, stops + 1):
                tip = _between((x, y, z), (dx, dy, dz), stop / stops)
                _hold(tip, cutter, dexels, clearance, worst[s, _CUTTER], stop / stops)
        for stop in range(first, stops + 1):
            tip = _between((x, y, z), (dx, dy, dz), stop / stops)
            for body in range(_CUTTER + 1, len(KINDS)):
                _hold(tip, tables[tool[s], body], dexels, clearance, worst[s, body], stop / stops)
            if tip[2] < top:
                _cut(tip, cutter, dexels)


@njit_part()
def _goes_on(ends, tool, rapid, s) -> bool:
    """Whether a stroke begins as the one before has ended: nothing is new there."""
    if s == 0 or tool[s] != tool[s - 1] or rapid[s] != rapid[s - 1]:
        return False
    begin, before = ends[s, 0], ends[s - 1, 1]
    return begin[0] == before[0] and begin[1] == before[1] and begin[2] == before[2]


@njit_part()
def _between(begin, step, share):
    """The place at a share of a step, (3,)."""
    return begin[0] + step[0] * share, begin[1] + step[1] * share, begin[2] + step[2] * share


@njit_part()
def _span(centre: float, radius: float, origin: float, cell: float, count: int):
    """Range of the lines within `radius` of `centre` along one direction."""
    first = max(int(np.ceil((centre - radius - origin) / cell)), 0)
    return range(first, min(int(np.floor((centre + radius - origin) / cell)), count - 1) + 1)


@njit_part()
def _hold(tip, table, dexels, clearance, worst, share) -> None:
    """Longest stretch of material inside a body, made smaller by the clearance, at one place."""
    origin, cell, low, high, count, highest = dexels
    if table[0] == 0.0 or tip[2] + table[1] >= highest:
        return
    radius = table[0] * (_RADII - 1) - clearance
    for i in _span(tip[0], radius, origin[0], cell, count.shape[0]):
        for j in _span(tip[1], radius, origin[1], cell, count.shape[1]):
            x, y = origin[0] + i * cell, origin[1] + j * cell
            off = np.hypot(x - tip[0], y - tip[1])
            if off <= radius and count[i, j] > 0:
                k = min(int((off + clearance) / table[0]) + 1, _RADII - 1)
                bottom, top = tip[2] + table[1 + k], tip[2] + table[1 + _RADII + k]
                depth, z = overlap(low[i, j], high[i, j], count[i, j], bottom, top)
                if depth > worst[0]:
                    worst[0], worst[1], worst[2], worst[3], worst[4] = depth, x, y, z, share


@njit_part()
def _cut(tip, table, dexels) -> None:
    """Take the cutting part out of the lines below it."""
    origin, cell, low, high, count, _ = dexels
    radius = table[0] * (_RADII - 1)
    for i in _span(tip[0], radius, origin[0], cell, count.shape[0]):
        for j in _span(tip[1], radius, origin[1], cell, count.shape[1]):
            off = np.hypot(origin[0] + i * cell - tip[0], origin[1] + j * cell - tip[1])
            if off <= radius and count[i, j] > 0:
                k = min(int(off / table[0]) + 1, _RADII - 1)
                bottom, top = tip[2] + table[1 + k], tip[2] + table[1 + _RADII + k]
                count[i, j] = remove(low[i, j], high[i, j], count[i, j], bottom, top)
