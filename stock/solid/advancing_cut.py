"""Cutting from one side of the blank to the other, so that memory stays bounded.

Strokes are taken in blocks in the order in which they begin along one axis. What lies behind
everything still to come is finished: it is split off at a front and handed out. Later blocks
never reach back to a front, so the pieces fit together once the walls there are left out.

Source: closed form derived here: strokes sorted by their first coordinate never reach back.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator

import numpy as np
from manifold3d import Manifold

from stock.solid.block_unions import block_unions
from stock.solid.cutter_solids import CutterSolids

__all__ = ["BLOCK_STROKES", "finished_pieces"]

#: strokes that are cut before finished material is split off
BLOCK_STROKES = 4000
#: how far behind the next stroke the front stays, mm; odd, to keep off planes of the part
_FRONT_GAP_MM = 0.0173


def finished_pieces(
    solid: Manifold,
    cutters: CutterSolids,
    *,
    block_strokes: int = BLOCK_STROKES,
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[Manifold]:
    """Cut `solid` and yield it in pieces, from low to high along X or Y.

    `progress` is told every few strokes how many of how many are cut.
    """
    low, high = cutters.boxes()
    bounds = np.reshape(solid.bounding_box(), (2, 3))
    index = np.flatnonzero(((low < bounds[1]) & (high > bounds[0])).all(axis=1))
    finished_count = 0

    telling = threading.Lock()

    def done(count: int) -> None:
        nonlocal finished_count
        with telling:
            finished_count += count
            if progress:
                progress(finished_count, len(index))

    extent = (high - low)[index, :2].sum(axis=0) / (bounds[1] - bounds[0])[:2]
    axis = int(np.argmin(extent))
    normal = (1.0, 0.0, 0.0) if axis == 0 else (0.0, 1.0, 0.0)
    index = index[np.argsort(low[index, axis], kind="stable")]
    blocks = [index[k : k + block_strokes] for k in range(0, len(index), block_strokes)]
    with contextlib.closing(block_unions(cutters, blocks, done)) as unions:
        for number, union in enumerate(unions, 1):
            solid = solid - union
            rest = index[number * block_strokes :]
            if len(rest) and low[rest[0], axis] - _FRONT_GAP_MM > bounds[0, axis]:
                solid, finished = solid.split_by_plane(normal, low[rest[0], axis] - _FRONT_GAP_MM)
                yield finished
    yield solid
