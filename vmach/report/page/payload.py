"""The mesh and the points as one compressed block for the page.

Layout before compression (gzip): the length of a JSON header (uint32, little-endian), the header
(UTF-8), then the columns that it lists. A column holds the differences between neighbours (modulo
the width of the type), all low bytes first, then all next bytes. Neighbours are
alike, so the high bytes are nearly all equal and cost nothing. `scene.js` has the reader.
"""

from __future__ import annotations

import base64
import gzip
import json

import numpy as np

from vmach.base.units import um_from_mm
from vmach.report.result import STATUSES, DisplayMesh, InspectedPoints, RunRecord

__all__ = ["MAX_POINTS", "encode_mesh", "encode_payload", "pack_mesh"]

#: points that the page can name when one clicks on the part; deviations.csv has them all
MAX_POINTS = 30_000
_MAX_NC_CHARACTERS = 80
_GRID = 65_535  # steps of the 16-bit grid that positions are rounded to
_LARGEST = 32_000  # of a quantised value, the rest of the 16 bits being for _UNKNOWN
_UNKNOWN = -32_768


def encode_payload(mesh: DisplayMesh, points: InspectedPoints, run: RunRecord) -> str:
    """Return mesh, deviations and what is known of each point as base64 text."""
    names = [column.name for column in points.columns]
    chosen = _choose_points(points)
    origin, step = _position_grid(mesh, points)
    value_step_mm = _value_step(mesh, points)
    columns = _mesh_columns(mesh, names, (origin, step), value_step_mm)
    columns |= _point_columns(points, chosen, (origin, step), value_step_mm)
    features, columns["point_feature"] = np.unique(points.feature[chosen], return_inverse=True)
    lines = np.unique(points.line[chosen]).tolist()
    header = {
        "origin_mm": origin.tolist(),
        "step_mm": step.tolist(),
        "value_step_um": um_from_mm(value_step_mm),
        "unknown": _UNKNOWN,
        "statuses": STATUSES,
        "features": features.tolist(),
        "ids": points.id[chosen].tolist(),
        "nc": {n: run.nc_text(n)[:_MAX_NC_CHARACTERS] for n in lines if run.nc_text(n)},
    }
    return base64.b64encode(_pack(header, columns)).decode("ascii")


def pack_mesh(mesh: DisplayMesh) -> bytes:
    """The mesh alone in the same layout, packed in a hurry for a page of this machine."""
    return _pack_mesh(mesh, compresslevel=1)


def encode_mesh(mesh: DisplayMesh) -> str:
    """The mesh with its colourings and nothing to click on, as base64 text."""
    return base64.b64encode(_pack_mesh(mesh, compresslevel=6)).decode("ascii")


def _pack_mesh(mesh: DisplayMesh, *, compresslevel: int) -> bytes:
    low, high = mesh.vertices_mm.min(axis=0), mesh.vertices_mm.max(axis=0)
    step = np.maximum(high - low, 1e-9) / _GRID
    values = [np.abs(c.value_mm).max(initial=0.0) for c in mesh.colourings.values()]
    value_step_mm = max(values, default=0.0) / _LARGEST or 1e-12
    header = {
        "origin_mm": low.tolist(), "step_mm": step.tolist(), "unknown": _UNKNOWN,
        "value_step_um": um_from_mm(value_step_mm),
    }  # fmt: skip
    columns = _mesh_columns(mesh, list(mesh.colourings), (low, step), value_step_mm)
    return _pack(header, columns, compresslevel=compresslevel)


def _choose_points(points: InspectedPoints) -> np.ndarray:
    """Indices of at most `MAX_POINTS` points, evenly through the list."""
    count = min(len(points), MAX_POINTS)
    return np.linspace(0, len(points) - 1, count).round().astype(int)


def _position_grid(mesh: DisplayMesh, points: InspectedPoints) -> tuple[np.ndarray, np.ndarray]:
    """Origin and step of the 16-bit grid that positions are rounded to."""
    every = np.vstack([mesh.vertices_mm, points.point_mm])
    low, high = every.min(axis=0), every.max(axis=0)
    return low, np.maximum(high - low, 1e-9) / _GRID


def _value_step(mesh: DisplayMesh, points: InspectedPoints) -> float:
    values = [c.value_mm for c in mesh.colourings.values()]
    values += [v.deviation_mm[v.is_cut] for v in points.columns]
    return max(np.abs(v).max(initial=0.0) for v in values) / _LARGEST or 1e-12


def _quantised(value_mm: np.ndarray, known: np.ndarray, step_mm: float) -> np.ndarray:
    return np.where(known, np.round(np.where(known, value_mm, 0.0) / step_mm), _UNKNOWN)


def _mesh_columns(
    mesh: DisplayMesh, names: list[str], grid: tuple[np.ndarray, np.ndarray], value_step_mm: float
) -> dict[str, np.ndarray]:
    origin, step = grid
    position = np.round((mesh.vertices_mm - origin) / step)
    columns = {f"vertex_{axis}": position[:, i] for i, axis in enumerate("xyz")}
    for name in names:
        colouring = mesh.colourings[name]
        columns[f"vertex:{name}"] = _quantised(colouring.value_mm, colouring.known, value_step_mm)
    return columns | {f"corner_{i}": mesh.triangles[:, i].astype(np.uint32) for i in range(3)}


def _point_columns(
    points: InspectedPoints,
    chosen: np.ndarray,
    grid: tuple[np.ndarray, np.ndarray],
    value_step_mm: float,
) -> dict[str, np.ndarray]:
    origin, step = grid
    position = np.round((points.point_mm[chosen] - origin) / step)
    normal = np.round(points.normal[chosen] * 32_767)
    columns = {f"point_{axis}": position[:, i] for i, axis in enumerate("xyz")}
    columns |= {f"normal_{axis}": normal[:, i] for i, axis in enumerate("xyz")}
    columns["point_line"] = points.line[chosen].astype(np.uint32)
    columns["point_tool"] = points.tool[chosen].astype(np.uint32)
    for column in points.columns:
        deviation, cut = column.deviation_mm[chosen], column.is_cut[chosen]
        columns[f"point:{column.name}"] = _quantised(deviation, cut, value_step_mm)
        status = [STATUSES.index(name) for name in column.status[chosen].tolist()]
        columns[f"status:{column.name}"] = np.array(status)
    return columns


def _pack(header: dict, columns: dict[str, np.ndarray], *, compresslevel: int = 6) -> bytes:
    listing, blocks = [], []
    for name, column in columns.items():
        width = 4 if column.dtype == np.uint32 else 2
        listing.append([name, width, len(column)])
        blocks.append(_difference_planes(column, width))
    text = json.dumps(header | {"columns": listing}, ensure_ascii=False).encode()
    length = np.array([len(text)], "<u4").tobytes()
    return gzip.compress(length + text + b"".join(blocks), compresslevel, mtime=0)


def _difference_planes(column: np.ndarray, width: int) -> bytes:
    values = np.asarray(column).astype(np.int64)
    differences = np.diff(values, prepend=0) % (1 << (8 * width))
    octets = differences.astype(f"<u{width}").view(np.uint8).reshape(-1, width)
    return octets.T.tobytes()
