"""Rows that are alike: what depends on them alone is worked out once."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

__all__ = ["alike_rows"]


def alike_rows(values: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The first of each kind of row, in order, and which kind each row is of, (m,) and (n,) int.

    Parameters
    ----------
    values : sequence of (n, ...) array
        Rows are alike where they have the same bits in all of them.
    """
    flat = [np.ascontiguousarray(v).reshape(len(v), math.prod(v.shape[1:])) for v in values]
    bits = [v.view(np.uint8) for v in flat]
    rows = np.ascontiguousarray(np.hstack(bits))
    whole = rows.view(np.dtype((np.void, rows.shape[1])))[:, 0]
    _, first, of = np.unique(whole, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return first[order], np.argsort(order)[of]
