"""Places that were measured several times: their means, against sums written out here."""

import numpy as np
import pytest

from tests.small_job import pocket_points, write_job, write_points
from vmach.base.note import Level
from vmach.diagnosis.residuals.job_survey import survey_job

UM = 1e-3
#: what the turn of a part by some microradians leaves beside the linear law, mm
TURNED_MM = 1e-7


def measured_again(folder, away_um, order=None, clamping=None):
    """The survey of a pocket of which every point was measured as often as rows of `away_um`."""
    job = write_job(folder, {})
    _, points, normals = pocket_points()
    texts = []
    for k, away in enumerate(away_um):
        write_points(folder / "points.csv", points + UM * away[:, None] * normals)
        heading, *rows = (folder / "points.csv").read_text().splitlines()
        if order is not None:
            heading += ",order"
            rows = [f"{row},{at}" for row, at in zip(rows, order[k], strict=True)]
        if clamping is not None:
            heading += ",clamping"
            rows = [f"{row},{clamping[k]}" for row in rows]
        texts += rows
    (folder / "points.csv").write_text("\n".join([heading, *texts]) + "\n")
    return survey_job(job).measurements[0]


def test_the_mean_of_a_place_counts_with_the_uncertainty_of_a_reading(tmp_path):
    count = len(pocket_points()[0])
    away_um = np.random.default_rng(8).normal(size=(4, count))
    part = measured_again(tmp_path, away_um)
    assert len(part) == count and part.surface is not None
    np.testing.assert_allclose(part.measured_mm, UM * away_um.mean(axis=0), atol=TURNED_MM)
    assert set(part.u_mm.tolist()) == {0.5 * UM}  # what a place has of its own is no smaller
    repeat_um = np.sqrt(away_um.var(axis=0, ddof=1).mean())
    (note,) = (n for n in part.notes if "measured up to 4 times" in n.sentence)
    assert f"readings repeat to {repeat_um:.2g} um" in note.sentence
    assert not any("all are kept" in n.sentence for n in part.notes)


def test_means_stand_in_the_order_of_measuring(tmp_path):
    count = len(pocket_points()[0])
    forth = np.arange(count)
    part = measured_again(tmp_path, np.outer([0.1, 0.2], np.ones(count)), [forth, -forth])
    assert part.measured_at.tolist() == [0.0] * count
    assert part.measured_mm == pytest.approx(0.15 * UM, abs=TURNED_MM)


def test_places_that_were_measured_once_stay_as_they_are(tmp_path):
    part = measured_again(tmp_path, np.zeros((1, len(pocket_points()[0]))))
    assert not any("times" in n.sentence for n in part.notes)


@pytest.mark.parametrize(("away_um", "is_asked"), [(0.5, False), (9.0, True)])
def test_repeats_that_differ_by_far_more_than_u_um_are_asked_about(tmp_path, away_um, is_asked):
    """A bore that is smaller in the second file was not measured twice: it is another part's."""
    names, points, _ = pocket_points()
    away = np.random.default_rng(9).normal(size=(2, len(points)), scale=0.3)
    away[1, names == "bore"] += away_um
    (tmp_path / "plain").mkdir()
    (tmp_path / "clamped").mkdir()
    plain = measured_again(tmp_path / "plain", away)
    clamped = measured_again(tmp_path / "clamped", away, clamping="ab")
    for part, said in [(plain, "several parts, or clampings?"), (clamped, "several parts?")]:
        asked = [n for n in part.notes if n.level is Level.QUESTION and said in n.sentence]
        assert len(asked) == is_asked
    assert len(clamped) == 2 * len(plain)


def test_another_pose_in_each_clamping_is_no_other_part(tmp_path):
    _, points, normals = pocket_points()
    away = np.random.default_rng(9).normal(size=(2, len(points)), scale=0.3)
    away[1] += normals @ [40.0, -30.0, 25.0] + np.cross(points, normals) @ [0.3, -0.2, 0.5]
    part = measured_again(tmp_path, away, clamping="ab")
    assert not any("several parts" in n.sentence for n in part.notes)
