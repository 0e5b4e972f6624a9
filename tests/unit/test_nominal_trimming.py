"""Rows of points on trimmed surfaces."""

from types import SimpleNamespace

import numpy as np
import pytest

from vmach.nominal.surfaces.trimming import Trim

TURN = 2.0 * np.pi


def test_a_row_along_an_edge_of_a_torus_stays_inside_the_face():
    low, high, e = 2.0, 4.0, 1e-12  # e: as far as projection rounds
    bottom = np.array([[1.0, low - e], [1.4, low + e], [1.8, low - e]])
    sides = np.array([[[1.8, low + e], [1.8, high]], [[1.0, high], [1.0, low + e]]])
    top = np.array([[[1.8, high], [1.0, high]]])
    segments = np.vstack([np.stack([bottom[:-1], bottom[1:]], axis=1), sides, top])
    torus = SimpleNamespace(u_period=TURN, v_period=TURN)
    trim = Trim(torus, np.zeros((len(segments), 2, 3)), segments)
    for begin, end in trim.row_intervals(np.array([low]))[1]:
        assert 1.0 - 1e-9 < begin < end < 1.8 + 1e-9


@pytest.mark.parametrize("first", range(4))
@pytest.mark.parametrize("rounding", [0.0, 1e-26, -1e-26, 1e-13, -1e-13])
def test_lines_through_vertices_that_differ_by_rounding(first, rounding):
    """A diamond with a square hole: rows and columns through its corners, each stated twice."""
    corners = np.array([[4.0, 0.0], [0.0, 4.0], [-4.0, 0.0], [0.0, -4.0]])
    hole = np.array([[1.0, 0.0], [0.0, -1.0], [-1.0, 0.0], [0.0, 1.0]])
    loops = [np.stack([np.roll(loop, -first, 0), np.roll(loop, -first - 1, 0)], 1)
             for loop in (corners, hole)]  # fmt: skip
    segments = np.vstack(loops)
    segments[:, 1] += np.where(segments[:, 1] == 0.0, rounding, 0.0)
    plane = SimpleNamespace(u_period=0.0, v_period=0.0, v_limits=(-np.inf, np.inf))
    trim = Trim(plane, np.zeros((len(segments), 2, 3)), segments)
    for one in (trim, trim.transposed()):
        assert one.v_range() == pytest.approx((-4.0, 4.0))
        assert np.isfinite(one.grid(5, 5)).all()
        row, ends = one.row_intervals(np.array([-2.0, 0.0, 2.0]))
        assert row.tolist() == [0, 1, 1, 2]
        widths = ends[:, 1] - ends[:, 0]
        assert widths == pytest.approx([4.0, 3.0, 3.0, 4.0], abs=1e-6)
        places = np.array([[-2.0, 0.0], [0.1, 0.0], [2.0, 0.0], [5.0, 0.0], [-5.0, 0.0]])
        assert one.contains(places).tolist() == [True, False, True, False, False]


@pytest.mark.parametrize("rounding", [0.0, 1e-26, -1e-26, 1e-13, -1e-13])
def test_points_level_with_vertices_that_differ_by_rounding(rounding):
    """A diamond of many short edges, looked up in bands of v whose borders are its vertices."""
    side = np.linspace(0.0, 4.0, 65)[:-1]
    loop = np.vstack([np.stack(s, 1) for s in
                      ((4.0 - side, side), (-side, 4.0 - side), (side - 4.0, -side),
                       (side, side - 4.0))])  # fmt: skip
    segments = np.stack([loop, np.roll(loop, -1, axis=0)], axis=1)
    segments[:, 1, 1] += rounding
    plane = SimpleNamespace(u_period=0.0, v_period=0.0, v_limits=(-np.inf, np.inf))
    trim = Trim(plane, np.zeros((len(segments), 2, 3)), segments)
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(-4.5, 4.5, 37), np.linspace(-4, 4, 129)))
    clear = np.abs(np.abs(u) + np.abs(v) - 4.0) > 1e-3
    inside = np.abs(u) + np.abs(v) < 4.0
    assert (trim.contains(np.column_stack([u, v]))[clear] == inside[clear]).all()
