"""Alignment against rigid motions that were put in."""

import numpy as np
import pytest

from vmach.errors import InputError
from vmach.nominal.alignment import align, fit_alignment
from vmach.nominal.points import SurfacePoints

SHIFT, TURN = np.array([0.012, -0.007, 0.021]), np.array([30e-6, -55e-6, 80e-6])


def box_points(count=120):
    """Points on the six faces of a box, named by face."""
    rng = np.random.default_rng(3)
    point = rng.uniform(-1, 1, (count, 3)) * [50, 30, 20]
    face = np.arange(count) % 6
    axis, side = face // 2, np.where(face % 2, 1.0, -1.0)
    point[np.arange(count), axis] = side * np.array([50, 30, 20])[axis]
    normal = np.zeros((count, 3))
    normal[np.arange(count), axis] = side
    names = np.array(["left", "right", "front", "back", "bottom", "top"])[face]
    return SurfacePoints(np.arange(count), names, point, normal)


def motion(points, about=(0, 0, 0)):
    moved = SHIFT + np.cross(TURN, points.point_mm - np.array(about))
    return np.einsum("ij,ij->i", moved, points.normal)


def test_a_rigid_motion_is_found_and_taken_away():
    points = box_points()
    found = fit_alignment(points.point_mm, points.normal, motion(points))
    assert found.rank == 6
    assert found.rotation_rad == pytest.approx(TURN, abs=1e-12)
    expected = SHIFT + np.cross(TURN, found.about_mm)
    assert found.shift_mm == pytest.approx(expected, abs=1e-12)
    left = found.apply(points.point_mm, points.normal, motion(points))
    assert np.abs(left).max() < 1e-12


def test_covariance_is_that_of_repeated_noise():
    points, rng = box_points(), np.random.default_rng(5)
    u_mm = 1e-3
    weights = np.full(len(points), u_mm**-2)
    fits = [
        fit_alignment(points.point_mm, points.normal, u_mm * rng.normal(size=len(points)), weights)
        for _ in range(400)
    ]
    scatter = np.cov(np.array([np.r_[f.shift_mm, f.rotation_rad] for f in fits]).T)
    # 400 repeats: a variance is known to sqrt(2 / 400) = 7 %, four of those are allowed
    assert np.diag(scatter) == pytest.approx(np.diag(fits[0].covariance), rel=0.28)


def test_a_single_plane_leaves_three_motions_free():
    points = box_points()
    top = points.feature == "top"
    found = fit_alignment(points.point_mm[top], points.normal[top], motion(points)[top])
    assert found.rank == 3
    assert "leave 3 of 6 motions free" in str(found.notes[0])
    assert found.shift_mm[:2] == pytest.approx(0, abs=1e-12)
    assert found.rotation_rad[2] == pytest.approx(0, abs=1e-12)


def test_three_planes_are_taken_one_after_the_other():
    # datum A (top) is off by its own form error; B and C must not touch what A has fixed
    points = box_points(600)
    deviation = motion(points)
    deviation[points.feature == "left"] += 1e-6 * points.point_mm[points.feature == "left", 2]
    found = align(points, deviation, mode="datum", datums=[["top"], ["back"], ["left"]])
    assert found.rank == 6
    left = found.apply(points.point_mm, points.normal, deviation)
    assert np.abs(left[points.feature == "top"]).max() < 1e-12
    assert np.abs(left[points.feature == "back"]).max() < 1e-12
    assert left[points.feature == "left"].mean() == pytest.approx(0, abs=1e-12)
    assert np.abs(left[points.feature == "left"]).max() > 1e-6  # the form error stays


def test_no_alignment():
    points = box_points()
    found = align(points, motion(points), mode="none")
    assert np.array_equal(
        found.apply(points.point_mm, points.normal, motion(points)), motion(points)
    )


def test_weights_count():
    points = box_points()
    deviation = motion(points)
    weights = np.ones(len(points))
    deviation[0], weights[0] = 5.0, 0.0  # a chip under the probe
    found = fit_alignment(points.point_mm, points.normal, deviation, weights)
    assert found.rotation_rad == pytest.approx(TURN, abs=1e-12)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"mode": "guess"}, "none, best-fit, datum"),
        ({"mode": "datum"}, "needs datum features"),
        ({"mode": "datum", "datums": [["roof"]]}, "no point lies on the datum feature 'roof'"),
    ],
)
def test_what_cannot_be_aligned(arguments, words):
    points = box_points()
    with pytest.raises(InputError, match=words):
        align(points, motion(points), **arguments)


def test_deviations_that_are_not_finite():
    points = box_points()
    with pytest.raises(InputError, match="1 of the deviations to align are not finite"):
        align(points, np.where(np.arange(len(points)) == 4, np.nan, motion(points)))
