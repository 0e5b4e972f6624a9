"""Compiled geometry of faces against SciPy's, and against sums and angles by hand."""

import numpy as np
import pytest
from scipy.interpolate import BSpline, NdBSpline, make_interp_spline
from scipy.spatial import Delaunay, cKDTree

from vmach.nominal.frame import Frame
from vmach.nominal.mesh.thinning import near_segments
from vmach.nominal.surfaces import Cone, Cylinder, Extrusion, Plane, Revolution, Sphere, Torus
from vmach.nominal.surfaces.bspline_surface import BSplineSurface
from vmach.nominal.surfaces.crossings import INSIDE, sides_of_points
from vmach.nominal.surfaces.crowding import crowded_segments
from vmach.nominal.surfaces.curved_triangles import area_mm2, volume_under_mm3
from vmach.nominal.surfaces.curves import BSplineCurve, Ellipse
from vmach.nominal.surfaces.delaunay import delaunay
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


def test_nearest_parameters_about_a_pole():
    """Half a dome of radius 10: a quarter circle (u) that is turned by half a turn (v), exactly."""
    h = np.sqrt(0.5)
    profile, turn = [(1, 0), (1, 1), (0, 1)], [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)]
    control = 10.0 * np.array([[(r * x, r * y, z) for x, y in turn] for r, z in profile])
    weights = np.outer([1, h, 1], [1, h, 1, h, 1])
    ends = (np.array([0.0, 0, 0, 1, 1, 1]), np.array([0, 0, 0, 0.5, 0.5, 1, 1, 1]))
    surface = BSplineSurface(control, weights, ends, (2, 2))
    away, around = np.meshgrid(np.geomspace(1e-6, 1.5, 100), np.linspace(0.0, np.pi, 7))
    points = 10.0 * np.stack([
        np.sin(away) * np.cos(around), np.sin(away) * np.sin(around), np.cos(away),
    ], axis=-1).reshape(-1, 3)  # fmt: skip
    assert surface.evaluate(surface.parameters(points)) == pytest.approx(points, abs=1e-12)


def test_nearest_parameters_on_a_thread_of_high_degree():
    """Nine turns of an M6 thread, pitch 1 mm: a span of degree 13 holds more than one turn."""
    turns = 2.0 * np.pi * 9.0 * 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 21)))
    rows = [make_interp_spline(turns, np.stack([
        r * np.cos(turns), r * np.sin(turns), z + turns / (2.0 * np.pi)
    ], axis=1), 13) for r, z in ((3.0, 0.0), (2.4, 0.4))]  # fmt: skip
    control = np.stack([row.c for row in rows], axis=1)
    ends = (rows[0].t, np.array([0.0, 0.0, 1.0, 1.0]))
    surface = BSplineSurface(control, np.ones(control.shape[:2]), ends, (13, 1))
    uv = np.random.default_rng(6).uniform((0.0, 0.0), (turns[-1], 1.0), (500, 2))
    assert surface.parameters(surface.evaluate(uv)) == pytest.approx(uv, abs=1e-9)


@pytest.mark.parametrize(("degree", "clamped"), [(1, False), (3, True), (5, False)])
def test_curve_and_its_inverse(degree, clamped):
    rng = np.random.default_rng(5)
    count = degree + 5
    t, weights = knots(rng, degree, count, clamped), rng.uniform(0.5, 2.0, count)
    control = np.column_stack([3.0 * np.arange(count), rng.normal(size=(count, 2))])
    curve = BSplineCurve(control, weights, t, degree)
    other = BSpline(t, np.column_stack([control * weights[:, None], weights]), degree)
    low, high = t[degree], t[-degree - 1]
    places = np.r_[rng.uniform(low, high, 200), low, high]
    value, change = other(places), other.derivative()(places)
    points = value[:, :3] / value[:, 3:]
    assert curve.evaluate(places) == pytest.approx(points, abs=1e-13)
    truth = (change[:, :3] - change[:, 3:] * points) / value[:, 3:]
    assert curve.derivative(places) == pytest.approx(truth, abs=1e-12)
    assert curve.evaluate(curve.parameter(points)) == pytest.approx(points, abs=1e-12)


def test_a_curve_with_a_jump_is_refused():
    points, t = np.random.default_rng(6).random((5, 3)), np.array([0.0, 0, 0, 1, 1, 2, 2, 2])
    BSplineCurve(points, np.ones(5), t, 2)
    with pytest.raises(ValueError, match="jumps at 1"):
        BSplineCurve(np.vstack([points, points[:1]]), np.ones(6), np.insert(t, 4, 1.0), 2)


def test_parameters_on_a_closed_curve_go_round():
    angle = np.linspace(0.0, 2.0 * np.pi, 9)
    control = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(9)])
    t = np.r_[[0.0] * 3, 0:7, [6.0] * 3]
    curve = BSplineCurve(control, np.ones(9), t, 3)
    assert curve.period == 6.0
    places = np.array([0.0, 0.01, 3.3, 5.99])
    turns = (curve.parameter(curve.evaluate(places + 12.0)) - places) / 6.0
    assert turns == pytest.approx(np.rint(turns), abs=1e-9)


def rows_of(triangles):
    return sorted(map(tuple, np.sort(triangles, axis=1).tolist()))


@pytest.mark.parametrize("kind", ["anywhere", "grid", "two rows", "ring"])
@pytest.mark.parametrize("count", [3, 4, 30, 2500])
def test_triangles_are_those_of_qhull(kind, count):
    rng = np.random.default_rng(count)
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    points = {
        "anywhere": rng.random((count, 2)) * [10.0, 1.0],
        "grid": np.column_stack(np.divmod(np.arange(count), np.ceil(count**0.5))),
        "two rows": np.column_stack([np.arange(count) // 2, np.arange(count) % 2]) * [0.01, 1.0],
        "ring": np.column_stack([np.cos(angle), np.sin(angle)]),
    }[kind]
    points = points + 1e-7 * np.ptp(points) * rng.uniform(-1.0, 1.0, points.shape)
    triangles, beyond = delaunay(points)
    assert rows_of(triangles) == rows_of(Delaunay(points).simplices)
    one, other = (points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))
    assert (one[:, 0] * other[:, 1] > one[:, 1] * other[:, 0]).all()
    corner, following = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    inner = beyond.ravel() >= 0
    assert (corner[beyond.ravel()[inner]] == following[inner]).all()
    assert (following[beyond.ravel()[inner]] == corner[inner]).all()
    # Euler: what is not beyond another triangle is the outline
    assert np.count_nonzero(~inner) == 2 * count - 2 - len(triangles)


@pytest.mark.parametrize("count", [0, 1, 2, 7])
def test_points_on_one_line_have_no_triangles(count):
    points = np.column_stack([np.arange(count), np.zeros(count)]) * 1.0
    assert [len(found) for found in delaunay(points)] == [0, 0]


@pytest.mark.parametrize("periods", [(0.0, 0.0), (6.0, 0.0), (0.0, 5.0), (6.0, 5.0)])
def test_crowded_segments_hold_a_point_in_their_circle(periods):
    rng = np.random.default_rng(8)
    start = rng.uniform(0.0, 5.0, (200, 2))
    segments = np.stack([start, start + rng.normal(scale=0.15, size=start.shape)], axis=1)
    inner, scale = rng.uniform(0.0, 5.0, (300, 2)), np.array([2.0, 3.0])
    found = crowded_segments(segments, inner, scale, np.array(periods))
    box = np.array(periods) * scale
    wrap = np.where(box > 0.0, box, 1e9)
    points = np.mod(np.vstack([start, inner]) * scale + 0.0, wrap)
    middle, half = segments.mean(axis=1) * scale, np.diff(segments, axis=1)[:, 0] * scale / 2.0
    apart = middle[:, None] - points
    apart -= np.rint(apart / wrap) * wrap
    nearest = np.linalg.norm(apart, axis=2).min(axis=1)
    truth = nearest < np.linalg.norm(half, axis=1) * (1.0 - 1e-6)
    assert 20 < np.count_nonzero(truth) < 180
    assert (found == truth).all()


def test_points_near_segments():
    rng = np.random.default_rng(9)
    points, segments = rng.random((3000, 3)), rng.random((40, 2, 3))
    share = np.linspace(0.0, 1.0, 2001)[:, None]
    along = segments[:, :1] + share * (segments[:, 1:] - segments[:, :1])
    truth = cKDTree(along.reshape(-1, 3)).query(points)[0]
    near = near_segments(points, segments, 0.05)
    sure = np.abs(truth - 0.05) > 1e-4
    assert (near == (truth < 0.05))[sure].all()
    assert 0.05 < near.mean() < 0.95


def test_volume_and_area_of_a_prism_of_curved_sides():
    """A quarter of a paraboloid z = 1 - x^2 - y^2: quadratic triangles meet it exactly."""
    n = 6
    grid = np.stack(np.meshgrid(*2 * [np.linspace(0.0, 1.0, n + 1)], indexing="ij"), axis=-1)
    a, b, c, d = (
        grid[s].reshape(-1, 2)
        for s in ((slice(n), slice(n)), (slice(1, None), slice(n)),
                  (slice(1, None), slice(1, None)), (slice(n), slice(1, None)))
    )  # fmt: skip
    corners = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    middles = (corners + np.roll(corners, -1, axis=1)) / 2.0

    def lifted(xy):
        return np.concatenate([xy, 1.0 - (xy**2).sum(axis=-1, keepdims=True)], axis=-1)

    # a third of the integral of x . n dA = (z - x dz/dx - y dz/dy) dx dy = 1 + x^2 + y^2
    assert volume_under_mm3(lifted(corners), lifted(middles)) == pytest.approx(5.0 / 9.0, rel=1e-13)
    flat = np.concatenate([corners, np.zeros((*corners.shape[:2], 1))], axis=-1).reshape(-1, 3)
    assert area_mm2(flat, np.arange(len(flat)).reshape(-1, 3)) == pytest.approx(1.0, rel=1e-14)


PLACED = Frame.from_axis(np.array([1.0, 2.0, 3.0]), np.array([0.3, -0.2, 0.9]), None)
ARC = Ellipse(Frame.from_axis(np.array([7.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), None), 2.0, 1.0)


@pytest.mark.parametrize(
    "surface",
    [
        Plane(PLACED), Cylinder(PLACED, 3.0), Cone(PLACED, 3.0, 0.4), Sphere(PLACED, 3.0),
        Torus(PLACED, 5.0, 1.0), Revolution(ARC, Frame(np.zeros(3), np.eye(3))),
        Extrusion(ARC, np.array([0.6, 0.8, 0.0])),
    ],
    ids=lambda surface: surface.kind,
)  # fmt: skip
def test_slopes_vary_with_what_the_surface_says(surface):
    grid = np.stack(np.meshgrid(*2 * [np.linspace(0.1, 1.2, 9)], indexing="ij"), axis=-1)
    for slope, varies in zip(surface.derivatives(grid.reshape(-1, 2)), surface.varies, strict=True):
        length = np.linalg.norm(slope, axis=1).reshape(9, 9)
        for axis, name in enumerate("uv"):
            assert (np.ptp(length, axis=axis).max() > 1e-3) == (name in varies), name


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
