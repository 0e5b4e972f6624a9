"""Rows of points on trimmed surfaces."""

from types import SimpleNamespace

import numpy as np

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
