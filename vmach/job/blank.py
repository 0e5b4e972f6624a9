"""The blank of a job: a box, or a solid in a file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vmach.errors import InputError
from vmach.job.schema import JobSchema

if TYPE_CHECKING:
    import trimesh

__all__ = ["Blank", "read_blank"]


@dataclass(frozen=True)
class Blank:
    """The material before the first cut, in workpiece coordinates.

    Attributes
    ----------
    min_mm, max_mm : (3,) float64
        Corners of the box, or of the solid's bounding box.
    file : Path or None
        A solid, where the blank is no box.
    mesh : trimesh.Trimesh or None
        Its surface.
    """

    min_mm: np.ndarray
    max_mm: np.ndarray
    file: Path | None = None
    mesh: trimesh.Trimesh | None = None

    @property
    def solid(self) -> tuple[np.ndarray, np.ndarray] | trimesh.Trimesh:
        """The blank as the removal engine takes it: two corners, (3,) mm each, or a mesh."""
        return (self.min_mm, self.max_mm) if self.mesh is None else self.mesh

    @property
    def volume_mm3(self) -> float:
        """How much material there is."""
        box = np.prod(self.max_mm - self.min_mm)
        return float(box if self.mesh is None else self.mesh.volume)


def read_blank(data: JobSchema, folder: Path, at: Callable[..., dict[str, Any]]) -> Blank | None:
    """The blank of a job file; None where it states none.

    Parameters
    ----------
    data : JobSchema
    folder : Path
        Of the job file.
    at : callable
        From the keys of an entry to its file and line.

    Raises
    ------
    InputError
        Both a box and a file, half a box, corners in the wrong order, or no such file.
    """
    stock = data.stock
    if stock is None:
        return None
    if stock.file is not None:
        if stock.min_mm or stock.max_mm:
            what = f"[stock] has both a box and file = {str(stock.file)!r}"
            raise InputError(what, **at("stock"), accepted="one of the two")
        return _from_file(folder / stock.file, stock.unit, at("stock", "file"))
    if stock.min_mm is None or stock.max_mm is None:
        raise InputError(
            f"[stock] has min_mm = {stock.min_mm} and max_mm = {stock.max_mm}",
            **at("stock"),
            accepted="min_mm and max_mm, or file",
        )
    low, high = np.array(stock.min_mm), np.array(stock.max_mm)
    if not (low < high).all():
        raise InputError(
            f"[stock] min_mm {list(stock.min_mm)} is not below max_mm {list(stock.max_mm)}",
            **at("stock", "max_mm"),
            accepted="min_mm smaller than max_mm in X, Y and Z",
        )
    return Blank(low, high)


def _from_file(file: Path, unit: str | None, where: dict[str, Any]) -> Blank:
    import trimesh  # late: it takes half a second, and only solids need it

    from vmach.nominal import read_nominal

    if not file.is_file():
        raise InputError(f"file = '{file.name}': no such file", **where)
    part = read_nominal(file, unit)
    low, high = part.bounds_mm
    mesh = trimesh.Trimesh(part.mesh.vertices_mm, part.mesh.triangles, process=False)
    return Blank(low, high, file, mesh)
