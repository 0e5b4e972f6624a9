"""Positions, tangents and direction memory along moves, against closed forms."""

import numpy as np
import pytest

from gcode import MoveKind, Moves
from vmach.path.geometry import last_direction, move_length_mm, position_at, tangent_at
from vmach.path.toolpath import PathStates, Toolpath


def make_moves(*rows):
    """Moves from dicts; what a row leaves out is zero, the clock runs at 10 mm/s."""
    count = len(rows)
    shapes = {"start_mm": 3, "end_mm": 3, "centre_mm": 3, "axis": 3, "tool_offset_mm": 3}
    shapes |= {"rotary_start_deg": 3, "rotary_end_deg": 3}
    scalars = "kind line sweep_rad feed_mm_per_min spindle_rpm tool work_offset exact_stop"
    columns = {name: np.zeros((count, size)) for name, size in shapes.items()}
    columns |= {name: np.zeros(count) for name in scalars.split()}
    columns |= {"start_s": np.arange(count) * 1.0, "duration_s": np.ones(count)}
    columns["tool"][:] = 1
    columns["line"][:] = np.arange(count) + 1
    for number, row in enumerate(rows):
        for name, value in row.items():
            columns[name][number] = value
    return Moves(**columns)


LINE = {"kind": MoveKind.LINE, "start_mm": (0, 0, 0), "end_mm": (30, 40, 0)}
# three quarters of a circle of radius 20 about (10, 0), counter-clockwise from (30, 0), rising 6
HELIX = {
    "kind": MoveKind.ARC,
    "start_mm": (30, 0, 1),
    "end_mm": (10, -20, 7),
    "centre_mm": (10, 0, 1),
    "axis": (0, 0, 1),
    "sweep_rad": 1.5 * np.pi,
}
SPIRAL = HELIX | {"end_mm": (10, -30, 1)}  # the radius grows from 20 to 30


def test_length_of_line_and_helix():
    moves = make_moves(LINE, HELIX)
    assert move_length_mm(moves) == pytest.approx([50, np.hypot(30 * np.pi, 6)], abs=1e-12)


def test_length_of_spiral_within_its_own_bounds():
    (length,) = move_length_mm(make_moves(SPIRAL))
    s = np.linspace(0, 1, 20001)
    path = position_at(make_moves(SPIRAL), np.zeros(len(s), int), s)
    assert length == pytest.approx(np.linalg.norm(np.diff(path, axis=0), axis=1).sum(), rel=1e-3)


def test_positions_on_helix():
    moves = make_moves(HELIX)
    s = np.array([0, 1 / 3, 2 / 3, 1])
    expected = [(30, 0, 1), (10, 20, 3), (-10, 0, 5), (10, -20, 7)]
    assert position_at(moves, np.zeros(4, int), s) == pytest.approx(np.array(expected), abs=1e-12)


def test_arc_about_another_axis_turns_right_handed():
    arc = {"kind": MoveKind.ARC, "start_mm": (0, 5, 0), "end_mm": (0, 0, 5), "axis": (1, 0, 0)}
    moves = make_moves(arc | {"sweep_rad": np.pi / 2})
    (middle,) = position_at(moves, np.array([0]), np.array([0.5]))
    assert middle == pytest.approx([0, 5 * np.sqrt(0.5), 5 * np.sqrt(0.5)], abs=1e-12)


@pytest.mark.parametrize("move", [LINE, HELIX, SPIRAL])
def test_tangent_is_the_derivative_of_the_position(move):
    moves, zero = make_moves(move), np.zeros(9, int)
    s, step = np.linspace(0.05, 0.95, 9), 1e-6
    slope = (position_at(moves, zero, s + step) - position_at(moves, zero, s - step)) / (2 * step)
    assert tangent_at(moves, zero, s) == pytest.approx(slope, abs=1e-6)


def test_direction_is_remembered_while_an_axis_stands():
    moves = make_moves(
        {"kind": MoveKind.LINE, "end_mm": (5, 0, 0)},
        {"kind": MoveKind.LINE, "start_mm": (5, 0, 0), "end_mm": (5, -3, 0)},
        {"kind": MoveKind.DWELL, "start_mm": (5, -3, 0), "end_mm": (5, -3, 0)},
        {"kind": MoveKind.LINE, "start_mm": (5, -3, 0), "end_mm": (4, -3, 0)},
    )
    signs = last_direction(moves, np.arange(4), np.full(4, 0.5))
    assert signs.tolist() == [[1, 0, 0], [1, -1, 0], [1, -1, 0], [-1, -1, 0]]


def test_direction_flips_at_the_quadrants_of_a_circle():
    moves = make_moves(HELIX)
    s = np.array([0.1, 0.5, 0.9])  # angles 27, 135, 243 degrees
    signs = last_direction(moves, np.zeros(3, int), s)
    assert signs[:, :2].tolist() == [[-1, 1], [-1, -1], [1, -1]]


def test_direction_at_the_end_of_an_arc_that_stops_at_a_quadrant():
    quarter = HELIX | {"end_mm": (10, 20, 1), "sweep_rad": np.pi / 2}
    after = {"kind": MoveKind.LINE, "start_mm": (10, 20, 1), "end_mm": (0, 20, 1)}
    signs = last_direction(make_moves(quarter, after), np.array([1]), np.array([0.5]))
    assert signs.tolist() == [[-1, 1, 0]]


def test_pieces_are_no_longer_than_the_spacing_and_meet():
    moves = make_moves(LINE, HELIX, {"kind": MoveKind.DWELL})
    path = Toolpath.split(moves, np.array([np.nan, 100.0]), spacing_mm=5.0)
    nose, first = path.nodes.nose_mm, path.first_node
    assert np.linalg.norm(nose[first + 1] - nose[first], axis=1).max() <= 5.0
    assert len(first) == 10 + 19  # 50 mm and 94.44 mm
    same = path.piece_move[1:] == path.piece_move[:-1]
    assert np.array_equal(first[1:][same], first[:-1][same] + 1)


def test_states_on_pieces_lie_on_the_move():
    path = Toolpath.split(make_moves(HELIX), np.array([np.nan, 100.0]))
    piece, s = np.array([0, 7, 18]), np.array([0.0, 0.25, 1.0])
    states = path.states_on_pieces(piece, s, contact_mm=np.zeros((3, 3)))
    expected = position_at(path.nodes.moves, np.zeros(3, int), (piece + s) / 19)
    assert states.nose_mm == pytest.approx(expected, abs=1e-12)
    assert states.tool_mm.tolist() == [[0, 0, -100]] * 3


def test_the_nose_rests_at_both_ends_of_a_rapid_and_moves_on_through_a_feed():
    """What stays in contact where a cut ends and the tool is lifted off is seen at rest."""
    lift = {"kind": MoveKind.RAPID, "start_mm": (30, 40, 0), "end_mm": (30, 40, 10)}
    moves = make_moves(LINE, lift)
    for move, parameter, expected in [
        (0, 1.0, [30, 40, 0]),
        (1, 0.0, [0, 0, 0]),
        (1, 0.5, [0, 0, 10]),
        (1, 1.0, [0, 0, 0]),
    ]:
        at = np.array([move]), np.array([parameter])
        states = PathStates(moves, np.array([np.nan, 100.0]), *at, np.zeros((1, 3)))
        assert states.velocity_mm_per_s.tolist() == [expected]
