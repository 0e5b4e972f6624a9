"""Files of the virtual part: STL, 3MF and glTF, written whole or not at all.

Source: ISO/IEC 12113 (glTF 2.0), 3MF Core Specification, 3D Systems' STL.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from stock.errors import StockError
from stock.solid import VirtualPart
from stock.solid.threemf import threemf_bytes

__all__ = ["PART_FORMATS", "write_part"]


def write_part(part: VirtualPart, path: str | Path, *, colours: np.ndarray | None = None) -> None:
    """Write the part in the format that the suffix asks for.

    The file appears under its name only once it is complete.

    Parameters
    ----------
    part : VirtualPart
    path : path
        Ending in ``.stl`` (binary, mm, single precision), ``.3mf`` (mm, nine digits) or
        ``.glb`` (binary glTF: metres, Y up, single precision).
    colours : (V, 3) or (V, 4) uint8, optional
        Colour of each vertex, red, green, blue and opacity. STL cannot carry it.

    Raises
    ------
    StockError
        If the suffix is unknown or the colours do not fit the vertices.
    """
    path = Path(path)
    encode = PART_FORMATS.get(path.suffix.lower())
    if encode is None:
        raise StockError(
            f"no format is known for the file {path.name!r}", accepted=", ".join(PART_FORMATS)
        )
    if colours is not None:
        colours = _checked(colours, len(part.vertices_mm))
    _write_whole(path, encode(part, colours))


def _checked(colours: np.ndarray, rows: int) -> np.ndarray:
    colours = np.asarray(colours)
    if colours.dtype != np.uint8 or colours.shape not in ((rows, 3), (rows, 4)):
        raise StockError(
            f"colours of shape {colours.shape} and type {colours.dtype}",
            accepted=f"uint8 of shape ({rows}, 3) or ({rows}, 4), one row a vertex",
        )
    opaque = np.full((rows, 1), 255, dtype=np.uint8)
    return colours if colours.shape[1] == 4 else np.hstack([colours, opaque])


def _stl(part: VirtualPart, colours: np.ndarray | None) -> bytes:
    return _mesh(part.vertices_mm, part.triangles).export(file_type="stl")


def _glb(part: VirtualPart, colours: np.ndarray | None) -> bytes:
    x, y, z = part.vertices_mm.T / 1000.0
    mesh = _mesh(np.column_stack([x, z, -y]), part.triangles, vertex_colors=colours)
    return mesh.export(file_type="glb")


def _mesh(vertices_mm: np.ndarray, triangles: np.ndarray, **more: Any) -> Any:
    import trimesh  # late: it takes half a second, and only files of solids need it

    return trimesh.Trimesh(vertices_mm, triangles, process=False, **more)


def _threemf(part: VirtualPart, colours: np.ndarray | None) -> bytes:
    return threemf_bytes(part.vertices_mm, part.triangles, colours)


def _write_whole(path: Path, data: bytes) -> None:
    """Write beside the target and rename, so that an interrupt leaves nothing half-written."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}-")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


#: suffix -> what encodes a part and the colours of its vertices
PART_FORMATS: dict[str, Callable[[VirtualPart, np.ndarray | None], bytes]] = {
    ".stl": _stl,
    ".3mf": _threemf,
    ".glb": _glb,
}
