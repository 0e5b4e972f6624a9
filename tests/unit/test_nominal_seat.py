"""Where a part lay when it was measured: against linear programming and motions that are known."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from vmach.nominal.points import SurfacePoints
from vmach.nominal.seat import motion_beside_odd_ones, seat_of

SHIFT, TURN = np.array([0.3, -0.2, 0.1]), np.array([2e-3, -1e-3, 3e-3])


def box_points(*, facing_x=30):
    """Points on five faces of a box of 80 x 60 x 20 mm; few of them may face X."""
    random = np.random.default_rng(4)
    normal = np.vstack(
        [
            *(np.tile([sign, 0.0, 0.0], (facing_x, 1)) for sign in (-1.0, 1.0)),
            *(np.tile([0.0, sign, 0.0], (60, 1)) for sign in (-1.0, 1.0)),
            np.tile([0.0, 0.0, 1.0], (200, 1)),
        ]
    )
    half = np.array([40.0, 30.0, 10.0])
    point = random.uniform(-half, half, normal.shape)
    point = np.where(normal != 0.0, normal * half, point)
    return point, normal


def points_of(point, normal, measured):
    names = np.arange(len(point))
    return SurfacePoints(names, names, point, normal, measured)


def test_the_least_sum_of_deviations_is_that_of_linear_programming():
    point, normal = box_points()
    deviation = np.random.default_rng(5).standard_cauchy(len(point))
    rows = np.hstack([normal, np.cross(point, normal)])
    length = np.sqrt(np.mean(np.sum(point**2, axis=1)))
    against = 3.0 * np.diag([1.0, 1.0, 1.0, length, length, length])
    rows, deviation = np.vstack([rows, against]), np.r_[deviation, np.zeros(6)]
    count = len(rows)
    bound = np.hstack([np.vstack([rows, -rows]), -np.vstack([np.eye(count)] * 2)])
    least = linprog(
        np.r_[np.zeros(6), np.ones(count)], bound, np.r_[deviation, -deviation], bounds=(None, None)
    )
    motion = motion_beside_odd_ones(point, normal, deviation[:-6])
    assert np.abs(deviation - rows @ motion).sum() == pytest.approx(least.fun, rel=1e-3)


@pytest.mark.parametrize("share", [0.0, 0.2])
def test_a_motion_is_found_beside_odd_points(share):
    point, normal = box_points()
    random = np.random.default_rng(6)
    turned = Rotation.from_rotvec(TURN).apply(point) + SHIFT
    odd = random.random(len(point)) < share
    turned[odd] += 5.0 * random.random((int(odd.sum()), 1)) * normal[odd]
    seat = seat_of(points_of(point, normal, turned))
    back = seat.taken_back(turned)[~odd]
    left = np.einsum("ij,ij->i", back - point[~odd], normal[~odd])
    assert np.abs(left).max() < 5e-4  # as odd ones pull where the others count by their square
    assert Rotation.from_matrix(seat.rotation).as_rotvec() == pytest.approx(TURN, abs=2e-5)
    assert seat.shift_of_zero_mm == pytest.approx(SHIFT, abs=5e-4)


def test_a_shift_that_few_surfaces_show_is_found():
    point, normal = box_points(facing_x=5)
    along = point + 7.0 * normal[:, :1] * normal  # as a machine that measures along the normals
    seat = seat_of(points_of(point, normal, along))
    assert seat.shift_of_zero_mm == pytest.approx([7.0, 0.0, 0.0], abs=1e-4)


def test_what_too_few_readings_tell_is_left_as_it_is():
    point, normal = box_points(facing_x=1)
    measured = point + 3.0 * normal[:, :1] * normal
    seat = seat_of(points_of(point, normal, measured))
    assert np.abs(seat.deviation_mm(point, normal)).max() < 5e-3


def test_what_a_motion_does_is_taken_back_again():
    point, normal = box_points()
    seat = seat_of(points_of(point, normal, Rotation.from_rotvec(TURN).apply(point) + SHIFT))
    assert seat.taken_back(seat.moved(point)) == pytest.approx(point, abs=1e-12)
    linear = np.einsum("ij,ij->i", SHIFT + np.cross(TURN, point), normal)
    assert seat.deviation_mm(point, normal) == pytest.approx(linear, abs=1e-3)
