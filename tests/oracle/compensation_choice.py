"""The best sequence of grid points, in one go."""

import numpy as np

from vmach.compensation.grid.choice import advance, traced_back

__all__ = ["best_sequence"]


def best_sequence(course, exact, points):
    """Point of every end, (K,), so that the sum of costs along the path is smallest.

    Of equals the first counts.
    """
    came_from = np.zeros(points.parameter.shape, np.int8)
    total = advance(course, exact, points, 0, np.zeros(came_from.shape[1]), came_from)
    return traced_back(total, came_from)
