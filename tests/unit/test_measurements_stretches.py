"""Surfaces of points that name no feature, against those that were measured."""

import numpy as np
import pytest

from tests.small_job import pocket_points, write_job, write_points
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.measurements.stretches import stretches_of


def partition(names):
    """Which points are together, whatever the names."""
    return {frozenset(np.flatnonzero(names == name).tolist()) for name in np.unique(names)}


def test_walls_floor_and_bore_of_a_pocket_are_told_apart():
    feature, points, normals = pocket_points()
    assert partition(stretches_of(points, normals)) == partition(feature)
    order = np.random.default_rng(1).permutation(len(points))
    assert partition(stretches_of(points[order], normals[order])) == partition(feature[order])


def test_points_that_were_measured_again_are_no_neighbours():
    feature, points, normals = pocket_points()
    found = stretches_of(np.tile(points, (3, 1)), np.tile(normals, (3, 1)))
    assert partition(found) == partition(np.tile(feature, 3))


@pytest.mark.parametrize("count", [1, 2])
def test_lone_points_share_a_name(count):
    _, points, normals = pocket_points()
    far = np.vstack([points, [200.0, 0.0, 0.0] + 50.0 * np.eye(3)[:count]])
    found = stretches_of(far, np.vstack([normals, [[0.0, 0.0, 1.0]] * count]))
    assert (found[-count:] == "alone").all() and "alone" not in found[:-count]


def test_points_without_names_are_read_by_surfaces(tmp_path):
    job = write_job(tmp_path, {})
    write_points(tmp_path / "points.csv")
    text = (tmp_path / "points.csv").read_text()
    for name in np.unique(pocket_points()[0]):
        text = text.replace(f",{name},", ",,")
    (tmp_path / "points.csv").write_text(text)
    (part,) = survey_job(job).measurements
    assert partition(part.group) == partition(pocket_points()[0])
