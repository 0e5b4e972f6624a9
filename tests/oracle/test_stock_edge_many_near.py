"""Edges in the midst of very many short moves that are near and hold nothing, in closed form."""

import numpy as np
import pytest

from stock import EdgeStatus, find_edges, make_tool
from tests.oracle.stock_edge_cases import joined
from tests.stock_solid_cases import polyline

BALL = make_tool("ball", diameter_mm=4.0, length_mm=40.0)
FLAT = make_tool("flat", diameter_mm=10.0, length_mm=40.0)
BLOCK = ((-50.0, -50.0, -20.0), (50.0, 50.0, 0.0))
REACH_MM = 3.0
#: lines at z = -4, by where they begin and go, and how far the edge is
CASES = {
    "air all along": ((0.0, 4.0, -4.0), (0.0, 1.0, 0.0), EdgeStatus.GOUGED, 0.0),
    "inwards to the wall": ((0.0, -3.0, -4.0), (0.0, 1.0, 0.0), EdgeStatus.CUT, -2.0),
    "outwards to the wall": ((0.0, 7.5, -4.0), (0.0, -1.0, 0.0), EdgeStatus.CUT, 2.5),
    "material all along": ((0.0, 7.5, -4.0), (0.0, 1.0, 0.0), EdgeStatus.UNCUT, 0.0),
    "inwards to the floor": ((0.0, 0.0, -4.0), (0.0, 0.0, 1.0), EdgeStatus.CUT, -1.0),
}


@pytest.fixture(scope="module")
def sweeps():
    """A slot along X, 10 mm wide and 5 deep, and over it a ball in 11,000 moves, 2 mm deep."""
    x = np.arange(-30.0, 30.0, 0.1)
    rows = [np.column_stack([x[:: (-1) ** k], np.full_like(x, y), np.full_like(x, -2.0)])
            for k, y in enumerate(np.arange(-9.0, 9.5, 1.0))]  # fmt: skip
    return joined(polyline(np.vstack(rows)), polyline([(-30, 0, -5), (30, 0, -5)], tool=1))


@pytest.mark.parametrize("case", CASES)
def test_moves_that_are_near_change_nothing(sweeps, case):
    point, normal, status, deviation_mm = CASES[case]
    found = find_edges([point], [normal], sweeps=sweeps, tools=[BALL, FLAT], blank_mm=BLOCK,
                       reach_mm=REACH_MM)  # fmt: skip
    assert found.status[0] == status
    assert found.deviation_mm[0] == pytest.approx(deviation_mm, abs=1e-9)
