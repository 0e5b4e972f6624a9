"""Shifts between their knots, against circles through shifted points."""

import numpy as np
import pytest

from gcode import read_program
from vmach.compensation.aim.path_shift import no_shift
from vmach.compensation.aim.shift_fit import centred
from vmach.compensation.aim.surface_demand import SurfaceDemand
from vmach.compensation.pieces.plan import Plan
from vmach.path.geometry import position_at
from vmach.program_text.blocks.pieces import Piece, Pieces, circle_through

PROGRAM = "G21 G90 G17\nG0 X10 Y0 Z5\nG1 Z0 F500\nG3 X0 Y10 I-10 J0\nG1 X-20\nM30\n"
RAPID, PLUNGE, ARC, LINE = range(4)


@pytest.fixture
def moves(tmp_path):
    path = tmp_path / "part.nc"
    path.write_text(PROGRAM)
    return read_program(path).moves


def knots(moves):
    pieces = Pieces.of(Piece(k, 0.0, 1.0, is_arc=k == ARC) for k in range(len(moves)))
    return no_shift(moves, Plan(pieces, np.zeros((len(pieces), 3))), np.ones((len(moves), 3), bool))


def test_moves_that_meet_share_their_knots(moves):
    shift = knots(moves)
    assert (shift.knot[:-1, 2] == shift.knot[1:, 0]).all()
    assert (shift.knot[ARC] >= 0).all()
    assert shift.knot[RAPID, 0] == shift.knot[RAPID, 2], "it is taken to start where it ends"
    assert shift.free.all()


def test_arcs_go_through_their_shifted_points(moves):
    shift = knots(moves)
    rng = np.random.default_rng(7)
    shift = shift.with_values(1e-4 * rng.standard_normal(shift.value_mm.shape))
    share = np.linspace(0.0, 1.0, 21)
    move = np.full(len(share), ARC)
    place = position_at(moves, move, share) + shift.at(move, share)
    ends = place[[0, 10, 20], :2]
    centre = circle_through(*ends)
    radius = np.linalg.norm(place[:, :2] - centre, axis=1)
    # first order in the shift: what is left goes with its square over the radius
    np.testing.assert_allclose(radius, radius[0], atol=1e-8)
    np.testing.assert_allclose(place[:, 2], place[0, 2] + share * (place[-1, 2] - place[0, 2]))
    for knot, at in zip(shift.knot[ARC], (0.0, 0.5, 1.0), strict=True):
        here = shift.at(np.array([ARC]), np.array([at]))[0]
        if at != 0.5:  # the middle counts across the arc only
            np.testing.assert_allclose(here, shift.value_mm[knot], atol=1e-18)


def test_lines_go_straight_between_shifted_ends(moves):
    shift = knots(moves)
    shift = shift.with_values(np.arange(shift.value_mm.size).reshape(-1, 3).astype(float))
    first, _, last = shift.value_mm[shift.knot[LINE]]
    found = shift.at(np.array([LINE, LINE]), np.array([0.25, 1.0]))
    np.testing.assert_allclose(found, [0.75 * first + 0.25 * last, last])


def test_the_middle_of_what_a_wall_asks_for_is_found(moves):
    # points along the line, most of them near the floor, ask for 0 to 10 um by their height
    height = np.linspace(0.0, 1.0, 40) ** 3
    share = np.tile(np.linspace(0.02, 0.98, 30), len(height))
    asked = np.repeat(1e-2 * height, 30)
    rows = np.arange(len(share))
    normal = np.tile([0.0, 1.0, 0.0], (len(share), 1))
    demand = SurfaceDemand(rows, np.full(len(share), LINE), share, normal, asked)
    shift = centred(knots(moves), demand)
    np.testing.assert_allclose(shift.at(demand.move, share)[:, 1], 5e-3, rtol=0.02)
