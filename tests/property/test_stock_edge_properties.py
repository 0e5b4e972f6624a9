"""What holds for any job: seams, order, more cutting, moved and turned parts."""

import numpy as np
import pytest

from stock import EdgeStatus, Material, Sweeps, find_edges, make_tool
from tests.oracle.stock_edge_cases import joined, sweeps_of

TOOLS = [
    make_tool("flat", diameter_mm=6.0, length_mm=20.0),
    make_tool("ball", diameter_mm=5.0, length_mm=20.0),
    make_tool("bull", diameter_mm=8.0, length_mm=20.0, corner_radius_mm=1.5),
]


def job(seed, count=60, points=300):
    """Random displaced lines on a level patch, points of the patch, normals near +Z."""
    rng = np.random.default_rng(seed)
    start = rng.uniform([-8, -8, -0.1], [8, 8, 0.1], (count, 3))
    way = rng.normal(size=(count, 3)) * [3.0, 3.0, 0.1]
    pairs = [0.01 * rng.normal(size=(count, 2, 3)) for _ in range(2)]
    leans = [5e-5 * rng.normal(size=(count, 2, 3)) for _ in range(2)]
    tool = rng.integers(len(TOOLS), size=count)
    sweeps = sweeps_of(start, start + way, tool=tool, shift=pairs, tilt=leans)
    normals = rng.normal(size=(points, 3)) * 0.2 + [0.0, 0.0, 1.0]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return sweeps, rng.uniform([-6, -6, -0.2], [6, 6, 0.2], (points, 3)), normals


def edges_of(sweeps, points, normals):
    return find_edges(points, normals, sweeps=sweeps, tools=TOOLS, blank_mm=None)


def changed(sweeps, **changes):
    names = sweeps.__dataclass_fields__
    return Sweeps(**{name: getattr(sweeps, name) for name in names} | changes)


def halves(value, slope):
    """Ends and slopes of a cubic Hermite curve cut in the middle, by the midpoint formulas."""
    middle = value.mean(axis=1) + (slope[:, 0] - slope[:, 1]) / 8
    rate = 1.5 * (value[:, 1] - value[:, 0]) - (slope[:, 0] + slope[:, 1]) / 4
    first = np.stack([value[:, 0], middle], axis=1), np.stack([slope[:, 0], rate], axis=1) / 2
    second = np.stack([middle, value[:, 1]], axis=1), np.stack([rate, slope[:, 1]], axis=1) / 2
    return first, second


@pytest.mark.parametrize("seed", range(3))
def test_a_cut_through_every_sweep_changes_nothing(seed):
    sweeps, points, normals = job(seed)
    middle = (sweeps.start_mm + sweeps.end_mm) / 2
    shifts = halves(sweeps.shift_mm, sweeps.shift_slope_mm)
    tilts = halves(sweeps.tilt_rad, sweeps.tilt_slope_rad)
    parts = [
        sweeps_of(a, b, tool=sweeps.tool, shift=shift, tilt=tilt)
        for a, b, shift, tilt in zip(
            (sweeps.start_mm, middle), (middle, sweeps.end_mm), shifts, tilts, strict=True
        )
    ]
    whole = edges_of(sweeps, points, normals)
    split = edges_of(joined(*parts), points, normals)
    assert (whole.status == EdgeStatus.CUT).sum() > 100
    assert (split.status == whole.status).all()
    assert np.abs(split.deviation_mm - whole.deviation_mm).max() <= 1e-9


@pytest.mark.parametrize("seed", range(3))
def test_sweeps_in_parts_are_the_same_material(seed):
    sweeps, points, normals = job(seed)
    parts = (Sweeps(**{name: value[k : k + 17] for name, value in vars(sweeps).items()})
             for k in range(0, len(sweeps), 17))  # fmt: skip
    whole = edges_of(sweeps, points, normals)
    found = Material(parts, TOOLS, None, count=len(sweeps)).edges(points, normals, 1.0)
    for name, value in vars(whole).items():
        assert np.array_equal(getattr(found, name), value)


@pytest.mark.parametrize("seed", range(3))
def test_order_of_sweeps_and_points_does_not_matter(seed):
    sweeps, points, normals = job(seed)
    rng = np.random.default_rng(seed)
    order, mixed = rng.permutation(len(sweeps)), rng.permutation(len(points))
    names = sweeps.__dataclass_fields__
    shuffled = Sweeps(**{name: getattr(sweeps, name)[order] for name in names})
    found, other = (
        edges_of(sweeps, points, normals),
        edges_of(shuffled, points[mixed], normals[mixed]),
    )
    assert (other.status == found.status[mixed]).all()
    assert np.abs(other.deviation_mm - found.deviation_mm[mixed]).max() <= 1e-10
    same = edges_of(sweeps, points, normals)
    assert (same.deviation_mm == found.deviation_mm).all()  # to the last bit
    assert (same.sweep == found.sweep).all()


@pytest.mark.parametrize("seed", range(3))
def test_more_cutting_never_leaves_more_near_the_surface(seed):
    """A point in air stays in air; where both are cut from air, the edge goes down at most."""
    sweeps, points, normals = job(seed)
    names = sweeps.__dataclass_fields__
    fewer = Sweeps(**{name: getattr(sweeps, name)[:40] for name in names})
    less, more = edges_of(fewer, points, normals), edges_of(sweeps, points, normals)
    rank = {EdgeStatus.UNCUT: np.inf, EdgeStatus.GOUGED: -np.inf}
    level = [
        np.array([rank.get(s, d) for s, d in zip(e.status, e.deviation_mm, strict=True)])
        for e in (less, more)
    ]
    assert (level[1] <= level[0] + 1e-9).all()
    assert (level[1] < level[0] - 1e-6).any()


@pytest.mark.parametrize("seed", range(2))
def test_a_part_moved_and_turned_about_z(seed):
    sweeps, points, normals = job(seed)
    found = edges_of(sweeps, points, normals)
    angle, offset = 0.7, np.array([310.0, -205.0, 48.0])
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).T
    moved = changed(
        sweeps,
        start_mm=sweeps.start_mm @ turn + offset,
        end_mm=sweeps.end_mm @ turn + offset,
        shift_mm=sweeps.shift_mm @ turn,
        shift_slope_mm=sweeps.shift_slope_mm @ turn,
        tilt_rad=sweeps.tilt_rad @ turn,
        tilt_slope_rad=sweeps.tilt_slope_rad @ turn,
    )
    other = edges_of(moved, points @ turn + offset, normals @ turn)
    assert (other.status == found.status).all()
    assert np.abs(other.deviation_mm - found.deviation_mm).max() <= 1e-9
    assert (other.sweep == found.sweep).mean() > 0.99


def test_reach_only_hides():
    sweeps, points, normals = job(5)
    far, near = (
        find_edges(points, normals, sweeps=sweeps, tools=TOOLS, blank_mm=None, reach_mm=reach)
        for reach in (2.0, 0.1)
    )
    seen = near.status == EdgeStatus.CUT
    assert 50 < seen.sum() < len(points)
    assert np.abs(far.deviation_mm[seen] - near.deviation_mm[seen]).max() <= 1e-9
    assert (np.abs(far.deviation_mm[~seen & (far.status == EdgeStatus.CUT)]) > 0.1).all()
