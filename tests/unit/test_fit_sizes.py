"""The prior of sizes: its slope and information against differences, and what a limit does."""

import numpy as np
import pytest

from vmach.fit.sizes import USUAL_SIZE, Sizes

LIMITS = np.array([np.inf, 1.5, np.inf])
#: usual sizes; of the last any is as likely
USUAL = np.array([USUAL_SIZE, USUAL_SIZE, np.inf])


@pytest.mark.parametrize("limits", [LIMITS, np.full(3, np.inf)])
def test_slope_and_information_are_those_of_differences(limits):
    at, step = Sizes(1.4, (0.3, 4.0, 2.0)), 1e-5

    def moved(k, way):
        return Sizes.at(at.logarithms + way * step * np.eye(4)[k])

    slope = [
        (moved(k, 1.0).log_prior(USUAL, limits) - moved(k, -1.0).log_prior(USUAL, limits))
        / (2 * step)
        for k in range(4)
    ]
    information = [
        (moved(k, -1.0).slope_of_prior(USUAL, limits) - moved(k, 1.0).slope_of_prior(USUAL, limits))
        / (2 * step)
        for k in range(4)
    ]
    np.testing.assert_allclose(at.slope_of_prior(USUAL, limits), slope, rtol=1e-6)
    np.testing.assert_allclose(
        at.information_of_prior(USUAL, limits), information, rtol=1e-6, atol=1e-8
    )


def test_beyond_its_limit_a_size_falls_off_as_a_normal_one():
    """Of two sizes the ratio of densities is the tail's, times that of a normal distribution."""
    free = np.full(1, np.inf)

    def more(limits):
        here, there = (Sizes(2.0, (size,)) for size in (12.0, 6.0))
        return here.log_prior(USUAL[:1], limits) - there.log_prior(USUAL[:1], limits)

    # two and four times the limit of 1.5 uncertainties that are twice as large as stated
    assert more(np.array([1.5])) - more(free) == pytest.approx(-(4.0**2 - 2.0**2) / 2)


def test_of_a_member_without_a_usual_size_any_size_is_as_likely():
    free = np.full(1, np.inf)
    small, large = (Sizes(1.0, (size,)).log_prior(free, free) for size in (0.5, 500.0))
    assert small == large
