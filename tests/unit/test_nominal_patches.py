"""Squares at points, for surfaces without a mesh."""

import numpy as np
import pytest

from vmach.nominal import patches as module
from vmach.nominal.patches import patches


def grid(side):
    x, y = np.meshgrid(np.arange(side) * 2.0, np.arange(side) * 2.0)
    points = np.column_stack([x.ravel(), y.ravel(), np.full(side**2, 5.0)])
    return points, np.tile([0.0, 0.0, 1.0], (side**2, 1))


def test_squares_on_a_grid_cover_it():
    points, normal = grid(6)
    mesh = patches(points, normal)
    a, b, c = np.moveaxis(mesh.corners_mm, 1, 0)
    area = 0.5 * np.cross(b - a, c - a)
    np.testing.assert_allclose(area[:, :2], 0.0, atol=1e-12)
    assert area[:, 2].sum() == pytest.approx(36 * 4.0)  # all of them face the way of the normals
    assert np.bincount(mesh.face).tolist() == [2] * 36


def test_many_points_get_fewer_squares(monkeypatch):
    monkeypatch.setattr(module, "_MOST", 10)
    points, normal = grid(6)
    assert len(patches(points, normal).triangles) <= 20


def test_one_point_and_none():
    assert len(patches(np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0]])).triangles) == 2
    assert len(patches(np.zeros((0, 3)), np.zeros((0, 3))).triangles) == 0
