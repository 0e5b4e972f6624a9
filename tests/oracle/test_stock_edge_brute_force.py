"""The engine against brute force over all moves: oblique lines, random sweeps of all tools."""

from dataclasses import replace

import numpy as np
import pytest

from stock import Sweeps, find_edges, make_tool
from tests.oracle import stock_brute_force as brute

TOOLS = [
    {"shape": "flat", "diameter_mm": 6.0, "length_mm": 20.0},
    {"shape": "ball", "diameter_mm": 5.0, "length_mm": 20.0},
    {"shape": "bull", "diameter_mm": 8.0, "length_mm": 20.0, "corner_radius_mm": 1.5},
    {
        "shape": "chamfer",
        "diameter_mm": 6.0,
        "length_mm": 15.0,
        "tip_diameter_mm": 1.0,
        "angle_deg": 90.0,
    },
    {"shape": "drill", "diameter_mm": 4.0, "length_mm": 20.0, "angle_deg": 118.0},
]


def arc_like(rng, start):
    """Centre, axis, angle and end of a random arc, helix or spiral from `start`."""
    axis = np.eye(3)[rng.choice([0, 1, 2, 2, 2])]
    radial = np.cross(axis, rng.normal(size=3))
    radial /= np.linalg.norm(radial)
    radius, growth = rng.uniform(0.5, 20.0), rng.choice([0.0, rng.uniform(-0.1, 0.1)])
    angle = rng.choice([-1.0, 1.0]) * min(5.0 / radius, 6.0) * rng.uniform(0.2, 1.0)
    rise = rng.choice([0.0, rng.uniform(-1.0, 1.0)])
    centre = start - radius * radial
    turned = np.cos(angle) * radial + np.sin(angle) * np.cross(axis, radial)
    return centre, axis, angle, centre + (radius + growth) * turned + rise * axis


def random_sweeps(rng, count, *, arcs, shift, tilt):
    start = rng.uniform(-6.0, 6.0, (count, 3)) * [1.0, 1.0, 0.3]
    way = rng.normal(size=(count, 3))
    end = start + way * (rng.uniform(0.5, 5.0, count) / np.linalg.norm(way, axis=1))[:, None]
    centre, axis, angle = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    for i in range(0, count if arcs else 0, 2):
        centre[i], axis[i], angle[i], end[i] = arc_like(rng, start[i])
    return Sweeps(
        start_mm=start,
        end_mm=end,
        centre_mm=centre,
        axis=axis,
        sweep_rad=angle,
        tool=rng.integers(len(TOOLS), size=count),
        move=np.arange(count),
        shift_mm=shift * rng.normal(size=(count, 2, 3)),
        shift_slope_mm=shift * rng.normal(size=(count, 2, 3)),
        tilt_rad=tilt * rng.normal(size=(count, 2, 3)),
        tilt_slope_rad=tilt * rng.normal(size=(count, 2, 3)),
    )


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("arcs", [False, True], ids=["lines", "arcs"])
@pytest.mark.parametrize(
    ("shift", "tilt"),
    [(0.0, 0.0), (0.01, 0.0), (0.1, 1e-4)],
    ids=["perfect", "shifted", "far and tilted"],
)
def test_random_oblique_lines(seed, arcs, shift, tilt):
    rng = np.random.default_rng(seed)
    sweeps = random_sweeps(rng, 12, arcs=arcs, shift=shift, tilt=tilt)
    points = rng.uniform(-6.0, 6.0, (25, 3)) * [1.0, 1.0, 0.5]
    normals = rng.normal(size=(25, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    reach = 3.0
    tools = [make_tool(**tool) for tool in TOOLS]
    found = find_edges(points, normals, sweeps=sweeps, tools=tools, blank_mm=None, reach_mm=reach)
    assert len(set(found.status)) == 3  # each state occurs
    for k in range(len(points)):
        state, h = brute.edge(sweeps, TOOLS, points[k], normals[k], reach)
        assert found.status[k] == state
        assert found.deviation_mm[k] == pytest.approx(h, abs=1e-9)


@pytest.mark.parametrize("shape", range(len(TOOLS)), ids=[tool["shape"] for tool in TOOLS])
def test_points_near_a_displaced_raster(shape):
    """Overlapping passes of one tool, points on the level that they leave."""
    rng = np.random.default_rng(shape)
    rows = np.arange(12) * 0.6
    nodes = np.stack(np.meshgrid(np.linspace(0.0, 8.0, 4), rows, [0.0], indexing="ij"), axis=-1)
    nodes = nodes.reshape(4, 12, 3)
    start, end = nodes[:-1].reshape(-1, 3), nodes[1:].reshape(-1, 3)
    count = len(start)
    sweeps = Sweeps(
        start_mm=start,
        end_mm=end,
        centre_mm=np.zeros((count, 3)),
        axis=np.zeros((count, 3)),
        sweep_rad=np.zeros(count),
        tool=np.full(count, shape),
        move=np.arange(count),
        shift_mm=0.005 * rng.normal(size=(count, 2, 3)),
        shift_slope_mm=0.002 * rng.normal(size=(count, 2, 3)),
        tilt_rad=np.zeros((count, 2, 3)),
        tilt_slope_rad=np.zeros((count, 2, 3)),
    )
    points = rng.uniform([1.0, 1.0, -0.01], [7.0, 6.0, 0.05], (12, 3))
    normals = rng.normal(size=(12, 3)) * 0.1 + [0.0, 0.0, 1.0]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    tools = [make_tool(**tool) for tool in TOOLS]
    found = find_edges(points, normals, sweeps=sweeps, tools=tools, blank_mm=None)
    for k in range(len(points)):
        state, h = brute.edge(sweeps, TOOLS, points[k], normals[k], 1.0)
        assert found.status[k] == state
        assert found.deviation_mm[k] == pytest.approx(h, abs=1e-9)


@pytest.mark.parametrize("tilt", [0.0, 2e-5, 1e-3])
def test_a_floor_below_a_mill_that_stands_over_all_of_it(tilt):
    """Every sweep covers every point, and micrometres decide which one went deepest."""
    rng = np.random.default_rng(3)
    sweeps = random_sweeps(rng, 40, arcs=True, shift=1e-3, tilt=tilt)
    smooth = {name: getattr(sweeps, name)[:, :1] + 0.02 * getattr(sweeps, name)
              for name in ("shift_mm", "tilt_rad")}  # fmt: skip
    smooth |= {name: 0.02 * getattr(sweeps, name) for name in ("shift_slope_mm", "tilt_slope_rad")}
    tool = {"shape": "flat", "diameter_mm": 200.0, "length_mm": 150.0}
    level = {name: getattr(sweeps, name) * [1.0, 1.0, 0.0] for name in ("start_mm", "centre_mm")}
    upright = np.abs(sweeps.axis[:, 2]) == 1.0
    end = np.where(upright[:, None], sweeps.end_mm, sweeps.end_mm * [1.0, 1.0, 0.0])
    end[upright, 2] = 0.001 * (sweeps.end_mm - sweeps.start_mm)[upright, 2]
    kept = upright | (sweeps.sweep_rad == 0.0)
    whole = replace(sweeps, **level, **smooth, end_mm=end, tool=np.zeros(40, int))
    sweeps = Sweeps(**{name: getattr(whole, name)[kept] for name in whole.__dataclass_fields__})
    points = rng.uniform([-40.0, -40.0, -0.02], [40.0, 40.0, 0.02], (12, 3))
    normals = rng.normal(size=(12, 3)) * 0.2 + [0.0, 0.0, 1.0]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    found = find_edges(points, normals, sweeps=sweeps, tools=[make_tool(**tool)], blank_mm=None)
    for k in range(len(points)):
        state, h = brute.edge(sweeps, [tool], points[k], normals[k], 1.0)
        assert found.status[k] == state
        assert found.deviation_mm[k] == pytest.approx(h, abs=1e-9)


@pytest.mark.parametrize(
    "point",
    [(1.011, -2.989, -0.084), (1.015, -2.989, -0.079), (1.018, -2.987, -0.082),
     (1.02, -2.983, -0.081), (1.016, -2.993, -0.08)],
)  # fmt: skip
def test_an_entry_that_is_barely_within_reach(point):
    """A flat bottom that rises and ripples: its distance has a kink along it, and must be exact.

    A distance that is found too large is not noticed as long as the search goes on from there;
    where little more than the entry itself is of interest, the entry is lost.
    """
    sweep = one_sweep((0.077, 0.252, -0.079), (-1.0, -1.628, 0.0),
                      shift=[(0.0094, 0.0086, 0.0095), (0.0084, 0.0097, 0.01)],
                      slope=[(-0.0007, 0.0016, 0.001), (-0.0012, 0.0007, 0.0001)])  # fmt: skip
    point, normal = np.array(point), np.array([0.014, 0.104, 1.0])
    normal /= np.linalg.norm(normal)
    state, h = brute.edge(sweep, TOOLS, point, normal, 1.0)
    assert (state, h > 0.0) == (0, True)
    tools = [make_tool(**tool) for tool in TOOLS]
    found = find_edges(point[None], normal[None], sweeps=sweep, tools=tools, blank_mm=None,
                       reach_mm=1.05 * h)  # fmt: skip
    assert found.status[0] == 0
    assert found.deviation_mm[0] == pytest.approx(h, abs=1e-9)


def one_sweep(start, end, *, shift, slope):
    """One straight sweep of the first tool, not tilted."""
    none, upright = np.zeros((1, 3)), np.zeros((1, 2, 3))
    return Sweeps(start_mm=np.array([start]), end_mm=np.array([end]), centre_mm=none, axis=none,
                  sweep_rad=np.zeros(1), tool=np.zeros(1, int), move=np.zeros(1, int),
                  shift_mm=np.array([shift]), shift_slope_mm=np.array([slope]),
                  tilt_rad=upright, tilt_slope_rad=upright)  # fmt: skip
