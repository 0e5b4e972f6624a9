"""Spatial grid: the displacement of the tool tip on a lattice of X, Y, Z, at one tool length.

This form is our own, in the spirit of the "spatial error grid" of ISO/TR 16907:
``grid.csv`` with ``x_mm,y_mm,z_mm,dx_um,dy_um,dz_um``, every combination of the positions of X, Y
and Z once, X slowest; positions of the spindle nose in machine coordinates. Displacements are
actual minus nominal; the control subtracts them, linear in each coordinate between grid points
and held beyond. The tool length stands in the first line.

Source: ISO/TR 16907, spatial error grid.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.sparse import csr_matrix, diags, identity
from scipy.sparse.linalg import splu

from vmach.base.units import mm_from_um, um_from_mm
from vmach.controller_tables.knots import Knots, hat_matrix
from vmach.controller_tables.samples import ErrorSamples
from vmach.controller_tables.table_format import TableFormat
from vmach.controller_tables.table_task import TableTask
from vmach.errors import InputError
from vmach.files.text_file import read_text

__all__ = ["FORMATS", "SpatialGrid", "fit_grid", "read_grid", "write_grid"]

_COLUMNS = ("x_mm", "y_mm", "z_mm", "dx_um", "dy_um", "dz_um")
_HEAD = """# displacement of the tool tip, actual minus nominal, at tool length {length:.4f} mm
# holds: any error that is a function of X, Y, Z at this tool length
# does not hold: other tool lengths, reversal (the mean of both directions), the tilt of the tool
"""
_RIDGE = 1e-9


@dataclass(frozen=True)
class SpatialGrid:
    """Displacements on a lattice.

    Attributes
    ----------
    axes_mm : (array, array, array)
        Positions of X, Y, Z, increasing.
    error_mm : (Nx, Ny, Nz, 3) float64
    """

    axes_mm: tuple[np.ndarray, np.ndarray, np.ndarray]
    error_mm: np.ndarray

    def applied_correction(
        self, nose_mm: np.ndarray, direction: np.ndarray, tool_mm: np.ndarray
    ) -> np.ndarray:
        """What is added to the commanded positions, (P, 3) mm: minus the displacement there."""
        inside = np.column_stack(
            [np.clip(q, a[0], a[-1]) for q, a in zip(nose_mm.T, self.axes_mm, strict=True)]
        )
        return -RegularGridInterpolator(self.axes_mm, self.error_mm)(inside)


def fit_grid(knots: tuple[Knots, Knots, Knots], samples: ErrorSamples) -> SpatialGrid:
    """Displacements on the knots that leave the least mean square over the samples.

    The same normal equations as in `vmach.controller_tables.projection`, with products of three
    hat functions.
    """
    axes = tuple(one.position_mm for one in knots)
    x, y, z = (hat_matrix(a, q) for a, q in zip(axes, samples.nose_mm.T, strict=True))
    matrix = _row_products(_row_products(x, y), z)
    weighted = matrix.T @ diags(samples.weight)
    gram = weighted @ matrix
    ridge = _RIDGE * gram.diagonal().mean() * identity(gram.shape[0])
    nodes = splu((gram + ridge).tocsc()).solve(weighted @ samples.error_mm)
    return SpatialGrid(axes, nodes.reshape(*map(len, axes), 3))


def _row_products(a: csr_matrix, b: csr_matrix) -> csr_matrix:
    """Row by row Kronecker product of matrices with the same number of entries in each row."""
    rows, per_a, per_b = a.shape[0], a.nnz // a.shape[0], b.nnz // b.shape[0]
    left, right = a.indices.reshape(rows, per_a, 1), b.indices.reshape(rows, 1, per_b)
    values = a.data.reshape(rows, per_a, 1) * b.data.reshape(rows, 1, per_b)
    columns = left.astype(np.int64) * b.shape[1] + right
    start = np.arange(rows + 1) * per_a * per_b
    shape = (rows, a.shape[1] * b.shape[1])
    return csr_matrix((values.ravel(), columns.ravel(), start), shape=shape)


def write_grid(folder: Path, grid: SpatialGrid, *, tool_length_mm: float) -> list[Path]:
    """Write ``grid.csv``."""
    lattice = np.stack(np.meshgrid(*grid.axes_mm, indexing="ij"), axis=-1).reshape(-1, 3)
    rows = np.hstack([lattice, um_from_mm(grid.error_mm.reshape(-1, 3))])
    lines = [",".join(f"{value + 0.0:.4f}" for value in row) for row in rows]
    text = _HEAD.format(length=tool_length_mm) + ",".join(_COLUMNS) + "\n" + "\n".join(lines)
    path = folder / "grid.csv"
    path.write_text(text + "\n", encoding="utf-8")
    return [path]


def read_grid(folder: Path) -> SpatialGrid:
    """Read ``grid.csv``; rows may stand in any order.

    Raises
    ------
    InputError
        A column missing, a cell that is no number, a grid point missing or there twice.
    """
    path = folder / "grid.csv"
    lines = [line for line in read_text(path, what="grid").splitlines() if line[:1] != "#"]
    try:
        rows = np.array([[float(r[name]) for name in _COLUMNS] for r in csv.DictReader(lines)])
        axes, places = zip(*(np.unique(q, return_inverse=True) for q in rows[:, :3].T), strict=True)
    except (KeyError, TypeError, ValueError, IndexError):
        begins = lines[0] if lines else ""
        raise InputError(
            f"no grid: it begins with {begins!r}", file=path, line=1, accepted=", ".join(_COLUMNS)
        ) from None
    error = np.full((*map(len, axes), 3), np.nan)
    error[places] = mm_from_um(rows[:, 3:])
    if len(rows) != error[..., 0].size or not np.isfinite(error).all():
        raise InputError(
            f"{len(rows)} rows for {error[..., 0].size} grid points", file=path, line=1,
            accepted="every combination of X, Y and Z once",
        )  # fmt: skip
    return SpatialGrid(axes, error)


#: of a side: 25 cubed rows, where no control sets a limit
_MOST_ENTRIES = 25


def _write(
    folder: Path, task: TableTask, knots: tuple[Knots, Knots, Knots], options: Mapping[str, Any]
) -> list[Path]:
    grid = fit_grid(knots, task.grid_samples(knots))
    return write_grid(folder, grid, tool_length_mm=task.tool_length_mm)


FORMATS = (
    TableFormat(
        name="grid",
        rank=60,
        title="spatial grid in the terms of ISO/TR 16907 (our own form)",
        holds="any error that is a function of X, Y and Z, at one tool length",
        lacks="reversal, other tool lengths, tilt, what bends between grid points",
        most_entries=_MOST_ENTRIES,
        write=_write,
        read=lambda folder, options: read_grid(folder),
    ),
)
