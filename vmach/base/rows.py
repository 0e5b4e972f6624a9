"""Arrays with some rows replaced."""

from __future__ import annotations

import numpy as np

__all__ = ["with_rows"]


def with_rows(values: np.ndarray, rows: np.ndarray, new: np.ndarray | int) -> np.ndarray:
    """A copy of an array whose `rows`, indices or a mask, hold new values."""
    values = values.copy()
    values[rows] = new
    return values
