"""Clocks of instruments, as their programs export them, and sensors that were not there."""

import numpy as np
import pytest

from tests.small_job import write_job
from tests.unit.test_importers import imported, rows
from vmach.errors import InputError
from vmach.importers.importing import Target, write_imported
from vmach.importers.time_of_day import is_time_of_day, seconds_of_day
from vmach.instruments import read_instruments
from vmach.job import read_job

DRIFT = {"at": "-200 -150 -150", "tool_length": "150", "rpm": "6000"}
CIRCLE = {"centre": "-200 -150 -100", "radius": "100", "tool_length": "100"}


@pytest.mark.parametrize(
    ("cells", "seconds"),
    [
        (["08:59:30", "09:00:00", "09:00:30"], [0, 30, 60]),
        (["8:59:59.5", "9:00:00,75"], [0, 1.25]),
        (["2026-03-01T08:00:00Z", "2026-03-01T08:00:10Z"], [0, 10]),
        (["01.03.2026 23:59:50", "02.03.2026 00:00:10", "02.03.2026 12:00:00"], [0, 20, 43210]),
        (["11:59:00 AM", "12:01:00 PM", "1:00:00 pm"], [0, 120, 3660]),
    ],
)
def test_times_of_day_count_from_the_first(cells, seconds):
    assert all(map(is_time_of_day, cells))
    np.testing.assert_allclose(seconds_of_day(cells), seconds, atol=1e-9)


@pytest.mark.parametrize("cell", ["", "12.5", "08:59", "08:61:00", "1:2:3:4", "noon"])
def test_other_cells_are_no_times_of_day(cell):
    assert not is_time_of_day(cell)


def test_a_drift_log_with_dates_and_decimal_commas(tmp_path):
    """Points of a date are no decimal points."""
    text = "Zeit;dX (um);dZ (um)\n01.03.2026 08:00:00;0,5;-1,5\n01.03.2026 08:10:00;2,5;-5\n"
    one = imported(tmp_path, "d.csv", text, **DRIFT)
    found = [[float(v) for v in row] for row in rows(one.files["d_drift.csv"])[1:]]
    assert found == [[0.0, 6000.0, 0.5, -1.5], [600.0, 6000.0, 2.5, -5.0]]
    assert "count from the first" in one.told[0]


def test_hours_and_minutes_alone_are_no_clock(tmp_path):
    with pytest.raises(InputError, match=r"names no unit.*times of day are 08:59:30"):
        imported(tmp_path, "d.csv", "Time,dZ (um)\n08:00,0\n08:10,3\n", **DRIFT)


def test_no_reading_is_made_up_where_there_was_no_sensor(tmp_path):
    """One sensor along Z: that X and Y stood still nobody has read."""
    job = write_job(tmp_path)
    job.write_text(job.read_text().replace('measured = "points.csv"\n', ""))
    text = "Time (min),Z (um)\n" + "".join(f"{k},{-0.1 * k}\n" for k in range(30))
    one = imported(tmp_path, "d.csv", text, **DRIFT)
    write_imported([one], Target(tmp_path, (job,)))
    (test,) = read_instruments(read_job(job))
    assert test.sensing.tolist() == [[0.0, 0.0, 1.0]] * 30
    assert test.nuisance.tolist() == [[1.0]] * 30
    np.testing.assert_allclose(1e3 * test.measured_mm, -0.1 * np.arange(30), atol=1e-9)
    assert set(test.group) == {"along Z"}


def test_a_drift_file_without_any_displacement_is_refused(tmp_path):
    job = write_job(tmp_path, more=_section("drift", at_mm="[-200, -150, -150]"))
    (tmp_path / "drift.csv").write_text("t_s,spindle_rpm,z_um\n0,0,1\n60,0,2\n")
    with pytest.raises(InputError, match=r"drift\.csv: none of the columns dx_um, dy_um, dz_um"):
        read_instruments(read_job(job))


def test_a_column_without_use_is_said(tmp_path):
    job = write_job(tmp_path, more=_section("drift", at_mm="[-200, -150, -150]"))
    lines = [f"{600 * k},0,{k},{0.3 * k}" for k in range(12)]
    (tmp_path / "drift.csv").write_text("\n".join(["t_s,spindle_rpm,dx,dz_um", *lines]) + "\n")
    (test,) = read_instruments(read_job(job))
    assert any("column 'dx' is not used" in note.text for note in test.notes)


def _section(kind, **keys):
    text = "".join(f"{key} = {value}\n" for key, value in keys.items())
    own = f'kind = "{kind}"\nfile = "{kind}.csv"\ntool_length_mm = 100\nu_um = 0.5\n'
    return f"[[measurements]]\n{own}{text}"


def circle_text(clock):
    """A turn each way, with a clock for every reading of either."""
    angle = np.arange(0, 361, 15)
    ways = (("CCW", angle), ("CW", angle[::-1]))
    body = [
        f"{run},1000,{a % 360},{clock(k, n)},{np.cos(np.radians(2 * a)):.4f}"
        for n, (run, turned) in enumerate(ways)
        for k, a in enumerate(turned)
    ]
    return "\n".join(["Run,Feed (mm/min),Angle (deg),Time (s),Deviation (um)", *body]) + "\n"


def test_a_clock_that_begins_anew_with_each_run_goes_on(tmp_path):
    job = write_job(tmp_path)
    job.write_text(job.read_text().replace('measured = "points.csv"\n', ""))
    one = imported(tmp_path, "c.csv", circle_text(lambda k, n: 1.5 * k), **CIRCLE)
    time = np.array([float(row[3]) for row in rows(one.files["c_ballbar.csv"])[1:]])
    np.testing.assert_allclose(time, [*(1.5 * np.arange(25)), *(41.0 + 1.5 * np.arange(25))])
    assert "begins anew with runs" in one.told[0]
    write_imported([one], Target(tmp_path, (job,)))
    assert len(read_instruments(read_job(job))[0]) == 50


def test_a_clock_that_goes_back_within_a_run_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"c\.csv:22: time runs backwards within run 'CCW'"):
        imported(tmp_path, "c.csv", circle_text(lambda k, n: 1.5 * (k % 20)), **CIRCLE)


@pytest.mark.parametrize(("unit", "size"), [("nm", 1e-3), ("uin", 0.0254), ("µin", 0.0254)])
def test_small_units_of_lasers(tmp_path, unit, size):
    text = f"Position (mm),Deviation ({unit}),Direction\n"
    text += "".join(f"{x},{x}0,+\n" for x in (10, 20, 30))
    text += "".join(f"{x},{x}0,\u2212\n" for x in (30, 20, 10))
    one = imported(tmp_path, "x.csv", text, error="EXX")
    found = [[float(v) for v in row] for row in rows(one.files["errors/EXX.csv"])[1:]]
    expected = [[x, 10 * x * size, 10 * x * size] for x in (10, 20, 30)]
    np.testing.assert_allclose(found, expected, rtol=1e-6)
