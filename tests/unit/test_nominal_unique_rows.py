"""Equal rows, against NumPy's own way to find them."""

import numpy as np
import pytest

from vmach.nominal.mesh.unique_rows import unique_rows


@pytest.mark.parametrize("shape", [(0, 3), (1, 2), (500, 1), (500, 3)])
def test_equal_rows_are_found_in_order(shape):
    rows = np.random.default_rng(5).integers(-2, 3, shape) / 3.0
    rows[::7] *= -1.0  # -0.0 is 0.0
    distinct, first, which, count = np.unique(
        rows, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    found = unique_rows(rows)
    np.testing.assert_array_equal(rows[found[0]], distinct)
    for own, truth in zip(found, (first, which.reshape(-1), count), strict=True):
        np.testing.assert_array_equal(own, truth)
