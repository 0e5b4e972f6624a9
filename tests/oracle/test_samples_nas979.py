"""The circle-diamond-square sample: items found again from the points, without their evaluation."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from vmach.run.pipeline import PartInspection, inspect_part

SAMPLE = Path(__file__).parents[2] / "samples/nas979"


@pytest.fixture(scope="module")
def made() -> PartInspection:
    return inspect_part(SAMPLE)


def value(made, feature, requirement, label="", column="abbe"):
    (result,) = (r for r in made.features
                 if (r.feature, r.callout, r.label) == (feature, requirement, label))  # fmt: skip
    return result.values[column].value_mm


def face(made, name):
    """Nominal and actual points of a face that a tool cut."""
    points = made.points
    rows = (points.feature == name) & points.primary.is_cut
    moved = points.primary.deviation_mm[rows, None] * points.normal[rows]
    return points.point_mm[rows], points.point_mm[rows] + moved


def test_a_perfect_machine_makes_every_item(made):
    """Four decimals of the program, on both sides of a size: 0.1 um."""
    assert len(made.features) == 22
    for result in made.features:
        found = result.values["none"].value_mm
        assert found == pytest.approx(result.nominal_mm, abs=1e-4), result.callout


def test_widths_are_distances_of_opposite_points(made):
    (low, left), (high, right) = face(made, "face 7 plane"), face(made, "face 9 plane")
    assert low[:, 1:] == pytest.approx(high[np.lexsort(high[:, 1:].T)][
        np.argsort(np.lexsort(low[:, 1:].T))][:, 1:], abs=1e-6)  # fmt: skip
    across = np.sort([np.abs(right[np.linalg.norm(high[:, 1:] - p[1:], axis=1).argmin(), 0] - q[0])
                      for p, q in zip(low, left, strict=True)])  # fmt: skip
    assert value(made, "square X", "127 ±0.025", "smallest") == pytest.approx(across[0], abs=2e-6)
    assert value(made, "square X", "127 ±0.025", "largest") == pytest.approx(across[-1], abs=2e-6)


def test_the_circle_stands_off_the_bore_by_their_middles(made):
    """Both axes are upright within 3e-5: coaxiality is about twice the distance of the centres."""
    centres = []
    for name in ("face 18 cylinder R43", "face 11 cylinder R12.7"):
        _, seen = face(made, name)
        table = np.column_stack([2 * seen[:, :2], np.ones(len(seen))])
        centres.append(np.linalg.lstsq(table, (seen[:, :2] ** 2).sum(axis=1), rcond=None)[0][:2])
    apart = np.hypot(*(centres[0] - centres[1]))
    # the axis of the bore leans by its perpendicularity over 25 mm, and is looked at 16 mm higher
    lean = value(made, "bore", "perpendicularity Ø0.01 A")
    assert value(made, "circle", "coaxiality Ø0.025 C") == pytest.approx(2 * apart, abs=2 * lean)


def test_lines_of_the_square_are_as_straight_as_their_best_pair_says(made):
    worst = 0.0
    for number in (7, 8, 9, 10):
        along = number % 2
        nominal, seen = face(made, f"face {number} plane")
        for z in np.unique(nominal[:, 2].round(6)):
            row = np.abs(nominal[:, 2] - z) < 1e-5
            x, y = seen[row, along], seen[row, 1 - along]
            slopes = [(y[j] - y[i]) / (x[j] - x[i]) for i, j in combinations(range(len(x)), 2)]
            worst = max(worst, min(np.ptp(y - s * x) for s in slopes))
    found = value(made, "square sides", "straightness 0.01")
    assert found == pytest.approx(worst, abs=1e-6)
