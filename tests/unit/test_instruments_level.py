"""A level along an axis: what it reads is the angle of the tool, and nothing that shifts it."""

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.page.instrument_pictures import instrument_pictures
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import set_up_effect
from vmach.errors import InputError
from vmach.instruments import planned_tests, read_instruments
from vmach.job import read_job

#: every error along X is there: straightness and positioning shift the level, and EAX, EBX turn it
ERRORS = {
    "EAX": (lambda x: 12.0 * np.sin(x / 70.0), None),
    "EBX": (lambda x: 0.03 * x, None),
    "ECX": (lambda x: 9.0 * np.cos(x / 50.0), None),
    "EXX": (lambda x: 5.0 * np.sin(x / 30.0), (10.0, -20.0, 30.0)),
    "EYX": (lambda x: -0.02 * x, (10.0, -20.0, 30.0)),
    "EZX": (lambda x: 4.0 * np.cos(x / 90.0), (0.0, 0.0, -100.0)),
    "EBZ": (lambda x: 0.05 * x, None),
}
PLACES = np.arange(-390.0, 0.0, 20.0)  # points of the tables


def level(about, axis="X", **settings):
    return measurement("level", axis=axis, about=about, at_mm=[-200, -150, -100], **settings)


def write_level(folder, tilt_um_per_m, places=PLACES):
    """Both ways along the axis; `tilt_um_per_m(x)` is read."""
    rows = ["run,position_mm,approach,t_s,tilt_um_per_m"]
    ways = [(x, 1) for x in places] + [(x, -1) for x in places[::-1]]
    for k, (x, way) in enumerate(ways):
        rows.append(f"1,{x},{way},{10.0 * k},{float(tilt_um_per_m(x))!r}")
    (folder / "level.csv").write_text("\n".join(rows) + "\n")


@pytest.mark.parametrize("about", ["A", "B"])
def test_the_model_foresees_the_angular_table_alone(tmp_path, about):
    """A tool turned by 1 urad tilts a level by 1 um per m: right-handed, whatever shifts it.

    X carries the workpiece; relative to it the tool turns as the table says ("relative").
    """
    job = write_job(tmp_path, ERRORS, more=level(about))
    curve = ERRORS[f"E{about}X"][0]
    write_level(tmp_path, curve)
    (test,) = read_instruments(read_job(job))
    other_axes_um_per_m = {"A": 0.0, "B": 0.05 * -100.0}[about]  # Z stands at -100
    moved = test.predicted_mm - test.measured_mm
    np.testing.assert_allclose(moved, 1e-3 * other_axes_um_per_m, atol=1e-9)


def test_other_axes_turn_it_by_their_own_tables(tmp_path):
    """Along Z only EBZ turns it about Y; X and Y stand still and count as zero."""
    job = write_job(tmp_path, ERRORS, more=level("B", "Z"))
    places = np.arange(-290.0, 0.0, 20.0)
    write_level(tmp_path, ERRORS["EBZ"][0], places)
    (test,) = read_instruments(read_job(job))
    moved = test.predicted_mm - test.measured_mm
    np.testing.assert_allclose(moved, moved[0], atol=1e-9)


def test_what_shifts_the_tool_does_not_show(tmp_path):
    job = read_job(write_job(tmp_path, more=level("A")))
    write_level(tmp_path, lambda x: np.sin(x))
    shifts = [
        set_up_effect(name, target, values, job=job)
        for name, target, values in [
            ("scale", "X", {"scale_ppm": 50.0}),
            ("squareness", "B0X", {"squareness_urad": 80.0}),
            ("backlash", "X", {"reversal_um": 20.0}),
        ]
    ]
    (test,) = read_instruments(job, effects=shifts)
    assert not test.predicted_mm.any()
    corrected = set_up_effect(
        "component", "EAX", {"position_mm": [-400.0, 0.0], "correction_urad": [40.0, 0.0]}, job=job
    )
    (test,) = read_instruments(job, effects=[corrected])
    wanted = -0.1e-3 * test.states.nose_mm[:, 0]  # 40 urad at -400: 0.1 um per m and mm
    np.testing.assert_allclose(test.predicted_mm, wanted, atol=1e-12)


def test_a_roll_that_was_never_measured_is_named(tmp_path):
    """A dent of 15 um per m in the roll of X, read with 0.3 um per m of noise."""
    errors = {name: error for name, error in ERRORS.items() if name != "EAX"}
    job = write_job(tmp_path, errors, more=level("A", u_um=0.3))
    text = job.read_text()
    job.write_text("\n".join(x for x in text.splitlines() if not x.startswith("measured")))
    random = np.random.default_rng(7)

    def hidden(x):
        return 15.0 * np.exp(-0.5 * ((x + 200.0) / 40.0) ** 2) + 0.3 * random.standard_normal()

    write_level(tmp_path, hidden, np.arange(-390.0, 0.0, 10.0))
    found = diagnose(survey_job(job))
    (roll,) = found.findings
    assert (found.verdict, roll.label, roll.status) == ("named", "component EAX", "shown")
    assert "most at -200 mm" in roll.where
    best = found.candidates[0]
    assert best.label == "component EAX" and best.rms_after_um < 0.5
    tested = {c.effect for c in found.candidates if c.status == "tested"}
    assert tested <= {"component", "head_tilt"}  # nothing else turns the tool
    (picture,) = instrument_pictures(found.residuals)
    assert picture.title == "Level: level.csv" and len(picture.plots) == 2
    assert "µm/m" in picture.plots[0][1]


def test_its_planned_tests_read_tilts(tmp_path):
    job = read_job(write_job(tmp_path, ERRORS))
    tests = [t for t in planned_tests(job) if t.settings["kind"] == "level"]
    assert [t.name for t in tests] == [f"level {a} {b}" for a in "XYZ" for b in "AB"]
    assert all(t.states.arm_mm is not None for t in tests)


def test_a_level_about_z_is_refused(tmp_path):
    job = write_job(tmp_path, more=level("C"))
    write_level(tmp_path, np.sin)
    with pytest.raises(InputError, match=r"job\.toml:\d+: 'about' = 'C'; accepted: 'A' or 'B'"):
        read_instruments(read_job(job))


@pytest.mark.parametrize(
    ("places", "said"),
    [(PLACES + 100.0, "travel"), (PLACES / 1000.0, "are the places in metres")],
    ids=["beyond", "metres"],
)
def test_places_that_the_axis_does_not_reach_or_in_metres_are_refused(tmp_path, places, said):
    job = write_job(tmp_path, more=level("A"))
    write_level(tmp_path, np.sin, places)
    with pytest.raises(InputError, match=said):
        read_instruments(read_job(job))
