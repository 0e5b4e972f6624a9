"""The motion that brings measured points to the nominal ones is found and told in words."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from vmach.measurements.plausibility.wrong_frame import wrong_frame

SHIFT = np.array([-940.0, 1.25, 0.0])
POINTS = np.random.default_rng(2).uniform([-80, -50, -30], [80, 50, 0], (60, 3))
NOISE = np.random.default_rng(3).normal(scale=1e-4, size=(60, 3))


def told(measured):
    words = wrong_frame(POINTS, measured + NOISE)
    assert words is not None
    return words


def test_a_shift_is_told_in_mm():
    words = told(POINTS + SHIFT)
    assert "shifted by (-940.000, 1.250, 0.000) mm" in words
    assert "zero" in words


@pytest.mark.parametrize("degrees", [0.5, 2.0, 15.0])
def test_a_turn_is_told_in_degrees(degrees):
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    turn = Rotation.from_rotvec(np.radians(degrees) * axis)
    assert f"turned by {degrees:g} degrees" in told(turn.apply(POINTS) + SHIFT)


@pytest.mark.parametrize(
    ("columns", "signs", "said", "mirrored"),
    [
        ([1, 2, 0], [1, 1, 1], "y, z, x", False),
        ([1, 0, 2], [1, 1, 1], "y, x, z", True),
        ([1, 0, 2], [1, -1, 1], "y, -x, z", False),
        ([0, 1, 2], [-1, 1, 1], "-x, y, z", True),
        ([0, 1, 2], [-1, -1, 1], "-x, -y, z", False),
    ],
)
def test_exchanged_columns_are_told_by_their_names(columns, signs, said, mirrored):
    words = told(POINTS[:, columns] * signs + [900.0, 0.0, 0.0])
    assert f"mx, my, mz hold {said} and" in words
    assert ("mirrored" in words) == mirrored


def test_a_mirrored_and_turned_part_is_told():
    turn = Rotation.from_rotvec([0.0, 0.0, np.radians(30.0)])
    assert "mirrored part" in told(turn.apply(POINTS * [-1.0, 1.0, 1.0]))


def test_other_points_are_not_explained():
    other = np.random.default_rng(4).uniform(-80, 80, POINTS.shape)
    assert wrong_frame(POINTS, other) is None
    assert wrong_frame(POINTS[:3], POINTS[:3] + 5.0) is None


def test_points_of_one_plane_are_not_taken_for_a_mirrored_part():
    flat = POINTS * [1.0, 1.0, 0.0]
    assert "shifted" in (wrong_frame(flat, flat + SHIFT) or "")
