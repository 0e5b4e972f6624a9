"""Numbers written by compiled code are those of Python's ``repr``, to the character."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numba import njit

from gcode.writing.shortest_decimal import WIDEST, write_float, write_whole


@njit
def _write(values, wholes, text, ends):
    at = 0
    for k in range(values.shape[0]):
        at = write_float(text, at, values[k])
        ends[k, 0] = at
        at = write_whole(text, at, wholes[k])
        ends[k, 1] = at
    return at


def written(values, wholes=None):
    """Text of every float, and of every whole number."""
    values = np.asarray(values, np.float64)
    wholes = np.zeros(len(values), np.int64) if wholes is None else np.asarray(wholes, np.int64)
    text = np.empty(2 * WIDEST * len(values), np.uint8)
    ends = np.empty((len(values), 2), np.int64)
    line = text[: _write(values, wholes, text, ends)].tobytes().decode()
    cuts = [0, *ends.ravel().tolist()]
    pieces = [line[a:b] for a, b in pairwise(cuts)]
    return pieces[::2], pieces[1::2]


@settings(max_examples=200, deadline=None)
@given(st.lists(st.floats(), min_size=1), st.integers(-(2**63) + 1, 2**63 - 1))
@example([9007199254740993.0, 5e-324, 1.7976931348623157e308, 2.0**-1074, 1e23, -0.0], 0)
def test_any_number(values, whole):
    floats, wholes = written(values, [whole] * len(values))
    assert floats == [repr(v) for v in values]
    assert set(wholes) == {str(whole)}


@pytest.mark.parametrize("values", [
    np.random.default_rng(1).integers(0, 2**64, 200_000, dtype=np.uint64).view(np.float64),
    np.random.default_rng(2).integers(-(10**9), 10**9, 50_000) / 1e4,
    np.random.default_rng(3).integers(-(10**9), 10**9, 50_000) / 1e4 * 25.4,
    np.random.default_rng(4).integers(0, 2**60, 50_000).astype(np.float64),
    2.0 ** np.arange(-1074, 1024),
    np.nextafter(2.0 ** np.arange(-1074, 1024), 0.0),
    np.array([float(f"1e{k}") for k in range(-323, 309)]),
    np.nextafter([float(f"1e{k}") for k in range(-323, 309)], np.inf),
], ids=["bits", "program", "inch", "whole", "two", "below-two", "ten", "above-ten"])  # fmt: skip
def test_many_numbers(values):
    assert written(values)[0] == [repr(v) for v in values.tolist()]
