"""Modes of lines as columns say what a dictionary of the same lines would."""

import numpy as np
import pytest

from vmach.program_text.blocks.line_modes import BlockModes, LineModes


def modes_of(unit_mm=1.0, *, left=False):
    return BlockModes(unit_mm, False, False, left, False, 1)


def test_lines_and_columns():
    found = LineModes(np.array([2, 3, 7, 9]))
    found.put(slice(0, 2), modes_of())
    found.put(2, modes_of(25.4, left=True))
    assert list(found) == [2, 3, 7]
    assert len(found) == 3
    assert found[7] == modes_of(25.4, left=True)
    assert 9 not in found
    assert 4 not in found
    with pytest.raises(KeyError):
        found[9]
    line = np.array([9, 7, 2, 1, 100])
    assert found.column("unit_mm", line, 0.5).tolist() == [0.5, 25.4, 1.0, 0.5, 0.5]
    assert found.left_lines().tolist() == [7]


def test_a_program_without_moves():
    found = LineModes(np.zeros(0, np.int64))
    assert found.column("plane", np.array([1]), 1).tolist() == [1]
    assert not found
    assert found.left_lines().size == 0
