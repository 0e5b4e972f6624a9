"""Dexels: the material as intervals on vertical lines, one line a cell of a grid.

On its line a dexel is exact; what fits between neighbouring lines is not seen.

Source: T. Van Hook, Real-time shaded NC milling display, SIGGRAPH 1986.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from manifold3d import Manifold

from stock.compiled import njit_kernel, njit_part

__all__ = ["Dexels", "dexels_of", "overlap", "remove"]

#: intervals that one line can hold; where a cut would need more, material stays
_INTERVALS = 4
#: lines stand beside the middle of their cells by this share of one, off planes of the part
_ASIDE = 1.37e-4


@dataclass(frozen=True)
class Dexels:
    """Material on a grid of vertical lines, changed in place while it is cut.

    Attributes
    ----------
    origin_mm : (2,) float64
        Where line (0, 0) stands.
    cell_mm : float
    low_mm, high_mm : (I, J, 4) float64
        Ends of the intervals.
    count : (I, J) int64
        How many intervals each line has.
    top_mm : float
        No material lies higher.
    """

    origin_mm: np.ndarray
    cell_mm: float
    low_mm: np.ndarray
    high_mm: np.ndarray
    count: np.ndarray
    top_mm: float


def dexels_of(solid: Manifold, cell_mm: float) -> Dexels:
    """Dexels of a solid."""
    mesh = solid.to_mesh64()
    corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts)]
    low, high = np.reshape(solid.bounding_box(), (2, 3))
    shape = np.maximum(np.ceil((high - low)[:2] / cell_mm).astype(np.int64), 1)
    origin = low[:2] + (0.5 + _ASIDE) * cell_mm
    crossings = np.zeros((*shape, 2 * _INTERVALS))
    count = np.zeros(shape, dtype=np.int64)
    _cross(corners, origin, cell_mm, crossings, count)
    order = np.where(np.arange(2 * _INTERVALS) < count[..., None], crossings, np.inf)
    crossings = np.sort(order, axis=-1)
    return Dexels(
        origin,
        cell_mm,
        np.ascontiguousarray(crossings[..., 0::2]),
        np.ascontiguousarray(crossings[..., 1::2]),
        count // 2,
        float(high[2]),
    )


@njit_kernel()
def _cross(
    corners: np.ndarray,
    origin: np.ndarray,
    cell: float,
    crossings: np.ndarray,
    count: np.ndarray,
) -> None:
    """Heights at which the triangles `corners` (T, 3, 3) cross each line."""
    for a, b, c in corners:
        twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if twice == 0.0:
            continue
        first_i = max(int(np.ceil((min(a[0], b[0], c[0]) - origin[0]) / cell)), 0)
        last_i = int(np.floor((max(a[0], b[0], c[0]) - origin[0]) / cell))
        first_j = max(int(np.ceil((min(a[1], b[1], c[1]) - origin[1]) / cell)), 0)
        last_j = int(np.floor((max(a[1], b[1], c[1]) - origin[1]) / cell))
        for i in range(first_i, min(last_i, count.shape[0] - 1) + 1):
            for j in range(first_j, min(last_j, count.shape[1] - 1) + 1):
                x, y = origin[0] + i * cell, origin[1] + j * cell
                u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / twice
                v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / twice
                if u >= 0.0 and v >= 0.0 and u + v <= 1.0 and count[i, j] < crossings.shape[2]:
                    crossings[i, j, count[i, j]] = u * a[2] + v * b[2] + (1.0 - u - v) * c[2]
                    count[i, j] += 1


@njit_part()
def overlap(
    low: np.ndarray, high: np.ndarray, count: int, bottom: float, top: float
) -> tuple[float, float]:
    """Longest stretch of one line's material, intervals (K,), between heights, and its begin."""
    longest, begins = 0.0, 0.0
    for k in range(count):
        begin, end = max(low[k], bottom), min(high[k], top)
        if end - begin > longest:
            longest, begins = end - begin, begin
    return longest, begins


@njit_part()
def remove(low: np.ndarray, high: np.ndarray, count: int, bottom: float, top: float) -> int:
    """Take what lies between two heights from one line, intervals (K,); returns their number."""
    k = 0
    while k < count:
        if top <= low[k] or bottom >= high[k]:
            k += 1
        elif bottom <= low[k] and top >= high[k]:
            count -= 1
            for later in range(k, count):
                low[later], high[later] = low[later + 1], high[later + 1]
        elif bottom <= low[k]:
            low[k] = top
            k += 1
        elif top >= high[k]:
            high[k] = bottom
            k += 1
        else:
            if count < len(low):
                for later in range(count, k, -1):
                    low[later], high[later] = low[later - 1], high[later - 1]
                high[k], low[k + 1] = bottom, top
                count += 1
            return count
    return count
