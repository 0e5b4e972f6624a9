"""The engine against closed forms: edges of envelopes known to more digits than it claims."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from stock import EdgeStatus, find_edges, make_tool
from tests.oracle.stock_edge_cases import circle, joined, polyline, sweeps_of

UM = 1e-3
PERFECT = 1e-6 * UM
CLOSE = 0.01 * UM

TOOLS = {
    "flat": make_tool("flat", diameter_mm=10.0, length_mm=30.0),
    "ball": make_tool("ball", diameter_mm=10.0, length_mm=30.0),
    "bull": make_tool("bull", diameter_mm=10.0, length_mm=30.0, corner_radius_mm=2.0),
    "chamfer": make_tool("chamfer", diameter_mm=10.0, length_mm=30.0, tip_diameter_mm=2.0),
    "drill": make_tool("drill", diameter_mm=10.0, length_mm=30.0),
    "profile": make_tool("profile", points_mm=[(2.0, 0.0), (5.0, 3.0), (5.0, 30.0)]),
}
EVERY_TOOL = pytest.mark.parametrize("tool", TOOLS.values(), ids=TOOLS.keys())


def deviations(points, normals, sweeps, tool, **more):
    edges = find_edges(points, normals, sweeps=sweeps, tools=[tool], blank_mm=None, **more)
    assert (edges.status == EdgeStatus.CUT).all()
    return edges.deviation_mm


def wall_of_bore(radius, count, height):
    """Points and normals on the wall of a round pocket."""
    angle = np.random.default_rng(3).uniform(0.0, 2 * np.pi, count)
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], axis=1)
    return radius * ring + np.array([0.0, 0.0, height]), -ring, angle


@EVERY_TOOL
def test_perfect_circular_pocket(tool):
    points, normals, _ = wall_of_bore(25.0, 200, 12.0)
    found = deviations(points, normals, circle(20.0, 26), tool)
    assert np.abs(found).max() <= PERFECT


@EVERY_TOOL
@pytest.mark.parametrize(("lobes", "pieces"), [(2, 26), (5, 52)])
def test_circular_pocket_with_lobed_error(tool, lobes, pieces):
    """Nodes 5 mm apart for an ellipse, 2.5 mm for five lobes: the cubics' own error is 0.007 um."""
    size = 0.010

    def error(angle):
        return size * np.cos(lobes * angle), -size * lobes * np.sin(lobes * angle)

    points, normals, angle = wall_of_bore(25.0, 60, 12.0)
    found = deviations(points, normals, circle(20.0, pieces, error=error), tool)

    def edge(theta):
        """The farthest any of the moving circles reaches on the ray at theta."""

        def short(phi):
            d = 20.0 + error(phi)[0]
            off = phi - theta
            return -(d * np.cos(off) + np.sqrt(25.0 - (d * np.sin(off)) ** 2))

        bounds = (theta - 0.2, theta + 0.2)
        return -minimize_scalar(short, bounds=bounds, method="bounded", options={"xatol": 1e-9}).fun

    expected = 25.0 - np.array([edge(theta) for theta in angle])
    assert np.abs(expected).max() > 9.0 * UM
    assert np.abs(found - expected).max() <= CLOSE


@EVERY_TOOL
def test_perfect_helix_and_spiral(tool):
    points, normals, angle = wall_of_bore(8.0, 200, 12.0)
    helix = circle(3.0, 24, rise=6.0, turns=3.0)
    assert np.abs(deviations(points, normals, helix, tool)).max() <= PERFECT
    # an Archimedean spiral: the envelope of the tool at polar angle theta, near the last turn
    spiral = circle(20.0, 80, growth=2.0, turns=2.0)
    points, normals, angle = wall_of_bore(26.5, 40, 12.0)

    def edge(theta):
        def short(turn):
            d = 20.0 + 2.0 * turn / (4 * np.pi)
            off = turn - theta
            return -(d * np.cos(off) + np.sqrt(25.0 - (d * np.sin(off)) ** 2))

        rays = theta + 2 * np.pi * np.arange(-1, 3)
        spans = [(max(0.0, ray - 0.2), min(4 * np.pi, ray + 0.2)) for ray in rays]
        options = {"xatol": 1e-10}
        inner = [
            minimize_scalar(short, bounds=span, method="bounded", options=options).fun
            for span in spans
            if span[0] < span[1]
        ]
        ends = [short(end) for end in (0.0, 4 * np.pi) if np.cos(end - theta) > 0.98]
        return -min(inner + ends)

    expected = 26.5 - np.array([edge(theta) for theta in angle])
    found = deviations(points, normals, spiral, tool, reach_mm=3.0)
    assert np.abs(found - expected).max() <= 1e-9


def test_ball_milled_sphere():
    """Meridians about a ball-shaped boss: cusps in closed form, and a shift of it all."""
    ball, boss = 5.0, 30.0
    orbit = ball + boss
    offset = np.array([0.004, -0.007, 0.006])
    planes = np.radians(np.arange(0.0, 180.0, 3.0))
    parts = []
    for plane in planes:
        along = np.array([np.cos(plane), np.sin(plane), 0.0])
        turn = np.linspace(0.0, np.pi, 25)
        centres = orbit * (np.cos(turn)[:, None] * along + np.sin(turn)[:, None] * [0, 0, 1])
        tips = centres - np.array([0.0, 0.0, ball])
        arc = (-np.array([0.0, 0.0, ball]), np.cross(along, [0, 0, 1]), turn[1] - turn[0])
        still = np.broadcast_to(offset, (24, 2, 3)), np.zeros((24, 2, 3))
        parts.append(sweeps_of(tips[:-1], tips[1:], arc=arc, shift=still))
    rng = np.random.default_rng(5)
    longitude, latitude = rng.uniform(0, 2 * np.pi, 80), np.radians(rng.uniform(20, 85, 80))
    normals = np.stack(
        [
            np.cos(latitude) * np.cos(longitude),
            np.cos(latitude) * np.sin(longitude),
            np.sin(latitude),
        ],
        axis=1,
    )
    found = deviations(
        boss * normals + offset,
        normals,
        joined(*parts),
        make_tool("ball", diameter_mm=2 * ball, length_mm=30.0),
    )
    across = np.stack([-np.sin(planes), np.cos(planes), np.zeros_like(planes)], axis=1)
    sine = np.abs(normals @ across.T).min(axis=1)  # angle to the nearest meridian's plane
    cusp = orbit * np.sqrt(1 - sine**2) - np.sqrt(ball**2 - (orbit * sine) ** 2) - boss
    assert cusp.max() > 5 * UM
    assert np.abs(found - cusp).max() <= PERFECT * 10


@EVERY_TOOL
@pytest.mark.parametrize("lean", [0.0, 8e-5])
def test_wavy_wall_with_tilt(tool, lean):
    """Lines displaced sideways in a wave, the tool leaning: the wall is the wave's offset."""
    size, wave = 0.010, 2 * np.pi / 50.0
    x = np.linspace(0.0, 100.0, 21)
    height = 15.0
    value, slope = size * np.sin(wave * x), 5.0 * size * wave * np.cos(wave * x)
    shift = np.zeros((20, 2, 3)), np.zeros((20, 2, 3))
    shift[0][:, :, 1] = np.stack([value[:-1], value[1:]], axis=1)
    shift[1][:, :, 1] = np.stack([slope[:-1], slope[1:]], axis=1)
    tilt = np.zeros((20, 2, 3)), np.zeros((20, 2, 3))
    tilt[0][:, :, 0] = -lean
    path = np.stack([x, 0 * x, 0 * x], axis=1)
    sweeps = polyline(path, shift=shift, tilt=tilt)
    at = np.random.default_rng(7).uniform(10.0, 90.0, 50)
    points = np.stack([at, np.full(50, 5.0), np.full(50, height)], axis=1)
    found = deviations(points, np.tile([0.0, -1.0, 0.0], (50, 1)), sweeps, tool)

    def edge(place):
        def short(t):
            return -(size * np.sin(wave * t) + np.sqrt(25.0 - (place - t) ** 2))

        bounds = (place - 1.0, place + 1.0)
        return -minimize_scalar(short, bounds=bounds, method="bounded", options={"xatol": 1e-9}).fun

    # the side line y = 5 leans to y = 5 + lean z at height z - lean 5
    reached = np.array([edge(place) for place in at]) + lean * (height + 5.0 * lean)
    assert np.abs(found - (5.0 - reached)).max() <= CLOSE


@EVERY_TOOL
def test_perfect_lines(tool):
    """Side and bottom of an oblique slot; far from the origin, so that rounding shows."""
    origin = np.array([731.25, -412.5, 88.0])
    along = np.array([0.8, 0.6, 0.0])
    side = np.array([-0.6, 0.8, 0.0])
    steps = np.linspace(0.0, 60.0, 13)
    sweeps = polyline(origin + steps[:, None] * along)
    at = np.random.default_rng(2).uniform(5.0, 55.0, 100)[:, None]
    wall = origin + at * along + 5.0 * side + np.array([0.0, 0.0, 12.0])
    assert np.abs(deviations(wall, np.tile(-side, (100, 1)), sweeps, tool)).max() <= PERFECT
    floor = origin + at * along
    found = deviations(floor, np.tile([0.0, 0.0, 1.0], (100, 1)), sweeps, tool)
    assert np.abs(found).max() <= PERFECT


def test_ball_cusps_of_a_flat_raster():
    """Scallops between parallel lines: r - sqrt(r^2 - (step / 2)^2) at most."""
    ball = make_tool("ball", diameter_mm=10.0, length_mm=30.0)
    step = 0.5
    rows = [polyline([[0.0, k * step, 0.0], [40.0, k * step, 0.0]]) for k in range(-20, 21)]
    off = np.linspace(0.0, step, 41)
    points = np.stack([np.full(41, 20.0), off, np.zeros(41)], axis=1)
    found = deviations(points, np.tile([0.0, 0.0, 1.0], (41, 1)), joined(*rows), ball)
    near = np.minimum(off, step - off)
    assert found == pytest.approx(5.0 - np.sqrt(25.0 - near**2), abs=PERFECT)


def test_flat_bottom_follows_the_lowest_point_of_its_pass():
    """A floor under a flat tool that bobs: each point is left at the lowest level above it."""
    flat = make_tool("flat", diameter_mm=4.0, length_mm=20.0)
    size, wave = 0.010, 2 * np.pi / 40.0
    x = np.linspace(0.0, 100.0, 21)
    value, slope = size * np.sin(wave * x), 5.0 * size * wave * np.cos(wave * x)
    shift = np.zeros((20, 2, 3)), np.zeros((20, 2, 3))
    shift[0][:, :, 2] = np.stack([value[:-1], value[1:]], axis=1)
    shift[1][:, :, 2] = np.stack([slope[:-1], slope[1:]], axis=1)
    sweeps = polyline(np.stack([x, 0 * x, 0 * x], axis=1), shift=shift)
    at = np.linspace(10.0, 90.0, 161)
    points = np.stack([at, np.full(161, 0.7), np.zeros(161)], axis=1)
    found = deviations(points, np.tile([0.0, 0.0, 1.0], (161, 1)), sweeps, flat)
    half = np.sqrt(4.0 - 0.7**2)
    under = at[:, None] + np.linspace(-half, half, 20001)
    assert np.abs(found - (size * np.sin(wave * under)).min(axis=1)).max() <= CLOSE
