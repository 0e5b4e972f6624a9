"""Predicted deviations of a small part against closed forms of the machine's errors."""

import numpy as np
import pytest

from tests.small_job import BORE_MM, pocket_points, write_job
from vmach.machine import Variant
from vmach.run.pipeline import predict_points

NAMES, POINTS, NORMALS = pocket_points()
ZERO = np.array([-200.0, -150.0, -200.0])
LENGTH = np.array([0.0, 0.0, 100.0])


def deviation_um(folder, errors=None, *, variant=Variant.ABBE, squareness=""):
    """Predicted deviations, and the nose position when each point was made, (P, 3)."""
    job = write_job(folder, errors, squareness=squareness)
    _, prediction = predict_points(job, folder / "points.csv", variant=variant)
    assert prediction.is_cut.all()
    return 1e3 * prediction.deviation_mm, prediction.states


def nose_at_wall(point, normal):
    """Where the nose of a 10 mm tool is when it cuts a wall point."""
    tip = point + 5.0 * normal
    return np.array([tip[0], tip[1], np.nan]) + ZERO + LENGTH


WALLS = np.abs(NORMALS[:, 2]) < 0.5


def test_a_perfect_machine_leaves_the_nominal_part(tmp_path):
    found, _ = deviation_um(tmp_path)
    assert np.abs(found).max() < 1e-6


def test_positioning_error_moves_the_walls_across_it(tmp_path):
    def wave(x):
        return 5.0 * np.sin(x / 30.0)

    found, _ = deviation_um(tmp_path, {"EXX": (wave, (0, 0, 0))})
    grid = np.arange(-400.0, 1e-9, 10.0)
    for point, normal, dev in zip(POINTS[WALLS], NORMALS[WALLS], found[WALLS], strict=True):
        x = nose_at_wall(point, normal)[0]
        # on a straight wall square to X the contact is the corner's end of the path or any
        # point of the move: all have the same X, so the closed form needs only that
        assert dev == pytest.approx(normal[0] * np.interp(x, grid, wave(grid)), abs=2e-3)


def test_squareness_shears_the_part(tmp_path):
    found, states = deviation_um(tmp_path, squareness="[squareness]\nEC0Y = 40.0\n")
    shift_mm = -40e-6 * states.nose_mm[:, 1]
    expected = 1e3 * shift_mm * NORMALS[:, 0]
    # a bore that is shifted across the line of sight shows its own curvature
    bore = NAMES == "bore"
    expected[bore] += 1e3 * (shift_mm * NORMALS[:, 1])[bore] ** 2 / BORE_MM
    # left out: the shear changes by 40e-6 per mm while the contact wanders by about 1 um
    assert found == pytest.approx(expected, abs=1e-4)
    plus_x = NAMES == "wall +X"
    # dx = -EC0Y y with y = nose in machine coordinates, -150 + 0.8 t at the point of the wall
    assert found[plus_x] == pytest.approx(40e-3 * (POINTS[plus_x, 1] - 150.0), abs=1e-3)


def test_roll_acts_with_the_arm_from_the_reflector(tmp_path):
    at = (0.0, 0.0, -260.0)
    errors = {"EAX": (lambda x: 30.0, None), "EYX": (lambda x: 0.0, at), "EZX": (lambda x: 0.0, at)}
    found, states = deviation_um(tmp_path, errors)
    plus_y = NAMES == "wall +Y"
    # X carries the table: arm of EYX from the reflector to the contact, z of nose - 100 + height
    z_contact = POINTS[plus_y, 2] + ZERO[2]
    dy = -30e-3 * (z_contact - at[2])
    assert found[plus_y] == pytest.approx(-dy, abs=1e-3)
    floor = NAMES == "floor"
    contact_y = (states.nose_mm + states.tool_mm + states.contact_mm)[floor, 1]
    assert found[floor] == pytest.approx(30e-3 * (contact_y - at[1]), abs=1e-3)


def test_conventional_arms_start_at_the_origin(tmp_path):
    at = (0.0, 0.0, -260.0)
    errors = {"EAX": (lambda x: 30.0, None), "EYX": (lambda x: 0.0, at), "EZX": (lambda x: 0.0, at)}
    found, _ = deviation_um(tmp_path, errors, variant=Variant.HTM)
    plus_y = NAMES == "wall +Y"
    assert found[plus_y] == pytest.approx(30e-3 * (POINTS[plus_y, 2] + ZERO[2]), abs=1e-3)


def test_tilt_shows_along_the_height_of_a_wall(tmp_path):
    # the roll of Z turns the tool about X; the reflector at the tip hides its arm there
    at = (0.0, 0.0, -100.0)
    errors = {
        "EAZ": (lambda x: 100.0, None),
        "EYZ": (lambda x: 0.0, at),
        "EZZ": (lambda x: 0.0, at),
    }
    found, _ = deviation_um(tmp_path, errors)
    plus_y = NAMES == "wall +Y"
    height = POINTS[plus_y, 2] + 8.0  # above the tip, which runs at z = -8
    assert found[plus_y] == pytest.approx(100e-3 * height, abs=2e-3)


def test_bore_is_shifted_by_a_constant_error(tmp_path):
    found, _ = deviation_um(tmp_path, {"EXX": (lambda x: 4.0, (0, 0, 0))})
    bore = NAMES == "bore"
    assert found[bore] == pytest.approx(4.0 * NORMALS[bore, 0], abs=2e-3)


def test_every_point_names_the_line_that_made_it(tmp_path):
    _, states = deviation_um(tmp_path)
    assert set(states.line[NAMES == "wall +X"]) == {10}  # the Y10 block
    assert set(states.line[NAMES == "bore"]) == {22}
    assert (states.tool == 1).all()


def test_alternative_program_on_the_same_machine(tmp_path):
    job = write_job(tmp_path)
    shallow = (tmp_path / "part.nc").read_text().replace("Z-8", "Z-7.99")
    (tmp_path / "other.nc").write_text(shallow)
    _, prediction = predict_points(
        job, tmp_path / "points.csv", program_path=tmp_path / "other.nc", variant=Variant.NONE
    )
    floor = NAMES == "floor"
    assert 1e3 * prediction.deviation_mm[floor] == pytest.approx(10.0, abs=1e-6)
