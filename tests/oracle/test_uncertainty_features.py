"""Draws of corrections through features: closed forms of distributions that are not normal."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from tests.feature_part import DATUMS, FEATURES, ROWS, part
from vmach.features.drawing.callout import read_callout
from vmach.features.evaluation import Drawing, Requirement, evaluate
from vmach.features.feature import Points, make_feature
from vmach.features.surface import Surface
from vmach.uncertainty.corrections import Part
from vmach.uncertainty.features import draw_features
from vmach.uncertainty.monte_carlo import Plan

#: standard uncertainty of every point, mm
U_MM = 2e-3
PLAN = Plan(digits=1, seed=4)


def drawn(feature, text, points, signature, limits=(-np.inf, 0.005)):
    """The values of a callout where the points' corrections have a signature (P, Q), mm."""
    drawing = Drawing({**FEATURES, feature.name: feature}, DATUMS, ())
    requirement = Requirement(feature.name, read_callout(text))

    def evaluation(deviation):
        moved = Points(points.nominal_mm, points.normal, deviation, points.is_known)
        found = evaluate(drawing, requirement, moved)
        weights = np.array([m.spread(len(deviation)) for m in found])
        return np.array([m.value_mm for m in found]), weights

    count = len(evaluation(points.deviation_mm)[0])
    return draw_features(
        [[Part("points", signature)]], points.deviation_mm, evaluation,
        np.tile(limits, (count, 1)), PLAN,
    )  # fmt: skip


def line(deviations):
    """Points of a plane on a line along X, 10 mm apart, with deviations in mm."""
    count = len(deviations)
    points = np.column_stack([10.0 * np.arange(count), np.zeros((count, 2))])
    normal = np.tile([0.0, 0.0, 1.0], (count, 1))
    surface = Surface("plane", [0, 0, 0], [0, 0, 1])
    feature = make_feature("line", [surface], [np.arange(count)])
    return feature, Points(points, normal, np.array(deviations, float), np.ones(count, bool))


def test_straightness_of_three_points_is_half_normal():
    """The zone is |d0 - 2 d1 + d2| / 2 wide: first order knows no sign for it at zero."""
    feature, points = line([0.0, 0.0, 0.0])
    found = drawn(feature, "straightness 0.005 along X", points, U_MM * np.eye(3))
    half = stats.halfnorm(scale=U_MM * np.sqrt(6.0) / 2.0)
    assert found.drawn.mean == pytest.approx(half.mean(), rel=0.02)
    assert found.drawn.u == pytest.approx(half.std(), rel=0.02)
    assert found.drawn.high == pytest.approx(half.ppf(0.95), rel=0.03)
    assert found.drawn.low == pytest.approx(0.0, abs=1e-5)
    assert found.inside == pytest.approx(half.cdf(0.005), abs=0.01)
    assert found.missed_mm == pytest.approx(0.0, abs=1e-9)


def profile_of_independent_points(number):
    """The slanting face, of which some points have corrections of their own."""
    rows = ROWS["slant"][:number]
    points = part()
    signature = np.zeros((len(points.nominal_mm), number))
    signature[rows, np.arange(number)] = U_MM
    return drawn(FEATURES["slant"], "profile 0.005 A B C", points, signature)


def test_profile_is_the_largest_of_independent_points():
    """A zone that nothing moves is twice the largest of |d_i|: its distribution is a product."""
    found = profile_of_independent_points(5)

    def ends(share):
        return 2.0 * U_MM * stats.halfnorm.ppf(share ** (1 / 5))

    assert found.inside == pytest.approx(stats.halfnorm.cdf(0.0025 / U_MM) ** 5, abs=0.015)
    middle = ends((np.arange(200_000) + 0.5) / 200_000)
    assert found.drawn.mean == pytest.approx(middle.mean(), rel=0.02)
    assert found.drawn.u == pytest.approx(middle.std(), rel=0.04)


def test_sums_that_were_not_found_are_told():
    """Of 300 sums that may decide a few dozen are found: the checks must say so."""
    found = profile_of_independent_points(150)
    assert found.missed_mm > 0.05 * found.drawn.u


def test_a_size_by_least_squares_stays_normal():
    """The mean of n independent radii: u / sqrt(n), twice that for the diameter."""
    bore = FEATURES["bore 1"]
    rows = bore.members[0].rows
    points = part()
    signature = np.zeros((len(points.nominal_mm), len(rows)))
    signature[rows, np.arange(len(rows))] = U_MM
    found = drawn(bore, "20 ±0.001 (GG)", points, signature, (19.9995, 20.0005))
    u = 2.0 * U_MM / np.sqrt(len(rows))
    assert found.drawn.u == pytest.approx(u, rel=0.02)
    assert found.drawn.high - found.drawn.low == pytest.approx(2 * 1.96 * u, rel=0.03)
    assert found.inside == pytest.approx(2 * stats.norm.cdf(5e-4 / u) - 1, abs=0.01)


DRAWING = """
[[features]]
name = "width"
faces = ["wall +X", "wall -X"]

[datums]
A = "wall -X"

[tolerances]
width = "40 ±0.002"
"wall +X" = "parallelism 0.0005 A"

[drawing]
pmi = false
"""


def test_a_job_draws_its_tables_and_judges_by_the_draws(tmp_path):
    """The scale of X is stated to 100 um/m: the width of 30 mm of path is known to 3 um."""
    from tests.small_job import write_job
    from vmach.base.variant import Variant
    from vmach.run.pipeline import inspect_part

    stated = "\n[uncertainty]\npositioning_um_per_m = 100\nreading_um = 0.001\n"
    job = write_job(tmp_path, {"EXX": (lambda x: 0.0 * x, (0, 0, -100))}, squareness=stated,
                    more=DRAWING)  # fmt: skip
    found = inspect_part(job, variants=(Variant.ABBE,), prefer_measured=True, plan=PLAN)
    width, parallel = found.features[1], found.features[2]
    value = width.predicted
    assert value.u_mm == pytest.approx(0.003, rel=0.03)
    low, high = value.interval_mm
    assert high - low == pytest.approx(2 * 1.96 * 0.003, rel=0.04)
    assert 2 * stats.norm.cdf(0.002 / 0.003) - 1 == pytest.approx(0.495, abs=1e-3)
    assert str(value.verdict) == "cannot be told"
    assert parallel.predicted.interval_mm[0] >= 0.0
    assert not [note for note in found.notes if "may be off" in str(note)]
