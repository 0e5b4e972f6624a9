"""Compiled B-splines against scipy's, trimming against the angle that edges turn about a point."""

import numpy as np
import pytest
from scipy.interpolate import NdBSpline

from vmach.nominal.frame import Frame
from vmach.nominal.surfaces import Cylinder, Plane
from vmach.nominal.surfaces.bspline_surface import BSplineSurface
from vmach.nominal.surfaces.crossings import INSIDE, sides_of_points
from vmach.nominal.surfaces.trimming import Trim


def knots(rng, degree, count, clamped):
    if not clamped:
        return np.cumsum(rng.uniform(0.3, 1.0, count + degree + 1))
    inner = np.sort(rng.integers(1, 5, count - degree - 1) / 2.0)  # some of them multiple
    return np.r_[[0.0] * (degree + 1), inner, [3.0] * (degree + 1)]


@pytest.mark.parametrize(("ku", "kv", "clamped"), [(3, 2, True), (1, 5, True), (2, 3, False)])
def test_surface_and_slopes(ku, kv, clamped):
    rng = np.random.default_rng(3)
    n, m = ku + 4, kv + 3
    u, v = knots(rng, ku, n, clamped), knots(rng, kv, m, clamped)
    control, weights = rng.normal(size=(n, m, 3)), rng.uniform(0.5, 2.0, (n, m))
    surface = BSplineSurface(control, weights, (u, v), (ku, kv))
    homogeneous = np.concatenate([control * weights[..., None], weights[..., None]], axis=2)
    other = NdBSpline((u, v), homogeneous, (ku, kv))
    low, high = (u[ku], v[kv]), (u[-ku - 1], v[-kv - 1])
    uv = np.vstack([rng.uniform(low, high, (100, 2)), low, high])
    value = other(uv)
    points = value[:, :3] / value[:, 3:]
    assert surface.evaluate(uv) == pytest.approx(points, abs=1e-13)
    for slope, nu in zip(surface.derivatives(uv), ((1, 0), (0, 1)), strict=True):
        change = other(uv, nu=nu)
        truth = (change[:, :3] - change[:, 3:] * points) / value[:, 3:]
        assert slope == pytest.approx(truth, abs=1e-12)


def test_nearest_parameters_of_points_on_a_surface():
    rng = np.random.default_rng(4)
    x, y = np.meshgrid(np.arange(6.0), np.arange(5.0), indexing="ij")
    control = np.stack([x, y, rng.uniform(0.0, 0.5, x.shape)], axis=-1)
    u, v = np.r_[0, 0, 0:4, 3, 3] * 1.0, np.r_[0, 0, 0:4, 3, 3] * 1.0
    surface = BSplineSurface(control, np.ones(x.shape), (np.r_[0, u, 3], v), (3, 2))
    uv = rng.uniform(0.0, 3.0, (200, 2))
    assert surface.parameters(surface.evaluate(uv)) == pytest.approx(uv, abs=1e-12)


def star(corners):
    angle = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)
    radius = 2.0 + np.sin(7.0 * angle) + 0.3 * np.cos(31.0 * angle)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


@pytest.mark.parametrize("corners", [7, 200, 3000])
def test_sides_are_those_of_a_polygon_with_a_hole(corners):
    outer, hole = star(corners), 0.3 * star(corners)[::-1]
    segments = np.vstack(
        [np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in (outer, hole)]
    )
    points = np.random.default_rng(5).uniform(-3.5, 3.5, (500, 2))
    sides = sides_of_points(segments, points, 0.0, 0.0)
    from_points = segments[None, :, :, :] - points[:, None, None, :]
    seen = np.arctan2(from_points[..., 1], from_points[..., 0])
    turn = np.angle(np.exp(1j * (seen[..., 1] - seen[..., 0]))).sum(axis=1)
    assert ((sides == INSIDE) == (turn > np.pi)).all()


def test_a_band_of_a_cylinder_is_inside_all_around():
    frame = Frame(np.zeros(3), np.eye(3))
    turn = np.linspace(0.0, 2.0 * np.pi, 50)
    ring = np.column_stack([5.0 * np.cos(turn), 5.0 * np.sin(turn), np.zeros(50)])
    trim = Trim.from_polylines(Cylinder(frame, 5.0), [ring, ring[::-1] + np.array([0.0, 0.0, 4.0])])
    u, v = np.linspace(-7.0, 7.0, 60), np.linspace(-1.0, 5.0, 60)
    assert (trim.contains(np.column_stack([u, v])) == ((v > 0.0) & (v < 4.0))).all()


def test_a_face_without_edges_holds_every_point():
    trim = Trim.from_polylines(Plane(Frame(np.zeros(3), np.eye(3))), [])
    assert trim.contains(np.zeros((3, 2))).all()
