"""The kernel that looks for the floors that a stroke reaches stays within the blank's cells."""

import numpy as np

from stock.solid import buried_strokes


def test_a_stroke_beyond_the_last_row_reads_no_cell_behind_it(monkeypatch):
    _reaches_floor = buried_strokes._reaches_floor
    depth = np.zeros((4, 3))
    depth[3] = -5.0
    grid = np.array([0.0, 0.0, 1.0, -9.0])
    start, end = np.array([[0.5, 3.5]]), np.array([[2.5, 3.5]])
    radius, low = np.array([0.4]), np.array([-5.0])
    compiled = _reaches_floor(depth, grid, start, end, radius, low)
    for name in ("_rows", "_chord"):  # what only kernels call has no way in from Python
        monkeypatch.setattr(buried_strokes, name, getattr(buried_strokes, name).py_func)
    # in plain Python an index beyond the last row raises
    assert _reaches_floor.py_func(depth, grid, start, end, radius, low).tolist() == [True]
    assert compiled.tolist() == [True]
    above = np.array([-4.0])
    assert _reaches_floor.py_func(depth, grid, start, end, radius, above).tolist() == [False]
