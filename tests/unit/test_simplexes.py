"""Simplexes that move together end where those of scipy do, each by itself."""

import numpy as np
import pytest
from scipy.optimize import minimize

from vmach.diagnosis.proposals.simplexes import lowest_near

SIMPLEX = np.vstack([np.zeros(2), 0.5 * np.eye(2)])


def valleys(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Bent valleys of several steepnesses, with their lowest points."""
    random = np.random.default_rng(4)
    return random.uniform(1.0, 30.0, count), random.uniform(-1.5, 1.5, (count, 2))


def cost_of(steep: np.ndarray, lowest: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Of points (M, 2) in M valleys."""
    x, y = (points - lowest).T
    return x**2 + steep * (y - x**2) ** 2


@pytest.mark.parametrize("most", [12, 40, 200])
def test_each_goes_the_way_of_a_simplex_of_its_own(most):
    steep, lowest = valleys(9)
    asked = np.zeros(9, dtype=int)

    def cost(points, which):
        np.add.at(asked, which, 1)
        return cost_of(steep[which], lowest[which], points)

    found = lowest_near(cost, SIMPLEX, 9, near=0.02, most=most)
    assert asked.max() <= most
    for k, point in enumerate(found):
        alone = minimize(
            lambda x, k=k: cost_of(steep[k], lowest[k], x[None])[0],
            np.zeros(2),
            method="Nelder-Mead",
            options={"maxfev": most, "initial_simplex": SIMPLEX, "xatol": 0.02},
        )
        np.testing.assert_allclose(point, alone.x, atol=1e-12)
        assert asked[k] == alone.nfev
