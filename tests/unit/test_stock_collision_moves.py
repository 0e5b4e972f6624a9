"""Collisions: which moves are named, which are not, and how deep they are."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from stock import StockError, find_collisions, make_tool
from tests.stock_solid_cases import polyline

FLAT = make_tool("flat", diameter_mm=10.0, length_mm=20.0)
BALL = make_tool("ball", diameter_mm=10.0, length_mm=20.0)
BOX = ((-20.0, -20.0, -40.0), (40.0, 40.0, 0.0))
SHANK = [(5.0, 20.0), (5.0, 60.0)]


def named(collisions) -> list[tuple[int, str]]:
    return [(c.move, c.kind) for c in collisions]


def test_rapids_through_material_are_named_with_depth_and_place():
    path = [[-30, 0, 10], [-30, 0, -3], [50, 0, -3], [50, 20, -3], [-30, 20, -3], [-30, 20, 10]]
    found = find_collisions(polyline(path), [FLAT], BOX, rapid_moves=[0, 1, 3, 4])
    assert named(found) == [(1, "rapid in material"), (3, "rapid in material")]
    assert found[0].depth_mm == pytest.approx(3.0, abs=1e-9)
    assert found[0].place_mm[2] == pytest.approx(-3.0, abs=1e-9)
    assert abs(found[0].place_mm[1]) < 5
    assert 15 < found[1].place_mm[1] < 25


def test_rapids_where_the_program_has_cut_are_free():
    slot = [[-30, 0, -3], [50, 0, -3]]
    back = [[50, 0, -3], [-30, 0, -3], [-30, 0, 5], [10, 0, 5], [10, 0, -3], [20, 0, -3]]
    sweeps = polyline(slot + back[1:])
    assert find_collisions(sweeps, [FLAT], BOX, rapid_moves=[1, 2, 3, 4, 5]) == ()


def test_the_stock_is_the_one_of_that_time():
    """The same rapid before and after the cut that makes room for it."""
    path = [[50, 0, -3], [-30, 0, -3], [50, 0, -3]]
    assert find_collisions(polyline(path), [FLAT], BOX, rapid_moves=[1]) == ()
    assert named(find_collisions(polyline(path), [FLAT], BOX, rapid_moves=[0])) == [
        (0, "rapid in material")
    ]


@pytest.mark.parametrize("side_um", [5.0, -5.0])
def test_machine_errors_are_no_collision(side_um):
    """A rapid back through a slot, a few micrometres beside and below the way it was cut."""
    path = np.array([[-30, 0, -3], [50, 0, -3], [-30, 0, -3]], dtype=float)
    path[2] += [0, side_um * 1e-3, -5e-3]
    for tool in (FLAT, BALL):
        assert find_collisions(polyline(path), [tool], BOX, rapid_moves=[1], cell_mm=0.2) == ()


def test_shank_below_the_edge_of_an_uncut_wall():
    deep = polyline([[-30, 0, -25], [50, 0, -25]])
    found = find_collisions(deep, [FLAT], BOX, shanks=[SHANK])
    assert named(found) == [(0, "shank")]
    assert found[0].depth_mm == pytest.approx(5.0, abs=1e-9)
    assert found[0].place_mm[2] == pytest.approx(-5.0, abs=1e-9)


def test_shank_in_a_slot_cut_in_two_passes_is_free():
    passes = polyline([[-30, 0, -15], [50, 0, -15], [-30, 0, -15], [-30, 0, -25], [50, 0, -25]])
    assert find_collisions(passes, [FLAT], BOX, shanks=[SHANK]) == ()
    wide = [(7.0, 20.0), (7.0, 60.0)]
    found = find_collisions(passes, [FLAT], BOX, shanks=[wide])
    assert named(found) == [(3, "shank")]
    assert 5 < abs(found[0].place_mm[1]) < 7


@pytest.mark.parametrize(("height", "moves"), [(24.0, [1, 2]), (25.01, []), (24.99, [])])
def test_holder_over_the_top_face(height, moves):
    """The holder is 1 mm in, free, and in by less than the clearance."""
    passes = polyline([[-30, 0, -15], [50, 0, -15], [50, 0, -25.0], [-30, 0, -25.0]])
    holder = [(20.0, height), (30.0, height + 40)]
    found = find_collisions(passes, [FLAT], BOX, holders=[holder])
    assert named(found) == [(move, "holder") for move in moves]
    assert [c.depth_mm for c in found] == [pytest.approx(1.0, abs=1e-9) for _ in moves]


def test_conical_holder_touches_where_the_cone_is_wide_enough():
    """Beside a wall 15 mm away and 12.5 mm high the cone is 5 mm above its lowest rim."""
    step = trimesh.util.concatenate(
        trimesh.creation.box(bounds=[[-20, -20, -40], [0, 20, -10]]),
        trimesh.creation.box(bounds=[[15, -20, -40], [20, 20, 12.5]]),
    )
    cone = [(10.0, 20.0), (20.0, 30.0), (20.0, 60.0)]
    for tip_z, depth in ((-12.0, 0.0), (-14.0, 1.5)):
        sweeps = polyline([[0, -5, tip_z], [0, 5, tip_z]])
        found = find_collisions(sweeps, [FLAT], step, holders=[cone], cell_mm=0.25)
        assert [c.depth_mm for c in found] == [pytest.approx(depth, abs=0.3)] * (depth > 0)
        assert all(c.kind == "holder" and 15 < c.place_mm[0] < 15.3 for c in found)


def test_under_a_ledge():
    """A disc cutter may go in at the side at feed; straight up from there it is caught."""
    disc = make_tool("profile", points_mm=[(8.0, 0.0), (8.0, 3.0)])
    shank = [(3.0, 3.0), (3.0, 50.0)]
    slot = [[-40, 0, -10], [50, 0, -10], [-40, 0, -10]]
    flat = make_tool("flat", diameter_mm=8.0, length_mm=20.0)
    first = polyline(slot[:2], tool=0)
    second = polyline([[-40, 0, -10], [10, 0, -10], [10, 0, 20]], tool=1, move=[1, 2])
    both = {
        name: np.concatenate([getattr(first, name), getattr(second, name)])
        for name in first.__dataclass_fields__
    }
    found = find_collisions(
        type(first)(**both), [flat, disc], BOX, rapid_moves=[2], shanks=[None, shank]
    )
    assert named(found) == [(2, "rapid in material")]
    assert found[0].depth_mm == pytest.approx(3.0, abs=1e-9)


def test_deterministic_and_told_about_progress():
    rng = np.random.default_rng(5)
    path = np.column_stack([rng.uniform(-15, 35, (30, 2)), rng.uniform(-30, 2, 30)])
    seen = []
    runs = [
        find_collisions(
            polyline(path),
            [FLAT],
            BOX,
            rapid_moves=range(0, 30, 3),
            shanks=[SHANK],
            progress=lambda *counts: seen.append(counts),
        )
        for _ in range(2)
    ]
    assert repr(runs[0]) == repr(runs[1])
    assert runs[0]
    assert seen[-1] == (29, 29)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"cell_mm": 0.0}, "cells of 0.0 mm"),
        ({"clearance_mm": -1.0}, "clearance of -1.0 mm"),
        ({"shanks": [SHANK, SHANK]}, "2 shanks for 1 tools"),
        ({"holders": [[(1.0, 2.0)]]}, "encloses no volume"),
        ({"holders": [[(0.0, 2.0), (0.0, 5.0)]]}, "encloses no volume"),
        ({"shanks": [[1.0, 2.0]]}, "list of points"),
        ({"shanks": [[(1.0, np.nan), (1.0, 3.0)]]}, "list of points"),
    ],
)
def test_wrong_input(options, words):
    with pytest.raises(StockError, match=words):
        find_collisions(polyline([[0, 0, 0], [1, 0, 0]]), [FLAT], BOX, **options)


def test_missing_tool():
    with pytest.raises(StockError, match="has tool 1; accepted: 0 to 0"):
        find_collisions(polyline([[0, 0, 0], [1, 0, 0]], tool=1), [FLAT], BOX)
