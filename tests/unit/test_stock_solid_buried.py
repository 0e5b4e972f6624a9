"""Strokes that are left out because others take all that they take."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import Manifold, Mesh64

from stock import cut_part, make_tool
from stock.solid.buried_strokes import Footprints, needed_strokes
from tests.stock_solid_cases import polyline

BLOCK = (np.array([0.0, 0.0, -20.0]), np.array([60.0, 40.0, 0.0]))


def footprints(*strokes) -> Footprints:
    """Strokes of a flat tool of radius 5 mm, each from (x, y) to (x, y) at a height."""
    start, end, floor = zip(*strokes, strict=True)
    floor, radius = np.array(floor, dtype=float), np.full(len(floor), 5.0)
    return Footprints(
        start_mm=np.array(start, dtype=float),
        end_mm=np.array(end, dtype=float),
        outer_mm=radius + 1e-6,
        low_mm=floor - 1e-6,
        inner_mm=radius[:, None] - 0.01,
        floor_mm=floor[:, None] + 1e-6,
    )


def needed(*strokes) -> list[bool]:
    return needed_strokes(footprints(*strokes), *BLOCK).tolist()


def test_deeper_and_wider_cuts_bury_the_others():
    rough = (10, 20), (50, 20), -4.0
    left, right = ((8, 19), (52, 19), -4.2), ((8, 21), (52, 21), -4.2)
    assert needed(rough, left, right) == [False, True, True]
    assert needed(left, rough, right) == [True, False, True]


@pytest.mark.parametrize("reach_mm", [0.3, -0.3])
def test_what_sticks_out_of_the_others_stays(reach_mm):
    rough = (10, 20), (50, 20), -4.0
    finish = (10 + reach_mm, 20), (50, 20), -8.0
    assert needed(rough, finish) == [True, True] if reach_mm > 0 else [False, True]


def test_equal_cuts_and_lower_ones_stay():
    stroke = (10, 20), (50, 20), -4.0
    assert needed(stroke, stroke) == [True, True]  # each tells a move its triangles
    lower = (20, 20), (40, 20), -4.001
    assert needed(stroke, lower) == [True, True]


def test_below_the_blank_nothing_is_left_to_take():
    left, right = ((10, 19), (50, 19), -21.0), ((10, 21), (50, 21), -21.0)
    assert needed(left, right, ((20, 20), (40, 20), -30.0)) == [True, True, False]
    assert needed(((200, 20), (250, 20), -30.0)) == [False]  # beside the blank


def levels(depths_mm) -> np.ndarray:
    """A pocket cleared level by level, the walls with an allowance on all levels but the last."""
    path = []
    for depth in depths_mm:
        inset = 0.0 if depth == depths_mm[-1] else 0.4
        left, right, low, high = 12.0 + inset, 48.0 - inset, 12.0 + inset, 28.0 - inset
        for y in np.linspace(low, high, 5):
            path += [(left, y, -depth), (right, y, -depth), (left, y, -depth)]
        path += [(left, low, -depth), (right, low, -depth), (right, high, -depth)]
        path += [(left, high, -depth), (left, low, -depth)]
    return np.array(path)


@pytest.mark.parametrize("shape", ["flat", "ball", "bull"])
def test_the_part_is_the_same_without_them(shape, monkeypatch):
    options = {"corner_radius_mm": 1.5} if shape == "bull" else {}
    tool = make_tool(shape, diameter_mm=10.0, length_mm=40.0, **options)
    path = levels([2.0, 4.0, 6.0, 8.0, 8.5])
    rng = np.random.default_rng(5)
    sweeps = polyline(
        path,
        shift_mm=rng.uniform(-0.01, 0.01, path.shape),
        tilt_rad=rng.uniform(-2e-5, 2e-5, path.shape),
    )
    counts = []

    def counted(*arguments):
        counts.append(needed_strokes(*arguments))
        return counts[-1]

    monkeypatch.setattr("stock.solid.solid.needed_strokes", counted)
    found = cut_part(sweeps, [tool], BLOCK)
    monkeypatch.setattr("stock.solid.solid.needed_strokes", all_strokes)
    whole = cut_part(sweeps, [tool], BLOCK)
    assert (~counts[0]).sum() > len(counts[0]) / 10
    # the ends of paths are rounded by other corners of the same polygons: within the tolerance
    assert found.volume_mm3 == pytest.approx(whole.volume_mm3, abs=0.02)
    assert apart_mm3(found, whole) < 0.05


def all_strokes(footprints: Footprints, *_) -> np.ndarray:
    return np.ones(len(footprints.low_mm), dtype=bool)


def apart_mm3(a, b) -> float:
    one, other = (
        Manifold(Mesh64(np.array(p.vertices_mm, order="C"), p.triangles.astype(np.uint64)))
        for p in (a, b)
    )
    return (one - other).volume() + (other - one).volume()
