"""Floors that a ball leaves, against OpenCAMLib, which drops cutters on triangles."""

import numpy as np
import pytest

from stock import EdgeStatus, find_edges, make_tool
from tests.opencamlib_heights import heights_left
from tests.oracle.stock_edge_cases import polyline

pytest.importorskip("opencamlib", reason="OpenCAMLib has wheels for Python 3.11 and older")


@pytest.mark.parametrize("seed", range(3))
def test_a_ball_leaves_the_floor_that_opencamlib_finds(seed):
    random = np.random.default_rng(seed)
    path = random.uniform([-20, -20, -3], [20, 20, -1], (60, 3))
    place = random.uniform(-20, 20, (500, 2))
    wanted = heights_left(path, place, 6.0)
    points = np.column_stack([place, np.full(len(place), -3.0)])
    found = find_edges(
        points,
        np.tile([0.0, 0.0, 1.0], (len(points), 1)),
        sweeps=polyline(path),
        tools=[make_tool("ball", diameter_mm=6, length_mm=50)],
        blank_mm=([-30, -30, -9], [30, 30, 0]),
        reach_mm=5.0,
    )
    is_cut = found.status == EdgeStatus.CUT
    np.testing.assert_array_equal(is_cut, wanted < 0.0)
    assert is_cut.sum() > 300
    height = points[:, 2] + found.deviation_mm
    np.testing.assert_allclose(height[is_cut], wanted[is_cut], rtol=0, atol=1e-9)
