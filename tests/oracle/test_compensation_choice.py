"""The best sequence of grid points, against every sequence there is."""

from itertools import pairwise, product

import numpy as np
import pytest

from tests.oracle.compensation_choice import best_sequence
from vmach.compensation.grid.choice import Course, Points

ENDS, TRIES, PROBES, LARGE = 4, 4, 3, 16.0


def random_case(seed):
    """Pieces that begin where their moves do, with some probes each; many costs are alike."""
    random = np.random.default_rng(seed)
    count = ENDS * PROBES
    parameter = np.sort(random.uniform(size=(ENDS, PROBES)), axis=1).ravel()
    weight = random.integers(0, 2, count).astype(float)
    course = Course(
        normal=random.normal(size=(count, 3)), base=random.normal(size=count), weight=weight,
        parameter=parameter, only_below=random.uniform(size=count) < 0.2,
        begin=np.arange(ENDS) * PROBES, start=np.zeros(ENDS), stays=np.full(ENDS, 0.02),
        still=np.zeros((ENDS, 3)), large=LARGE,
    )  # fmt: skip
    bound = np.repeat((np.arange(ENDS) + 1) * PROBES, TRIES).reshape(ENDS, TRIES)
    place = random.integers(-1, 2, (ENDS, TRIES, 3)).astype(float)
    points = Points(np.ones((ENDS, TRIES)), bound, place, place, place, place)
    first = [np.zeros_like(a[:1, :1]) for a in points]
    return course, Points(*first), points


def cost(course, points, chosen):
    """The sum over the probes and ends of x^2 + 16 x^8, written out once more."""
    place = np.vstack([np.zeros(3), points.at_end[np.arange(ENDS), chosen]])
    total = 0.0
    for k, (start, end) in enumerate(pairwise(place)):
        rows = slice(k * PROBES, (k + 1) * PROBES)
        share = course.parameter[rows][:, None]
        there = start + share * (end - start)
        x = course.base[rows] + np.einsum("pi,pi->p", course.normal[rows], there)
        x = np.where(course.only_below[rows], np.minimum(x, 0.0), x)
        total += course.weight[rows] @ (x**2 + LARGE * x**8) + 0.02 * end @ end
    return total


@pytest.mark.parametrize("seed", range(12))
def test_no_sequence_costs_less(seed):
    course, exact, points = random_case(seed)
    least = min(cost(course, points, chosen) for chosen in product(range(TRIES), repeat=ENDS))
    found = best_sequence(course, exact, points)
    assert cost(course, points, found) == pytest.approx(least, rel=1e-12)
