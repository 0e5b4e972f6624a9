"""Tools: what each shape is made of, and what is refused."""

import math

import pytest

from stock import TOOL_SHAPES, Corner, StockError, make_tool

SIZE = {"diameter_mm": 10.0, "length_mm": 30.0}


def test_corners_of_each_shape():
    top = Corner(5.0, 30.0)
    assert make_tool("flat", **SIZE).corners == (Corner(5.0, 0.0), top)
    assert make_tool("ball", **SIZE).corners == (Corner(0.0, 5.0, 5.0), top)
    bull = make_tool("bull", **SIZE, corner_radius_mm=1.0)
    assert bull.corners == (Corner(4.0, 1.0, 1.0), top)
    chamfer = make_tool("chamfer", **SIZE, tip_diameter_mm=2.0)
    assert chamfer.corners[0] == Corner(1.0, 0.0)
    assert chamfer.corners[1].z_mm == pytest.approx(4.0)
    drill = make_tool("drill", **SIZE)
    assert drill.corners[1].z_mm == pytest.approx(5.0 / math.tan(math.radians(59.0)))
    profile = make_tool("profile", points_mm=[(0, 2), (3, 2), (5, 6), (5, 12), (0, 12)])
    assert profile.corners == (Corner(0, 0), Corner(3, 0), Corner(5, 4), Corner(5, 10))
    assert (profile.diameter_mm, profile.length_mm) == (10.0, 10.0)


def test_flutes_bound_the_cutting_part():
    assert make_tool("flat", **SIZE, flute_length_mm=12.0).length_mm == 12.0
    short = make_tool("chamfer", **SIZE, flute_length_mm=2.0)  # ends on its cone
    assert len(short.corners) == 2
    assert short.diameter_mm == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("shape", "dimensions", "said"),
    [
        ("ballnose", SIZE, "flat, ball, bull"),
        ("flat", {"diameter_mm": 10.0}, "lacks length_mm"),
        ("flat", {**SIZE, "corner_radius_mm": 1.0}, "unknown dimension corner_radius_mm"),
        ("flat", {**SIZE, "diameter_mm": 0.0}, "diameter_mm = 0.0; accepted: a finite number and"),
        ("flat", {**SIZE, "diameter_mm": -3.0}, "> 0"),
        ("flat", {**SIZE, "diameter_mm": math.nan}, "finite"),
        ("flat", {**SIZE, "diameter_mm": "10"}, "finite"),
        ("flat", {**SIZE, "flute_length_mm": 31.0}, "<= 30"),
        ("ball", {**SIZE, "length_mm": 4.0}, ">= 5"),
        ("bull", SIZE, "lacks corner_radius_mm"),
        ("bull", {**SIZE, "corner_radius_mm": 5.5}, "<= 5"),
        ("bull", {**SIZE, "corner_radius_mm": -1.0}, ">= 0"),
        ("chamfer", {**SIZE, "tip_diameter_mm": 10.0}, "< 10"),
        ("drill", {**SIZE, "angle_deg": 180.0}, "< 180"),
        ("profile", {"points_mm": [(5, 0), (2, 4), (5, 8)]}, "not convex at r = 2 mm"),
        ("profile", {"points_mm": [(0, 0), (0, 8)]}, "encloses no volume"),
        ("profile", {"points_mm": [(-1, 0), (2, 8)]}, ">= 0"),
        ("profile", {"points_mm": [(1, 0, 3), (2, 8)]}, "(r, z)"),
    ],
)
def test_impossible_tools_are_refused(shape, dimensions, said):
    with pytest.raises(StockError) as caught:
        make_tool(shape, **dimensions)
    assert said in str(caught.value)


def test_every_shape_is_in_the_table():
    assert list(TOOL_SHAPES) == ["flat", "ball", "bull", "chamfer", "drill", "profile"]
