"""The generator's instruments against closed forms, on a machine without any error."""

import numpy as np
import pytest

from tests.hidden_effects.instruments import INSTRUMENTS, U_UM, Site, write_instrument
from tests.hidden_effects.machine_maker import ErrorCurve, random_machine
from tests.hidden_effects.state import Hidden

ZERO_MM = np.array([-800.0, -500.0, -400.0])


def perfect_machine():
    machine = random_machine(np.random.default_rng(1))
    flat = ErrorCurve(-1000.0, 0.0, 0.0, np.zeros(5), np.zeros(5))
    machine.curves = dict.fromkeys(machine.curves, flat)
    machine.squareness_urad = dict.fromkeys(machine.squareness_urad, 0.0)
    return machine


def measured(folder, name, move, *, on_part_only=False):
    hidden = Hidden("cause", (), {}, move, on_part_only=on_part_only)
    site = Site(perfect_machine(), [hidden], ZERO_MM)
    lines = write_instrument(folder, name, np.random.default_rng(7), site)
    assert f'file = "{name}.csv"' in lines
    return np.genfromtxt(
        folder / f"{name}.csv", delimiter=",", names=True, dtype=None, encoding="utf-8",
        deletechars="", converters={0: str} if name[:2] in ("ba", "la", "di") else None,
    )  # fmt: skip


def along(axis, amount_mm):
    return amount_mm[:, None] * np.eye(3)["XYZ".index(axis)]


def test_laser_line_shows_play_both_ways_and_scale(tmp_path):
    rows = measured(
        tmp_path, "laser_X",
        lambda s: along("X", 20e-6 * s.nose_mm[:, 0] - 3e-3 * s.sign[:, 0]),
    )  # fmt: skip
    x, way, seen = rows["position_mm"], rows["approach"], rows["deviation_um"]
    columns = np.stack([np.ones_like(x), x, way], axis=1)
    fit, *_ = np.linalg.lstsq(columns, seen, rcond=None)
    assert fit[1] == pytest.approx(20e-3, abs=2e-4)
    assert fit[2] == pytest.approx(-3.0, abs=0.1)
    assert np.std(seen - columns @ fit) == pytest.approx(U_UM, rel=0.2)
    assert seen[0] == 0.0


def test_ballbar_turns_both_ways_with_feed(tmp_path):
    """Lags of X and Y that differ by 0.5 ms: an ellipse at 45 degrees, half of v dt, by ways."""
    rows = measured(
        tmp_path, "ballbar_xy", lambda s: s.velocity_mm_s * np.array([-0.25e-3, 0.25e-3, 0.0])
    )
    for feed in (1000.0, 4000.0):
        for run, turn in (("ccw", 1), ("cw", -1)):
            some = rows[(rows["run"] == run) & (rows["feed_mm_min"] == feed)]
            a = np.deg2rad(some["angle_deg"])
            columns = np.stack([np.ones_like(a), np.cos(a), np.sin(a), np.sin(2 * a)], axis=1)
            fit, *_ = np.linalg.lstsq(columns, some["radius_um"], rcond=None)
            expected = turn * 0.25 * feed / 60  # ms mm/s = um
            assert fit[3] == pytest.approx(expected, abs=0.08)
            assert np.diff(some["t_s"]).mean() == pytest.approx(
                np.deg2rad(2) * 150 / feed * 60, rel=1e-4
            )


def test_diagonal_shows_the_mean_of_the_scales(tmp_path):
    """Stretch along a direction (a, b, c): scale . (a^2, b^2, c^2)."""
    scale = np.array([30e-6, -10e-6, 20e-6])
    rows = measured(tmp_path, "diagonal_1", lambda s: s.nose_mm * scale)
    fit = np.polyfit(rows["distance_mm"], rows["deviation_um"], 1)
    machine = perfect_machine()
    room = np.array([np.ptp(machine.travel_mm[a]) for a in "XYZ"])
    unit = room / np.linalg.norm(room)
    assert fit[0] == pytest.approx(1e3 * scale @ unit**2, abs=2e-4)
    assert rows["distance_mm"].max() == pytest.approx(0.84 * np.linalg.norm(room), rel=1e-5)


def test_drift_runs_an_hour_and_stops(tmp_path):
    rows = measured(
        tmp_path, "drift",
        lambda s: along("Z", -20e-3 * s.history.at(
            s.history.response((s.history.rpm > 0).astype(float), 900, 900), s.time_s)),
    )  # fmt: skip
    t, rpm = rows["t_s"], rows["spindle_rpm"]
    assert rpm[0] == 8000 and rpm[-1] == 0 and t[rpm > 0].max() == pytest.approx(3570)
    warm = 1 - np.exp(-np.minimum(t, 3600) / 900)
    expected = -20 * warm * np.exp(-np.maximum(t - 3600, 0) / 900)
    left = rows["dz_um"] - expected
    assert np.std(left) == pytest.approx(U_UM, rel=0.25)


def test_tracker_leaves_a_rigid_motion(tmp_path):
    rows = measured(tmp_path, "tip", lambda s: 0 * s.nose_mm)
    place = np.stack([rows[a] for a in "XYZ"], axis=1)
    seen = np.stack([rows[f"d{a}_um"] for a in "xyz"], axis=1)
    unit = np.tile(np.eye(3), (len(place), 1))
    arm = np.repeat(place - place.mean(axis=0), 3, axis=0)
    columns = np.hstack([unit, np.cross(arm, unit)])
    fit, *_ = np.linalg.lstsq(columns, seen.ravel(), rcond=None)
    assert np.std(seen) > 5
    assert np.std(seen.ravel() - columns @ fit) == pytest.approx(1.0, rel=0.15)
    step = np.sign(np.diff(place, axis=0))
    np.testing.assert_array_equal(np.stack([rows[f"s{a}"] for a in "xyz"], axis=1)[1:], step)


@pytest.mark.parametrize("name", INSTRUMENTS)
def test_what_belongs_to_the_cut_is_not_in_a_test_without_one(tmp_path, name):
    big = measured(tmp_path, name, lambda s: 1.0 + 0 * s.nose_mm, on_part_only=True)
    column = {"ba": "radius_um", "la": "deviation_um", "di": "deviation_um"}.get(name[:2], "dx_um")
    assert np.abs(big[column]).max() < 100
