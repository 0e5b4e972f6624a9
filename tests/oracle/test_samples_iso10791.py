"""The contouring test piece: the items, found again without the code that evaluates them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from vmach.run.pipeline import PartInspection, inspect_part

JOB = Path(__file__).parents[2] / "samples" / "iso10791_7" / "job.toml"


@pytest.fixture(scope="module")
def made() -> PartInspection:
    return inspect_part(JOB)


def value(made: PartInspection, feature: str, characteristic: str, column: str = "abbe") -> float:
    results = [r for r in made.features
               if (r.feature, r.characteristic) == (feature, characteristic)]  # fmt: skip
    assert len(results) == 1
    return results[0].values[column].value_mm


def face(made: PartInspection, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Points of a face that a tool cut, and where they lie."""
    points = made.points
    chosen = (points.feature == name) & points.primary.is_cut
    moved = points.primary.deviation_mm[chosen, None] * points.normal[chosen]
    return points.point_mm[chosen], points.point_mm[chosen] + moved


def test_a_perfect_machine_makes_every_item(made):
    for result in made.features:
        nominal = result.nominal_mm
        assert result.values["none"].value_mm == pytest.approx(nominal, abs=1e-4), result.callout


def test_the_step_is_the_distance_of_two_means(made):
    """Both planes are level within 1e-5 rad; their middles lie above each other."""
    top, step = (face(made, name)[1][:, 2].mean() for name in ("face 13 plane", "face 20 plane"))
    assert value(made, "circle top", "distance") == pytest.approx(top - step, abs=2e-6)


def test_perpendicularity_is_the_width_along_the_datum(made):
    """The zone stands at a right angle to the least squares plane of B, and may turn about it."""
    _, datum = face(made, "face 7 plane")
    normal = np.linalg.svd(datum - datum.mean(axis=0), full_matrices=False)[2][2]
    _, side = face(made, "face 8 plane")
    best = np.inf
    for turn in np.linspace(-3e-4, 3e-4, 6001):
        across = np.array([0.0, np.cos(turn), np.sin(turn)])
        across -= (across @ normal) * normal
        best = min(best, np.ptp(side @ (across / np.linalg.norm(across))))
    assert value(made, "square -Y", "perpendicularity") == pytest.approx(best, abs=1e-6)


def test_the_circle_is_as_round_as_its_best_centre_says(made):
    nominal, actual = face(made, "face 18 cylinder R50")
    worst = 0.0
    for height in np.unique(nominal[:, 2].round(6)):
        ring = actual[np.abs(nominal[:, 2] - height) < 1e-6, :2]
        centre, step = np.zeros(2), 5e-3
        while step > 1e-7:  # by compass search, with directions fine enough for a ridge
            angle = np.linspace(0, 2 * np.pi, 64, endpoint=False)
            near = centre + step * np.column_stack([np.cos(angle), np.sin(angle)])
            width = [np.ptp(np.hypot(*(ring - c).T)) for c in (centre, *near)]
            k = int(np.argmin(width))
            centre, step = (centre, step / 2) if k == 0 else (near[k - 1], step)
        worst = max(worst, width[k])
    assert value(made, "circle", "roundness") == pytest.approx(worst, abs=1e-6)


def test_shares_of_every_item_add_up(made):
    for result in made.features:
        total = sum(share.share_mm for share in result.shares)
        found = result.predicted.value_mm - result.nominal_mm
        assert total == pytest.approx(found, abs=2e-5), result.callout
