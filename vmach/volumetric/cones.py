"""Cones along error vectors, as a mesh.

Source: Huddersfield paper, figure 5 (a cone for every vector, direction and magnitude).
"""

from __future__ import annotations

import numpy as np

from vmach.volumetric.field import ErrorField, Volume

__all__ = ["SIDES", "cone_mesh", "cone_step_mm", "cone_volume"]

#: points along X, Y, Z that a picture of cones can hold
_CONE_GRID = (12, 8, 6)
SIDES = 8
#: of the grid's step, for the longest error; radius of a cone over its length
_LENGTH, _RADIUS = 0.9, 0.25


def cone_step_mm(volume: Volume) -> float:
    """Largest distance of neighbouring points of a grid."""
    return max(
        float((high - low) / max(count - 1, 1))
        for low, high, count in zip(volume.low_mm, volume.high_mm, volume.counts, strict=True)
    )


def cone_volume(volume: Volume) -> Volume:
    """The same volume with few points."""
    return Volume(volume.low_mm, volume.high_mm, _CONE_GRID)


def cone_mesh(field: ErrorField) -> tuple[np.ndarray, np.ndarray]:
    """A closed cone at every grid point, along the error vector, as long as the error is large.

    Returns
    -------
    vertices_mm : (P * (SIDES + 2), 3) float64
        Of every cone: its tip, the middle of its base, the rim.
    triangles : (P * 2 * SIDES, 3) int64
    """
    base = field.nose_mm(np.arange(len(field.error_mm)))
    longest = max(float(field.magnitude_mm.max()), 1e-12)
    vector = field.error_mm * (_LENGTH * cone_step_mm(field.volume) / longest)
    length = np.linalg.norm(vector, axis=1, keepdims=True)
    along = np.divide(vector, length, out=np.zeros_like(vector), where=length > 0)
    helper = np.where(np.abs(along[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]])
    across = np.cross(along, helper)
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
    other = np.cross(along, across)
    turn = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)[:, None, None]
    rim = base + _RADIUS * length * (np.cos(turn) * across + np.sin(turn) * other)
    vertices = np.concatenate([[base + vector], [base], rim]).transpose(1, 0, 2)
    k = np.arange(SIDES)
    after = (k + 1) % SIDES
    sides = np.column_stack([k + 2, after + 2, np.zeros(SIDES, int)])
    bottom = np.column_stack([after + 2, k + 2, np.ones(SIDES, int)])
    one = np.vstack([sides, bottom])
    first = np.arange(len(base))[:, None, None] * (SIDES + 2)
    return vertices.reshape(-1, 3), (first + one).reshape(-1, 3)
