"""Sweeps and shapes that several tests of the virtual part and of collisions use."""

from __future__ import annotations

import numpy as np

from stock import Sweeps


def polyline(path_mm, *, shift_mm=None, tilt_rad=None, tool=0, move=None) -> Sweeps:
    """Straight sweeps through the points of a path, displaced linearly between them."""
    path = np.asarray(path_mm, dtype=np.float64)
    count = len(path) - 1
    shift = _pairs(np.zeros_like(path) if shift_mm is None else np.asarray(shift_mm))
    tilt = _pairs(np.zeros_like(path) if tilt_rad is None else np.asarray(tilt_rad))
    return Sweeps(
        start_mm=path[:-1],
        end_mm=path[1:],
        centre_mm=np.zeros((count, 3)),
        axis=np.zeros((count, 3)),
        sweep_rad=np.zeros(count),
        tool=np.full(count, tool),
        move=np.arange(count) if move is None else move,
        shift_mm=shift,
        shift_slope_mm=np.repeat(np.diff(shift, axis=1), 2, axis=1),
        tilt_rad=tilt,
        tilt_slope_rad=np.repeat(np.diff(tilt, axis=1), 2, axis=1),
    )


def circle(radius_mm: float, z_mm: float, *, turns: float = 1.0, rise_mm: float = 0.0) -> Sweeps:
    """One arc about the Z axis that starts on +X, without displacement."""
    angle = 2 * np.pi * turns
    end = [radius_mm * np.cos(angle), radius_mm * np.sin(angle), z_mm + rise_mm]
    return Sweeps(
        start_mm=[[radius_mm, 0.0, z_mm]],
        end_mm=[end],
        centre_mm=[[0.0, 0.0, z_mm]],
        axis=[[0.0, 0.0, 1.0]],
        sweep_rad=[angle],
        tool=[0],
        move=[0],
        **{
            name: np.zeros((1, 2, 3))
            for name in ("shift_mm", "shift_slope_mm", "tilt_rad", "tilt_slope_rad")
        },
    )


def wavy_raster(columns: int, rows: int, *, step_mm: float = 0.5) -> np.ndarray:
    """Back and forth over a wavy surface below z = 0, (P, 3), one point a millimetre."""
    x = np.linspace(0, columns, columns + 1)
    passes = []
    for row in range(rows):
        along = x if row % 2 == 0 else x[::-1]
        y = np.full_like(along, row * step_mm)
        z = -1.0 + 0.5 * np.sin(along / 5) * np.cos(y / 4)
        passes.append(np.column_stack([along, y, z]))
    return np.concatenate(passes)


def edge_uses(triangles: np.ndarray) -> tuple[int, int]:
    """How many directed edges lack their opposite, and how many occur more than once."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    forward = {tuple(edge) for edge in edges.tolist()}
    lacking = sum((b, a) not in forward for a, b in forward)
    return lacking, len(edges) - len(forward)


def mesh_volume(vertices_mm: np.ndarray, triangles: np.ndarray) -> float:
    """Volume inside a closed mesh by the divergence theorem, mm3."""
    a, b, c = (vertices_mm[triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def _pairs(at_points: np.ndarray) -> np.ndarray:
    return np.stack([at_points[:-1], at_points[1:]], axis=1)
