"""Points of the surface that a program leaves, against closed forms of pockets and grooves."""

import numpy as np
import pytest

from stock import find_left_surface, make_tool
from tests.oracle.stock_edge_cases import circle, joined, polyline

SPACING = 0.5
EXACT = 1e-9


def surface(sweeps, tool, blank, **more):
    settings = {"spacing_mm": SPACING, "margin_mm": 0.02} | more
    return find_left_surface(
        sweeps, [tool], blank_mm=blank, is_cutting=np.ones(len(sweeps), bool), **settings
    )


def is_like(found, direction):
    return found.normal @ np.array(direction) > 1.0 - 1e-9


def test_a_slot_has_its_floor_two_walls_and_two_half_bores():
    tool = make_tool("flat", diameter_mm=4, length_mm=20)
    down_and_along = polyline([(0.0, 0, 5), (0, 0, -3), (20, 0, -3), (20, 0, 5)])
    found = surface(down_and_along, tool, ([-10, -10, -8], [30, 10, 0]))
    x, y, z = found.point_mm.T
    floor = is_like(found, (0, 0, 1))
    np.testing.assert_allclose(z[floor], -3, atol=EXACT)
    beside = np.clip(x, 0, 20) - x
    np.testing.assert_array_less(np.hypot(beside, y)[floor], 2.0)
    walls = ~floor
    np.testing.assert_allclose(np.hypot(beside, y)[walls], 2.0, atol=EXACT)
    inwards = np.column_stack([beside, -y, 0 * z]) / 2.0
    np.testing.assert_allclose(found.normal[walls], inwards[walls], atol=1e-6)
    # no part of it is left out: a point for about every square of the spacing
    area_floor, area_walls = 80 + 4 * np.pi, 3 * (40 + 4 * np.pi)
    assert floor.sum() > 0.7 * area_floor / SPACING**2
    assert walls.sum() > 0.7 * area_walls / SPACING**2
    for end in (x < -1.9, x > 21.9):
        assert (end & walls).sum() > 5


@pytest.mark.parametrize("rise", [0.0, 4.0])
def test_a_ball_leaves_a_cylinder_along_a_line(rise):
    tool = make_tool("ball", diameter_mm=6, length_mm=20)
    start, end = np.array([0.0, 0, -5]), np.array([30.0, 0, -5 + rise])
    found = surface(polyline([start, end]), tool, ([5, -10, -20], [25, 10, -2]))
    way = (end - start) / np.linalg.norm(end - start)
    arm = found.point_mm - start - [0, 0, 3]
    arm -= (arm @ way)[:, None] * way
    np.testing.assert_allclose(np.linalg.norm(arm, axis=1), 3.0, atol=EXACT)
    np.testing.assert_allclose(found.normal, -arm / 3.0, atol=1e-6)
    assert len(found) > 100


def test_a_rim_on_a_ramp_leaves_part_of_an_elliptic_cylinder():
    tool = make_tool("flat", diameter_mm=8, length_mm=20)
    found = surface(polyline([(0.0, 0, 0), (40, 0, -8)]), tool, ([10, -10, -20], [30, 10, -1]))
    x, y, z = found.point_mm.T
    slope = found.normal[:, 2] > 1e-3
    # the rim's point at y is sqrt(16 - y^2) behind the tip, and as high as the tip
    np.testing.assert_allclose(z[slope], -0.2 * (x + np.sqrt(16 - y**2))[slope], atol=EXACT)
    np.testing.assert_allclose(np.abs(y[~slope]), 4.0, atol=EXACT)
    assert slope.sum() > 200


def test_a_drill_leaves_its_cone_and_bore():
    tool = make_tool("drill", diameter_mm=6, length_mm=30, angle_deg=90)
    there_and_back = polyline([(0.0, 0, 5), (0, 0, -10), (0, 0, 5)])
    found = surface(there_and_back, tool, ([-9, -9, -20], [9, 9, 0]))
    r, z = np.hypot(found.point_mm[:, 0], found.point_mm[:, 1]), found.point_mm[:, 2]
    bore = np.abs(found.normal[:, 2]) < 1e-6
    np.testing.assert_allclose(r[bore], 3.0, atol=EXACT)
    np.testing.assert_allclose(z[~bore], -10 + r[~bore], atol=EXACT)
    assert bore.sum() > 100
    assert (~bore).sum() > 20


def test_the_wall_of_a_circular_pocket():
    tool = make_tool("flat", diameter_mm=10, length_mm=20)
    found = surface(circle(8.0, 12), tool, ([-20, -20, -4], [20, 20, 6]))
    r = np.hypot(found.point_mm[:, 0], found.point_mm[:, 1])
    floor = is_like(found, (0, 0, 1))
    np.testing.assert_allclose(found.point_mm[floor, 2], 0.0, atol=EXACT)
    outer, inner = ~floor & (r > 10), ~floor & (r < 10)
    np.testing.assert_allclose(r[outer], 13.0, atol=EXACT)
    np.testing.assert_allclose(r[inner], 3.0, atol=EXACT)
    assert min(outer.sum(), inner.sum()) > 100


def raster(rows, columns, seed=1):
    """Tips of a ball that goes to and fro over a wavy floor."""
    random = np.random.default_rng(seed)
    y, x = np.meshgrid(np.linspace(-6, 6, rows), np.linspace(-8, 8, columns), indexing="ij")
    x[1::2] = x[1::2, ::-1]
    z = -2 + 0.6 * np.sin(x / 3) * np.cos(y / 2) + random.normal(scale=1e-3, size=x.shape)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3)


def distance_to_polyline(points, corners):
    """Distance from the nearest of all segments, and the place on it."""
    start, way = corners[:-1], np.diff(corners, axis=0)
    offset = points[:, None] - start
    share = np.einsum("psi,si->ps", offset, way) / np.einsum("si,si->s", way, way)
    gap = offset - np.clip(share, 0, 1)[:, :, None] * way
    length = np.linalg.norm(gap, axis=2)
    nearest = length.argmin(axis=1)
    return length.min(axis=1), gap[np.arange(len(points)), nearest]


def test_a_raster_of_short_moves_leaves_what_no_ball_has_reached():
    tool, tips = make_tool("ball", diameter_mm=4, length_mm=20), raster(41, 60)
    found = surface(polyline(tips), tool, ([-9, -7, -10], [9, 7, -0.9]), margin_mm=0.0)
    distance, gap = distance_to_polyline(found.point_mm, tips + np.array([0, 0, 2.0]))
    np.testing.assert_allclose(distance, 2.0, atol=EXACT)  # on a ball, and in none
    off = np.linalg.norm(found.normal + gap / distance[:, None], axis=1)
    assert np.mean(off < 1e-5) > 0.98
    assert off.max() < 0.03  # where a shallow cusp lies within a micrometre
    cells = np.unique(np.floor(found.point_mm[:, :2] / 1.0), axis=0)
    assert len(cells) >= 0.95 * 18 * 14  # everywhere on the floor


def test_what_a_later_pass_takes_away_is_not_found():
    tool = make_tool("flat", diameter_mm=4, length_mm=20)
    rough = polyline([(0.0, 0, -2), (20, 0, -2)])
    fine = polyline([(0.0, 0, -2.3), (20, 0, -2.3)])
    blank = ([5, -10, -8], [15, 10, 0])
    for order in (joined(rough, fine), joined(fine, rough)):
        found = surface(order, tool, blank)
        assert found.point_mm[:, 2].min() == pytest.approx(-2.3)
        floor = is_like(found, (0, 0, 1))
        np.testing.assert_allclose(found.point_mm[floor, 2], -2.3, atol=EXACT)


def test_points_keep_off_edges_by_the_margin():
    tool = make_tool("flat", diameter_mm=4, length_mm=20)
    found = surface(polyline([(0.0, 0, -3), (20, 0, -3)]), tool, ([5, -10, -8], [15, 10, 0]),
                    margin_mm=0.3)  # fmt: skip
    y, z = np.abs(found.point_mm[:, 1]), found.point_mm[:, 2]
    floor = is_like(found, (0, 0, 1))
    assert y[floor].max() <= 1.7
    assert z[~floor].min() >= -2.7


def test_nothing_cut_is_nothing_found():
    tool = make_tool("flat", diameter_mm=4, length_mm=20)
    assert len(surface(polyline([(0.0, 0, 3), (20, 0, 3)]), tool, ([0, 0, -8], [9, 9, 0]))) == 0


def test_slabs_of_few_contacts_find_the_same_points(monkeypatch):
    """What is looked at together is a matter of memory alone."""
    tool = make_tool("flat", diameter_mm=4, length_mm=20)
    way = [(x, y, -3.0) for y in range(0, 12, 2) for x in ((0, 40) if y % 4 else (40, 0))]
    blank = ([-10, -10, -8], [50, 20, 0])
    whole = surface(polyline(way), tool, blank)
    monkeypatch.setattr("stock.exact.left_surface._CONTACTS_AT_ONCE", 100)
    in_slabs = surface(polyline(way), tool, blank)
    for name in ("point_mm", "normal", "sweep"):
        np.testing.assert_array_equal(getattr(in_slabs, name), getattr(whole, name))
    assert len(whole) > 500
