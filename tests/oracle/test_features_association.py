"""Associated features against 60-digit references and against exhaustive search."""

from __future__ import annotations

from itertools import combinations

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import minimize

from vmach.errors import InputError
from vmach.features.association.associate import associate
from vmach.features.association.linear_program import least_width
from vmach.features.characteristics.form import _circle_zone
from vmach.features.datum_system import DatumSystem, datum_system
from vmach.features.derived import DerivedPoints
from vmach.features.feature import Points, make_feature
from vmach.features.surface import Surface
from vmach.features.zone import across_axis, derived_zone

LEAST_SQUARES_MM, ZONE_MM = 1e-9, 1e-6


@pytest.fixture(autouse=True)
def sixty_digits():
    with mp.workdps(60):
        yield


def noise(count, seed=3, size_mm=0.02):
    return np.random.default_rng(seed).uniform(-size_mm, size_mm, count)


# --- distances as anybody would write them, with 60 digits --------------------------------------


def to_axis(p, x0, y0, a, b):
    """Distance from the axis through (x0, y0, 0) along (a, b, 1), and the height along it."""
    d = [p[0] - x0, p[1] - y0, p[2]]
    n = mp.sqrt(a * a + b * b + 1)
    height = (d[0] * a + d[1] * b + d[2]) / n
    square = sum(c * c for c in d) - height * height
    return mp.sqrt(square), height


REFERENCES = {
    "plane": (lambda p, q: (p[2] - q[0] - q[1] * p[0] - q[2] * p[1])
              / mp.sqrt(1 + q[1] ** 2 + q[2] ** 2), [0, 0, 0]),
    "sphere": (lambda p, q: mp.sqrt(sum((p[k] - q[k]) ** 2 for k in range(3))) - q[3],
               [0, 0, 0, 10]),
    "cylinder": (lambda p, q: to_axis(p, *q[:4])[0] - q[4], [0, 0, 0, 0, 10]),
    "cone": (lambda p, q: (lambda r, h: (r - q[4]) * mp.cos(q[5]) - h * mp.sin(q[5]))(
        *to_axis(p, *q[:4])), [0, 0, 0, 0, 10, mp.mpf(1) / 2]),
    "torus": (lambda p, q: mp.sqrt((to_axis([p[0], p[1], p[2] - q[4]], *q[:4])[0] - q[5]) ** 2
                                   + to_axis([p[0], p[1], p[2] - q[4]], *q[:4])[1] ** 2) - q[6],
              [0, 0, 0, 0, 0, 30, 5]),
}  # fmt: skip


def solve_least_squares(distance, start, points):
    """Newton's method with derivatives by differences of 1e-25, in 60 digits."""
    q = mp.matrix(start)
    points = [[mp.mpf(float(c)) for c in p] for p in points]
    h = mp.mpf(10) ** -25
    for _ in range(60):
        r = mp.matrix([distance(p, list(q)) for p in points])
        jacobian = mp.matrix(len(points), len(q))
        for k in range(len(q)):
            moved = q.copy()
            moved[k] += h
            for i, p in enumerate(points):
                jacobian[i, k] = (distance(p, list(moved)) - r[i]) / h
        step = mp.lu_solve(jacobian.T * jacobian, -(jacobian.T * r))
        q += step
        if max(abs(s) for s in step) < mp.mpf(10) ** -22:
            break
    return list(q), [distance(p, list(q)) for p in points]


def cloud(kind, count=14):
    """Points near a nominal surface about Z at the origin."""
    rng = np.random.default_rng(11)
    u, e = rng.uniform(0, 2 * np.pi, count), noise(count)
    v = rng.uniform(-1, 1, count)
    cos, sin = np.cos(u), np.sin(u)
    if kind == "plane":
        return np.column_stack([40 * v, 30 * np.sin(7 * u), e]), Surface(
            "plane", [0] * 3, [0, 0, 1]
        )
    if kind == "sphere":
        r, z = (10 + e) * np.sqrt(1 - v**2), (10 + e) * v
        return np.column_stack([r * cos, r * sin, z]), Surface("sphere", [0] * 3, [0, 0, 1], 10.0)
    if kind == "cylinder":
        r = 10 + e
        surface = Surface("cylinder", [0] * 3, [0, 0, 1], 10.0)
        return np.column_stack([r * cos, r * sin, 15 * v]), surface
    if kind == "cone":
        r, z = 10 + 8 * v * np.tan(0.5) + e, 8 * v
        surface = Surface("cone", [0] * 3, [0, 0, 1], 10.0, half_angle_rad=0.5)
        return np.column_stack([r * cos, r * sin, z]), surface
    w = 2 * np.pi * rng.uniform(0, 1, count)
    r, z = 30 + (5 + e) * np.cos(w), (5 + e) * np.sin(w)
    surface = Surface("torus", [0] * 3, [0, 0, 1], 30.0, tube_mm=5.0)
    return np.column_stack([r * cos, r * sin, z]), surface


@pytest.mark.parametrize("kind", list(REFERENCES))
def test_least_squares_agrees_with_sixty_digits(kind):
    points, surface = cloud(kind)
    found = associate(surface, points)
    distance, start = REFERENCES[kind]
    unknowns, residual = solve_least_squares(distance, start, points)
    if kind == "torus":
        residual = [r for r in residual]
    assert np.abs(found.residual_mm - np.array(residual, float)).max() < LEAST_SQUARES_MM
    radius = {"sphere": 3, "cylinder": 4, "torus": 5}.get(kind)
    if radius is not None:
        assert abs(found.surface.radius_mm - float(unknowns[radius])) < LEAST_SQUARES_MM


@pytest.mark.parametrize("kind", list(REFERENCES))
def test_least_squares_is_the_same_wherever_the_part_lies(kind):
    points, surface = cloud(kind)
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    away = np.array([-412.0, 233.0, 90.0])
    placed = Surface(surface.kind, turn @ surface.point_mm + away, turn @ surface.axis,
                     surface.radius_mm, surface.half_angle_rad, surface.tube_mm)  # fmt: skip
    here, there = associate(surface, points), associate(placed, points @ turn.T + away)
    assert np.abs(here.residual_mm - there.residual_mm).max() < LEAST_SQUARES_MM


# --- minimum zones: every set of points that may decide ------------------------------------------


def test_flatness_is_that_of_the_best_of_all_planes():
    points = np.column_stack([np.random.default_rng(2).uniform(0, 50, (16, 2)), noise(16)])
    best = np.inf
    for i, j, k in combinations(range(16), 3):  # three points on one side, one on the other
        best = min(
            best, width_along(points, np.cross(points[j] - points[i], points[k] - points[i]))
        )
    for (i, j), (k, m) in combinations(list(combinations(range(16), 2)), 2):  # two and two
        best = min(
            best, width_along(points, np.cross(points[j] - points[i], points[m] - points[k]))
        )
    found = associate(Surface("plane", [0] * 3, [0, 0, 1]), points, criterion="minimum zone")
    assert found.value_mm == pytest.approx(best, abs=ZONE_MM)


def width_along(points, normal):
    size = np.linalg.norm(normal)
    return np.ptp(points @ normal) / size if size > 1e-9 else np.inf


def test_straightness_is_that_of_the_best_of_all_lines():
    x, y = np.linspace(0, 40, 30), noise(30)
    slopes = [(y[j] - y[i]) / (x[j] - x[i]) for i, j in combinations(range(30), 2)]
    best = min(np.ptp(y - s * x) for s in slopes)
    assert least_width(y, x[:, None])[1] == pytest.approx(best, abs=1e-12)


def ring(count=13, seed=8):
    angle = np.arange(count) * 2 * np.pi / count
    radius = 10 + noise(count, seed)
    flat = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    return np.column_stack([flat, np.zeros(count)])


def centres_of(flat):
    """Where the bisectors of two pairs of points meet, near the middle."""
    lines = [((p + q) / 2, q - p) for p, q in combinations(flat, 2)]
    for (m, n), (other, k) in combinations(lines, 2):
        table = np.array([n, k])
        if abs(np.linalg.det(table)) > 1e-6:
            centre = np.linalg.solve(table, [n @ m, k @ other])
            if np.hypot(*centre) < 1.0:
                yield centre


def test_roundness_is_that_of_the_best_of_all_centres():
    points = ring()
    radii = (np.hypot(*(points[:, :2] - c).T) for c in centres_of(points[:, :2]))
    best = min(np.ptp(r) for r in radii)
    surface = Surface("cylinder", [0] * 3, [0, 0, 1], 10.0, sign=-1.0)
    found = _circle_zone(surface, points, np.arange(len(points)))
    assert found.value_mm == pytest.approx(best, abs=ZONE_MM)


@pytest.mark.parametrize("criterion", ["inscribed", "circumscribed"])
def test_contacting_circles_are_the_best_of_all_centres(criterion):
    flat = ring()[:, :2]
    centres = [*centres_of(flat), *((p + q) / 2 for p, q in combinations(flat, 2))]
    radii = [np.hypot(*(flat - c).T) for c in centres]
    best = max(r.min() for r in radii) if criterion == "inscribed" else min(r.max() for r in radii)
    tall = np.vstack([np.column_stack([flat, np.full(len(flat), z)]) for z in (-5.0, 5.0)])
    surface = Surface("cylinder", [0] * 3, [0, 0, 1], 10.0)
    found = associate(surface, tall, criterion=criterion)
    assert found.value_mm == pytest.approx(best, abs=ZONE_MM)


@pytest.mark.parametrize("criterion", ["inscribed", "circumscribed"])
def test_contacting_circles_of_a_rough_ring_need_more_than_one_step(criterion):
    """Radii curve upwards with the centre, so that a step does better than it had promised."""
    turn = np.linspace(0, 2 * np.pi, 13)[:-1]
    size = 10 + noise(12, 5, 0.4)
    flat = size[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    centres = [*centres_of(flat), *((p + q) / 2 for p, q in combinations(flat, 2))]
    radii = [np.hypot(*(flat - c).T) for c in centres]
    best = max(r.min() for r in radii) if criterion == "inscribed" else min(r.max() for r in radii)
    tall = np.vstack([np.column_stack([flat, np.full(12, z)]) for z in (-5.0, 5.0)])
    found = associate(Surface("cylinder", [0] * 3, [0, 0, 1], 10.0), tall, criterion=criterion)
    assert found.value_mm == pytest.approx(best, abs=ZONE_MM)


@pytest.mark.parametrize("criterion", ["inscribed", "circumscribed"])
@pytest.mark.parametrize("seed", [6, 27])
def test_contacting_cylinders_of_a_short_boss(seed, criterion):
    """A boss of 86 mm, lost motion in both axes, measured all round over 4 mm: it may lean.

    Linear steps were still gaining 1e-11 mm each when they ended, and the points were refused as
    if they did not go all round.
    """
    side = 1.0 if criterion == "circumscribed" else -1.0
    turn, z = (v.ravel() for v in np.meshgrid(np.radians(np.arange(0, 360, 6)), [-2.0, 0.0, 2.0]))
    size = (
        43
        + 4e-3 * np.sign(np.sin(2 * turn))
        + np.random.default_rng(seed).normal(0, 5e-4, len(turn))
    )
    points = np.column_stack([size * np.cos(turn), size * np.sin(turn), z])

    def radii(q):  # of an axis that passes z = 0 at q[:2], um, and leans by q[2:], um at 10 mm
        axis = np.array([*(1e-4 * q[2:]), 1.0])
        return np.linalg.norm(np.cross(points - [*(1e-3 * q[:2]), 0.0], axis), axis=1) / (
            np.linalg.norm(axis)
        )

    best = min(
        minimize(
            lambda q: side * q[4], [*start, side * 20.0], method="SLSQP", bounds=[(-99, 99)] * 5,
            options={"ftol": 1e-13}, constraints={"type": "ineq",
                         "fun": lambda q: side * (q[4] - 1e3 * (radii(q[:4]) - 43.0))},
        ).fun
        for start in np.random.default_rng(1).normal(0, 0.3, (4, 4))
    )  # fmt: skip
    found = associate(Surface("cylinder", [0] * 3, [0, 0, 1], 43.0), points, criterion=criterion)
    assert found.value_mm == pytest.approx(43.0 + 1e-3 * side * best, abs=ZONE_MM)


@pytest.mark.parametrize("criterion", ["inscribed", "circumscribed"])
@pytest.mark.parametrize("span_deg", [60, 157.5])
@pytest.mark.parametrize("kind", ["cylinder", "sphere"])
def test_contacting_surfaces_want_points_all_round(kind, span_deg, criterion):
    """Half a bore has no largest cylinder; it was told with 0.1 mm too much."""
    turn = np.radians(np.linspace(0, span_deg, 9))
    ring = 8 * np.column_stack([np.cos(turn), np.sin(turn)])
    points = np.vstack([np.column_stack([ring, np.full(9, z)]) for z in (-5.0, 0.0, 5.0)])
    points[:, :2] *= 1 + noise(27, 3, 1e-4)[:, None] + 1e-4
    if kind == "sphere":
        points *= (8 / np.linalg.norm(points, axis=1))[:, None]
    surface = Surface(kind, [0] * 3, [0, 0, 1], 8.0, sign=-1.0)
    with pytest.raises(InputError, match=rf"{criterion} {kind} of points that do not go all round"):
        associate(surface, points, criterion=criterion)


def test_cylindricity_is_that_of_the_best_of_all_sets_of_points():
    """Six points decide; the equations are linear in the axis to 1e-8 mm for such deviations."""
    rng = np.random.default_rng(4)
    u, z, e = rng.uniform(0, 2 * np.pi, 10), rng.uniform(-9, 9, 10), noise(10, 9, 2e-4)
    points = np.column_stack([(10 + e) * np.cos(u), (10 + e) * np.sin(u), z])
    rows = np.column_stack([np.cos(u), np.sin(u), z * np.cos(u), z * np.sin(u), np.ones(10)])
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 6)).reshape(6, -1).T
    best = np.inf
    for chosen in map(list, combinations(range(10), 6)):
        table = np.empty((len(signs), 6, 6))
        table[:, :, :5], table[:, :, 5] = rows[chosen], signs
        usable = np.abs(np.linalg.det(table)) > 1e-9
        right = np.broadcast_to(e[chosen][:, None], (int(usable.sum()), 6, 1))
        found = np.linalg.solve(table[usable], right)[..., 0]
        worst = np.abs(e - found[:, :5] @ rows.T).max(axis=1)
        best = min(best, worst.min())
    surface = Surface("cylinder", [0] * 3, [0, 0, 1], 10.0)
    found = associate(surface, points, criterion="minimum zone")
    assert found.value_mm == pytest.approx(2 * best, abs=ZONE_MM)


def test_a_tangent_plane_stays_outside_and_touches():
    rng = np.random.default_rng(6)
    points = np.column_stack([rng.uniform(-20, 20, (200, 2)), noise(200)])
    found = associate(Surface("plane", [0] * 3, [0, 0, 1]), points, criterion="tangent")
    assert found.residual_mm.max() < 1e-9
    assert np.sum(found.residual_mm > -1e-9) >= 2
    # the farthest point is as far as the zone is wide: both planes are parallel
    zone = associate(Surface("plane", [0] * 3, [0, 0, 1]), points, criterion="minimum zone")
    assert -found.residual_mm.min() == pytest.approx(zone.value_mm, abs=ZONE_MM)


@pytest.mark.parametrize("criterion", ["minimum zone", "inscribed", "circumscribed"])
def test_values_follow_the_points_as_the_weights_say(criterion):
    points, surface = cloud("cylinder", 60)
    found = associate(surface, points, criterion=criterion)
    moved = noise(60, 21, 1e-6)
    away = surface.rows(points)[1]
    again = associate(surface, points + moved[:, None] * away, criterion=criterion)
    assert again.value_mm - found.value_mm == pytest.approx(found.weight @ moved, abs=2e-10)


def test_too_few_points_are_refused():
    points, surface = cloud("cylinder", 3)
    with pytest.raises(InputError, match=r"3 points for a cylinder; accepted: at least 5"):
        associate(surface, points)


def test_an_unknown_criterion_is_refused():
    points, surface = cloud("plane")
    with pytest.raises(InputError, match="accepted: least squares, minimum zone"):
        associate(surface, points, criterion="best")
    with pytest.raises(InputError, match="inscribed association of a plane"):
        associate(surface, points, criterion="inscribed")


# --- zones about derived points, and datum systems ----------------------------------------------


def enclosing_circle(flat):
    """Radius of the smallest circle about points: two or three of them decide."""
    best = np.inf
    centres = [(p + q) / 2 for p, q in combinations(flat, 2)]
    for p, q, r in combinations(flat, 3):
        table = np.array([q - p, r - p])
        if abs(np.linalg.det(table)) > 1e-14:
            half = 0.5 * np.array([(q - p) @ (q - p), (r - p) @ (r - p)])
            centres.append(p + np.linalg.solve(table, half))
    for centre in centres:
        best = min(best, np.hypot(*(flat - centre).T).max())
    return best


def test_a_zone_about_centres_is_the_smallest_circle():
    """Perpendicularity of bores to a plane: their centres in one circle, wherever it lies."""
    flat = noise(22, 31).reshape(11, 2)
    points = np.column_stack([flat, np.linspace(-20, 0, 11)])
    derived = DerivedPoints(points, tuple(np.array([k]) for k in range(11)),
                            tuple(np.zeros((3, 1)) for _ in range(11)))  # fmt: skip
    across = np.broadcast_to(across_axis(np.array([0.0, 0.0, 1.0])), (11, 3, 3))
    shifts = np.vstack([np.eye(3), np.zeros((3, 3))])
    found = derived_zone(derived, np.zeros((11, 3)) + points * [0, 0, 1], across, DatumSystem(),
                         shifts)  # fmt: skip
    assert found.value_mm == pytest.approx(2 * enclosing_circle(flat), abs=ZONE_MM)


def test_a_straight_axis_needs_the_best_of_all_lines():
    """Six centres and any line through space: a smooth convex program, in units of 0.01 mm."""
    flat = noise(12, 33).reshape(6, 2)
    z = np.linspace(-20.0, 0.0, 6)

    def room(q):
        apart = 100.0 * flat - q[:2] - np.outer(z / 10.0, q[2:4])
        return q[4] ** 2 - (apart**2).sum(axis=1)

    found = minimize(
        lambda q: q[4], [0, 0, 0, 0, 5.0], constraints={"type": "ineq", "fun": room},
        method="SLSQP", options={"ftol": 1e-14, "maxiter": 500},
    )  # fmt: skip
    best = found.x[4] / 100.0
    points = np.column_stack([flat, z])
    derived = DerivedPoints(points, tuple(np.array([k]) for k in range(6)),
                            tuple(np.zeros((3, 1)) for _ in range(6)))  # fmt: skip
    across = np.broadcast_to(across_axis(np.array([0.0, 0.0, 1.0])), (6, 3, 3))
    found = derived_zone(derived, points * [0, 0, 1], across, DatumSystem(), np.eye(6))
    assert found.value_mm == pytest.approx(2 * best, abs=ZONE_MM)


def test_a_datum_system_agrees_with_sixty_digits():
    """Plane A, plane B squared to it, plane C squared to both: where the corner of them lies."""
    rng = np.random.default_rng(17)
    places = {name: rng.uniform(-30, 30, (12, 2)) for name in "ABC"}
    heights = {name: noise(12, seed) for name, seed in zip("ABC", (41, 42, 43), strict=True)}
    columns = {"A": (0, 1, 2), "B": (1, 2, 0), "C": (0, 2, 1)}
    normals = {"A": [0, 0, 1], "B": [-1, 0, 0], "C": [0, -1, 0]}
    nominal, normal, deviation, features = [], [], [], {}
    for name in "ABC":
        u, v, w = columns[name]
        points = np.zeros((12, 3))
        points[:, u], points[:, v] = places[name].T
        side = float(np.sum(normals[name]))
        nominal.append(points)
        normal.append(np.tile(normals[name], (12, 1)))
        deviation.append(side * heights[name])  # the place moves by the height along +w
        rows = np.arange(12) + 12 * "ABC".index(name)
        features[name] = make_feature(name, [Surface("plane", [0] * 3, normals[name])], [rows])
        assert points[0, w] == 0.0
    points = Points(np.vstack(nominal), np.vstack(normal).astype(float), np.concatenate(deviation),
                    np.ones(36, bool))  # fmt: skip
    system = datum_system(["A", "B", "C"], features, points)
    corner, axes = corner_by_sixty_digits(points.actual_mm.reshape(3, 12, 3))
    assert np.abs(system.pose.apply(np.zeros((1, 3)))[0] - corner).max() < LEAST_SQUARES_MM
    assert np.abs(30.0 * (system.pose.turn - axes)).max() < LEAST_SQUARES_MM


def corner_by_sixty_digits(parts):
    """Corner and directions (columns) of three planes, each by orthogonal least squares."""
    a, b, c = ([mp.matrix([mp.mpf(float(x)) for x in p]) for p in part] for part in parts)
    z = least_normal(a, [mp.matrix([1, 0, 0]), mp.matrix([0, 1, 0]), mp.matrix([0, 0, 1])], 2)
    y0 = mp.matrix([0, 1, 0]) - z * z[1]
    y0 = y0 / mp.norm(y0)
    x = least_normal(b, [y0, cross(y0, z)], 1)
    y = cross(z, x)
    origin = z * mean_along(a, z) + x * mean_along(b, x) + y * mean_along(c, y)
    axes = [[float(v[k]) for v in (x, y, z)] for k in range(3)]
    return np.array([float(o) for o in origin]), np.array(axes)


def cross(p, q):
    return mp.matrix([p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
                      p[0] * q[1] - p[1] * q[0]])  # fmt: skip


def mean_along(points, way):
    return sum((p.T * way)[0] for p in points) / len(points)


def least_normal(points, frame, near):
    """The direction in a frame along which points scatter least, turned towards one of it."""
    middle = sum(points[1:], points[0]) / len(points)
    seen = [[((p - middle).T * f)[0] for f in frame] for p in points]
    size = len(frame)
    scatter = mp.matrix(size, size)
    for row in seen:
        for i in range(size):
            for j in range(size):
                scatter[i, j] += row[i] * row[j]
    values, vectors = mp.eigsy(scatter)
    least = min(range(size), key=lambda k: values[k])
    found = sum((frame[k] * vectors[k, least] for k in range(size)), mp.matrix([0, 0, 0]))
    return found if vectors[near, least] > 0 else -found
