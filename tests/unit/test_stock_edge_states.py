"""States, touches and bad input of the engine."""

import numpy as np
import pytest

from stock import EdgeStatus, StockError, Sweeps, find_edges, make_tool
from stock.collision import find_collisions
from stock.collision.collision import follow
from stock.compile_ahead import compile_collisions, compile_walk
from stock.exact.tree import _fill_morton_codes
from stock.exact.walk import walk_part
from tests.oracle.stock_edge_cases import joined, polyline, sweeps_of

FLAT = make_tool("flat", diameter_mm=10.0, length_mm=30.0)
BALL = make_tool("ball", diameter_mm=10.0, length_mm=30.0)
UP, DOWN = [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]
BLANK = ([-20.0, -20.0, -10.0], [20.0, 20.0, 5.0])
CUT, UNCUT, GOUGED = EdgeStatus.CUT, EdgeStatus.UNCUT, EdgeStatus.GOUGED
SLOT = polyline([[-10.0, 0.0, 0.0], [10.0, 0.0, 0.0]])


def one(point, normal, sweeps=SLOT, *, tools=(FLAT,), blank=BLANK, reach=1.0):
    """Status, deviation and sweep at one point."""
    edges = find_edges(
        [point], [normal], sweeps=sweeps, tools=tools, blank_mm=blank, reach_mm=reach
    )
    return edges.status[0], edges.deviation_mm[0], edges.sweep[0]


@pytest.mark.parametrize(
    ("point", "normal", "status", "deviation"),
    [
        ([0.0, 0.0, 0.0], UP, CUT, 0.0),
        ([0.0, 0.0, -0.3], UP, CUT, 0.3),
        ([0.0, 0.0, 0.3], UP, CUT, -0.3),
        ([0.0, 5.0, 2.0], [0.0, -1.0, 0.0], CUT, 0.0),
        ([0.0, 0.0, -1.5], UP, UNCUT, 0.0),  # material beyond the reach
        ([0.0, 0.0, 1.5], UP, GOUGED, 0.0),  # air beyond the reach
        ([0.0, 15.0, 5.0], UP, UNCUT, 0.0),  # on the blank's top
        ([0.0, 15.0, 4.5], UP, UNCUT, 0.0),  # blank left above
        ([0.0, 15.0, 5.5], UP, UNCUT, 0.0),  # above the blank
        ([0.0, 15.0, 7.0], UP, GOUGED, 0.0),  # nothing there
        ([0.0, 15.0, -10.5], UP, GOUGED, 0.0),  # below the blank
        ([40.0, 0.0, 0.0], UP, GOUGED, 0.0),  # beside it
    ],
)
def test_states(point, normal, status, deviation):
    found = one(point, normal)
    assert found[0] == status
    assert found[1] == pytest.approx(deviation, abs=1e-12)
    assert (found[2] >= 0) == (status == CUT)


def test_through_the_blank_is_gouged():
    hole = sweeps_of([0.0, 0.0, 5.0], [0.0, 0.0, -10.0])
    assert one([0.0, 0.0, -9.9], UP, hole)[0] == GOUGED


def test_a_neighbour_that_only_touches_the_line_gouges_nothing():
    """The floor ends at a step: the line runs down along the deeper tool's side."""
    deep = joined(SLOT, polyline([[-10.0, 10.0, -8.0], [10.0, 10.0, -8.0]]))
    for y in (5.0 - 1e-12, 5.0):
        status, deviation, _ = one([0.0, y, 0.0], UP, deep)
        assert status == CUT
        assert deviation == pytest.approx(0.0, abs=1e-9)
    assert one([0.0, 5.0 + 1e-6, 0.0], UP, deep)[0] == GOUGED


def test_wall_point_at_the_level_of_the_floor():
    """The line runs along the flat bottom of the tool: a touch is air enough."""
    status, deviation, sweep = one([0.0, 5.0, 0.0], [0.0, -1.0, 0.0])
    assert (status, sweep) == (CUT, 0)
    assert deviation == pytest.approx(0.0, abs=1e-9)


def test_sweeps_that_meet_head_to_tail_leave_no_film():
    beside = joined(SLOT, polyline([[-10.0, 10.0, 0.0], [10.0, 10.0, 0.0]]))
    status, deviation, sweep = one([0.0, 5.5, 2.0], [0.0, 1.0, 0.0], beside, reach=20.0)
    assert (status, sweep) == (CUT, 0)
    assert deviation == pytest.approx(-10.5, abs=1e-9)


def test_coincident_moves_name_the_last():
    spring = joined(SLOT, SLOT, SLOT)
    for tool in (FLAT, BALL):
        for z in (0.0, 0.2, -0.2):
            assert one([1.0, 0.0, z], UP, spring, tools=[tool])[2] == 2
        assert one([1.0, 5.0, 5.0], [0.0, -1.0, 0.0], spring, tools=[tool])[2] == 2


def test_moves_of_no_length_and_plunges():
    for end in ([0.0, 0.0, 0.0], [0.0, 0.0, -1e-13]):
        dwell = sweeps_of([0.0, 0.0, 0.0], end)
        assert one([1.0, 1.0, -0.2], UP, dwell)[:2] == (CUT, pytest.approx(0.2, abs=1e-12))
        assert one([0.0, 5.2, 1.0], [0.0, -1.0, 0.0], dwell)[1] == pytest.approx(0.2, abs=1e-12)
    plunge = sweeps_of([0.0, 0.0, 5.0], [0.0, 0.0, -5.0])
    assert one([0.0, 5.0, 0.0], [0.0, -1.0, 0.0], plunge)[1] == pytest.approx(0.0, abs=1e-12)
    assert one([1.0, 2.0, -5.0], UP, plunge)[1] == pytest.approx(0.0, abs=1e-12)


def test_displaced_plunge_is_as_wide_as_its_widest_place():
    """Along a plunge the distance to a wall point is level: only the displacement tells."""
    wave = np.zeros((1, 2, 3)), np.zeros((1, 2, 3))
    wave[1][0, :, 1] = 0.01, 0.01  # out and in again: 0.01 (s - 3 s^2 + 2 s^3) upwards in y
    plunge = sweeps_of([0.0, 0.0, 4.0], [0.0, 0.0, -1.0], shift=wave)
    s = np.linspace(0.0, 1.0, 100_001)
    widest = 5.0 + (0.01 * (s - 3 * s**2 + 2 * s**3)).max()
    found = one([0.0, 5.0, 10.0], [0.0, -1.0, 0.0], plunge, blank=None)
    assert found[1] == pytest.approx(5.0 - widest, abs=1e-10)


def test_where_on_the_sweep_and_where_on_the_tool():
    edges = find_edges(
        [[2.5, 5.0, 4.0], [2.5, 3.0, 0.0]],
        [[0.0, -1.0, 0.0], UP],
        sweeps=SLOT,
        tools=[FLAT],
        blank_mm=BLANK,
    )
    assert edges.parameter[0] == pytest.approx(0.625, abs=1e-9)
    assert edges.contact_mm[0] == pytest.approx([0.0, 5.0, 4.0], abs=1e-9)
    assert edges.contact_mm[1, 1:] == pytest.approx([3.0, 0.0], abs=1e-9)
    assert not edges.deviation_mm.flags.writeable


def test_several_tools_are_told_apart():
    both = joined(polyline([[-10.0, 0.0, 0.0], [10.0, 0.0, 0.0]], tool=1), SLOT)
    assert one([0.0, 3.0, 0.0], UP, both, tools=[FLAT, BALL])[2] == 1
    assert one([0.0, 0.0, 0.0], UP, both, tools=[BALL, FLAT])[2] == 1


def test_no_points_and_no_sweeps():
    nothing = Sweeps(**{name: getattr(SLOT, name)[:0] for name in SLOT.__dataclass_fields__})
    assert (
        len(
            find_edges(np.zeros((0, 3)), np.zeros((0, 3)), sweeps=SLOT, tools=[FLAT], blank_mm=None)
        )
        == 0
    )
    assert one([0.0, 0.0, 0.0], UP, nothing)[0] == UNCUT
    assert one([0.0, 0.0, 0.0], UP, nothing, tools=[])[0] == UNCUT


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"points_mm": [[0.0, 0.0]]}, "(P, 3)"),
        ({"points_mm": [[0.0, 0.0, np.nan]]}, "not finite"),
        ({"normals": [[0.0, 0.0, 2.0]]}, "length 2"),
        ({"normals": [[0.0, 0.0, 0.0]]}, "length 0"),
        ({"reach_mm": 0.0}, "reach_mm = 0.0"),
        ({"reach_mm": np.inf}, "finite"),
        ({"blank_mm": ([0, 0, 0], [1, 1, -1])}, "first below the second"),
        ({"blank_mm": ([0, 0], [1, 1])}, "three finite numbers"),
        ({"tools": []}, "has tool 0"),
        ({"sweeps": sweeps_of([0, 0, 0], [1, 0, 0], tool=3)}, "has tool 3; accepted: 0 to 0"),
        (
            {"sweeps": sweeps_of([1, 0, 0], [0, 1, 0], arc=([0, 0, 0], [0, 0, 1], 1.0))},
            "misses its end",
        ),
        (
            {"sweeps": sweeps_of([1, 0, 0], [0, 1, 0], arc=([0, 0, 0], [0, 0, 2], np.pi / 2))},
            "no unit vector",
        ),
    ],
)
def test_bad_input_is_named(changes, said):
    arguments = {
        "points_mm": [[0.0, 0.0, 0.0]],
        "normals": [UP],
        "sweeps": SLOT,
        "tools": [FLAT],
        "blank_mm": BLANK,
        **changes,
    }
    with pytest.raises(StockError) as caught:
        find_edges(arguments.pop("points_mm"), arguments.pop("normals"), **arguments)
    assert said in str(caught.value)


def test_what_is_compiled_ahead_is_what_the_engine_uses():
    one([0.0, 0.0, 0.3], UP)
    used = list(walk_part.signatures)
    compile_walk()
    assert walk_part.signatures == used


def test_arrays_that_may_and_may_not_be_written_use_one_compiled_kernel():
    points, normals = np.array([[0.0, 0.0, 0.3]]), np.array([UP])
    for _ in range(2):
        find_edges(points, normals, sweeps=SLOT, tools=[FLAT], blank_mm=BLANK)
        points.setflags(write=False)
        normals.setflags(write=False)
    assert len(walk_part.signatures) == 1
    assert len(_fill_morton_codes.signatures) == 1


def test_collisions_compiled_ahead_are_those_that_are_looked_for():
    find_collisions(SLOT, [FLAT], BLANK)
    used = list(follow.signatures)
    compile_collisions()
    assert follow.signatures == used
