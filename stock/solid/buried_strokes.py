"""Strokes that take nothing which others do not take as well, found before any solid is made.

Roughing is full of them: what a deeper cut, or a wider one at the same depth, removes later need
not be united first. The blank is looked at from above, in square cells. A cell that some stroke
covers whole is empty above that stroke's floor; the lowest such floor is the cell's, and the
stroke its owner. A stroke is buried where it owns no cell and keeps above the floor of every cell
that it touches. Footprints and floors are taken on the safe side, so that leaving the buried
strokes out leaves the part as it is.

Source: closed form derived here: a cell that one footprint covers whole is empty above its floor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stock.compiled import njit_kernel, njit_maker, njit_part

__all__ = ["Footprints", "needed_strokes"]

#: side of a cell, mm: a finishing allowance is wider than twice that
_CELL_MM = 0.1
#: cells of the blank, at most
_MOST_CELLS = 4_000_000
#: cells that all strokes cover together, at most: a second or two of work
_MOST_VISITS = 1_000_000_000


@dataclass(frozen=True)
class Footprints:
    """What strokes reach, seen from above, and how deep.

    Attributes
    ----------
    start_mm, end_mm : (S, 2) float64
        Tool axis at both ends.
    outer_mm, low_mm : (S,) float64
        Radius around the axis beyond which a stroke takes nothing; height below which it takes
        nothing.
    inner_mm, floor_mm : (S, L) float64
        Each stroke takes everything above the floor within the inner radius, for each of L
        pairs; an inner radius of 0 says nothing.
    """

    start_mm: np.ndarray
    end_mm: np.ndarray
    outer_mm: np.ndarray
    low_mm: np.ndarray
    inner_mm: np.ndarray
    floor_mm: np.ndarray


def needed_strokes(footprints: Footprints, low_mm: np.ndarray, high_mm: np.ndarray) -> np.ndarray:
    """Strokes without which the part would not be the same, (S,) bool.

    Parameters
    ----------
    footprints : Footprints
    low_mm, high_mm : (3,) float64
        Box around the blank.
    """
    f, size = footprints, high_mm - low_mm
    cell_mm = max(
        _CELL_MM,
        np.sqrt(size[0] * size[1] / _MOST_CELLS),
        np.sqrt(_covered_mm2(f, size) / _MOST_VISITS),
    )
    columns, rows = np.ceil(size[:2] / cell_mm).astype(np.int64)
    depth = np.full((rows, columns), high_mm[2])
    owner = np.full((rows, columns), -1, dtype=np.int32)
    grid = np.array([low_mm[0], low_mm[1], cell_mm, low_mm[2]])
    for inner_mm, floor_mm in zip(f.inner_mm.T.copy(), f.floor_mm.T.copy(), strict=True):
        _cover(depth, owner, grid, f.start_mm, f.end_mm, inner_mm, floor_mm)
    needed = _reaches_floor(depth, grid, f.start_mm, f.end_mm, f.outer_mm, f.low_mm)
    needed[owner[owner >= 0]] = True
    return needed


def _covered_mm2(footprints: Footprints, size_mm: np.ndarray) -> float:
    """Area of all cells that are looked at, again and again, about."""
    f = footprints
    length = np.linalg.norm(f.end_mm - f.start_mm, axis=1)
    radii = np.column_stack([f.outer_mm, f.inner_mm])
    area = (length[:, None] + 2.0 * radii) * 2.0 * radii
    return float(np.minimum(area, size_mm[0] * size_mm[1]).sum())


@njit_kernel()
def _cover(
    depth: np.ndarray,
    owner: np.ndarray,
    grid: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
    radius: np.ndarray,
    floor: np.ndarray,
) -> None:
    """Lower every cell to the lowest floor of the strokes that cover it whole."""
    rows, columns = depth.shape
    cell = grid[2]
    for i in range(len(start)):
        r = radius[i]
        if r <= 0.0:
            continue
        bottom = max(floor[i], grid[3])
        first, last = _rows(start[i], end[i], r, grid, rows)
        for row in range(first, last):
            y = grid[1] + row * cell
            left, right = _chord(start[i], end[i], r, y)
            left1, right1 = _chord(start[i], end[i], r, y + cell)
            left, right = max(left, left1), min(right, right1)
            if left > right:
                continue
            begin = max(int(np.ceil((left - grid[0]) / cell)), 0)
            finish = min(int(np.floor((right - grid[0]) / cell)), columns)
            for column in range(begin, finish):
                if bottom < depth[row, column]:
                    depth[row, column] = bottom
                    owner[row, column] = i


@njit_maker()
def _reaches_floor(
    depth: np.ndarray,
    grid: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
    radius: np.ndarray,
    low: np.ndarray,
) -> np.ndarray:
    """Strokes that reach as low as the floor of a cell that they touch."""
    rows, columns = depth.shape
    cell = grid[2]
    reaches = np.zeros(len(start), dtype=np.bool_)
    for i in range(len(start)):
        r = radius[i] + cell / 2
        first, last = _rows(start[i], end[i], r, grid, rows)
        for row in range(first, last):
            if reaches[i]:
                break
            left, right = _chord(start[i], end[i], r, grid[1] + (row + 0.5) * cell)
            if left > right:
                continue
            begin = max(int(np.floor((left - grid[0]) / cell)), 0)
            finish = min(int(np.ceil((right - grid[0]) / cell)), columns)
            for column in range(begin, finish):
                # where all is taken down to the blank's underside nothing is left to take
                if low[i] <= depth[row, column] and depth[row, column] > grid[3]:
                    reaches[i] = True
                    break
    return reaches


@njit_part()
def _rows(
    start: np.ndarray, end: np.ndarray, radius: float, grid: np.ndarray, rows: int
) -> tuple[int, int]:
    """Range of rows that a stroke reaches."""
    first = int(np.floor((min(start[1], end[1]) - radius - grid[1]) / grid[2]))
    last = int(np.ceil((max(start[1], end[1]) + radius - grid[1]) / grid[2]))
    return max(first, 0), min(last, rows)


@njit_part()
def _chord(start: np.ndarray, end: np.ndarray, radius: float, y: float) -> tuple[float, float]:
    """Range of X in which a stroke of that radius covers the line at `y`; empty: (inf, -inf)."""
    left, right = np.inf, -np.inf
    for k in range(2):
        x, off = (start[0], y - start[1]) if k == 0 else (end[0], y - end[1])
        if abs(off) <= radius:
            half = np.sqrt(radius**2 - off**2)
            left, right = min(left, x - half), max(right, x + half)
    along_x, along_y = end[0] - start[0], end[1] - start[1]
    length = np.hypot(along_x, along_y)
    if length == 0.0:
        return left, right
    side_x, side_y = -along_y / length * radius, along_x / length * radius
    for side in (-1.0, 1.0):  # the long sides of the rectangle between the ends
        x0, y0 = start[0] + side * side_x, start[1] + side * side_y
        if min(y0, y0 + along_y) <= y <= max(y0, y0 + along_y) and along_y != 0.0:
            x = x0 + (y - y0) / along_y * along_x
            left, right = min(left, x), max(right, x)
    return left, right
