"""The blank: the material before the first cut, as a solid."""

from __future__ import annotations

from typing import Any

import numpy as np
from manifold3d import Error, Manifold, Mesh64

from stock.errors import StockError

__all__ = ["blank_solid"]


def blank_solid(blank: Any) -> Manifold:
    """A solid from a box or from a closed triangle mesh.

    Parameters
    ----------
    blank : pair of (3,) float64, or a mesh
        Opposite corners of a box in mm, or anything with `vertices` (V, 3) in mm and `faces`
        (T, 3), such as a `trimesh.Trimesh`.

    Raises
    ------
    StockError
        If the box has no volume or the mesh is not closed.
    """
    if hasattr(blank, "vertices") and hasattr(blank, "faces"):
        return _from_mesh(np.asarray(blank.vertices), np.asarray(blank.faces))
    low, high = (np.asarray(corner, dtype=np.float64) for corner in blank)
    if low.shape != (3,) or not np.isfinite([low, high]).all() or not (high > low).all():
        raise StockError(
            f"blank from {low.tolist()} to {high.tolist()} mm has no volume",
            accepted="two opposite corners, the lower one first",
        )
    return Manifold.cube(tuple(high - low)).translate(tuple(low)).as_original()


def _from_mesh(vertices_mm: np.ndarray, faces: np.ndarray) -> Manifold:
    solid = Manifold(
        Mesh64(
            np.array(vertices_mm, dtype=np.float64, order="C"),
            np.array(faces, dtype=np.uint64, order="C"),
        )
    )
    if solid.status() != Error.NoError or solid.is_empty():
        raise StockError(
            f"the blank's mesh of {len(faces)} triangles is no closed solid"
            f" ({solid.status().name})",
            accepted="a watertight mesh with its triangles outwards",
            hint="an STL file needs its equal vertices merged first",
        )
    if solid.volume() <= 0:
        raise StockError(
            f"the blank's mesh encloses a volume of {solid.volume():g} mm3",
            accepted="a mesh with its triangles outwards",
        )
    return solid.as_original()
