"""Compensated programs, against closed forms and the machine's own model."""

import re
from pathlib import Path

import numpy as np
import pytest

from tests.oracle.compensation_corpus import straight_machine
from vmach.compensation import compensate
from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.job import read_job
from vmach.machine import Variant

MACHINE = straight_machine(1000)

JOB = """schema = 1
machine = "machine.toml"
program = "part.nc"
[work_offsets_mm]
G54 = [100, 50, -300]
[tools.1]
shape = "flat"
diameter_mm = 10
length_mm = 100
"""

SCALE_PPM = 200.0
SCALE = f"[effects.scale.X]\nscale_ppm = {SCALE_PPM}\n"
HEAD = "(Odd Spacing )\nG21 G17 G90 G94\nG54\nT1 M6\nS3000 M3\nG0 X0. Y0.\nG43 H1 Z5.\n"


def job_with(folder: Path, body: str, effects: str = ""):
    (folder / "machine.toml").write_text(MACHINE)
    (folder / "job.toml").write_text(JOB + effects)
    (folder / "part.nc").write_bytes((HEAD + body).encode("latin-1"))
    job = read_job(folder)
    return job, read_effects(job.effects, file=job.path, job=job)


def numbers(text: bytes, letter: str) -> list[float]:
    return [float(v) for v in re.findall(rf"{letter}(-?\d+\.\d*)", text.decode("latin-1"))]


BODY = "G1 Z-1. F200\nn7 g1x30.Y10 (keep)\r\n  G2 X50. Y10. I10. J0. ;so\nG3 X40 Y0 R-10.\nM30\n"


def test_no_error_gives_the_same_bytes(tmp_path):
    job, effects = job_with(tmp_path, BODY)
    found = compensate(job, effects)
    assert found.text == (HEAD + BODY).encode("latin-1")
    assert found.growth == 1.0


def test_scale_error_is_divided_out(tmp_path):
    body = "G1 Z-1. F200\nX300.\nX-200.\nM30\n"
    job, effects = job_with(tmp_path, body, SCALE)
    found = compensate(job, effects, resolution_mm=1e-5)
    # q (1 + s) = q_nominal in machine coordinates, with the work offset at 100
    wanted = [(x + 100.0) / (1.0 + SCALE_PPM * 1e-6) - 100.0 for x in (300.0, -200.0)]
    np.testing.assert_allclose(numbers(found.text, "X")[-2:], wanted, rtol=0, atol=1.1e-5)
    assert found.growth == 1.0, "a linear error needs no further points"


@pytest.mark.parametrize(
    "body",
    [
        pytest.param("G1 Z-1. F200\nG91\nG1 X30. F500\nX30.\nY20.\nX-60.\nG90\nM30\n", id="G91"),
        pytest.param("G1 Z-1. F200\nG20\nG1 X3. F20\nG2 X3. Y1. I0. J.5\nM30\n", id="inch"),
        pytest.param("G1 Z-1. F200\nG90.1\nG2 X60. Y0. I30. J0. F500\nG91.1\nM30\n", id="G90.1"),
        pytest.param("G1 Z-1. F200\nG2 X0. Y0. I30. J0. F500\nM30\n", id="full circle"),
        pytest.param("G1 Z-1. F200\nG3 X40. Y0. R-25. F500\nG1 X0.\nM30\n", id="R"),
        pytest.param("G18 G1 Z-1. F200\nG2 X40. Z-1. I20. K0. F500\nM30\n", id="G18"),
        pytest.param("G92 X10. Y10.\nG1 Z-1. F200\nX50. Y40.\nG92.1\nM30\n", id="G92"),
        pytest.param(
            "G10 L2 P1 X100. Y50. Z-300. R30.\nG0 X0. Y0.\nG1 Z-1. F200\nX50.\nM30\n", id="turned"
        ),
    ],
)
def test_modes_are_mapped_back(tmp_path, body):
    bent = SCALE + "[effects.scale.Y]\nscale_ppm = -150\n[effects.cyclic_pitch.X]\n"
    bent += "amplitude_um = 4\npitch_mm = 40\nphase_rad = 0.3\n"
    job, effects = job_with(tmp_path, body, bent)
    found = compensate(job, effects)
    assert found.before.largest_mm > 5e-3
    assert found.unrounded.largest_mm < 1e-4
    step_mm = 2.54e-3 if "G20" in body else 1e-3  # 0.0001 inch, 0.001 mm
    # half a step in each of three axes, and a little for the centres of arcs
    assert found.after.largest_mm < (0.5 * 3**0.5 + 0.3) * step_mm


def test_arc_under_equal_scales_stays_one_arc(tmp_path):
    equal = SCALE + f"[effects.scale.Y]\nscale_ppm = {SCALE_PPM}\n"
    job, effects = job_with(tmp_path, "G1 Z-1. F200\nG2 X60. Y0. I30. J0. F500\nM30\n", equal)
    found = compensate(job, effects, resolution_mm=1e-5)
    assert (found.growth, found.arcs, found.arcs_kept) == (1.0, 1, 1)
    assert abs(numbers(found.text, "I")[-1] - 30.0 / (1.0 + SCALE_PPM * 1e-6)) < 2.1e-5


@pytest.mark.parametrize(
    ("body", "line"),
    [
        ("G1 Z-1. F200\nG38.2 Z-3. F100\nM30\n", 9),
        ("G1 Z-1. F200\nG5.1 X10. Y0. I5. J5.\nM30\n", 9),
    ],
)
def test_what_cannot_be_rewritten_is_refused_by_line(tmp_path, body, line):
    job, effects = job_with(tmp_path, body, SCALE)
    with pytest.raises(InputError) as caught:
        compensate(job, effects, variant=Variant.HTM)
    assert caught.value.line == line


def test_correction_beyond_the_limit_is_refused(tmp_path):
    job, effects = job_with(tmp_path, "G1 Z-1. F200\nX300.\nM30\n", SCALE)
    with pytest.raises(InputError, match="um"):
        compensate(job, effects, limit_mm=0.05)


SQUARE = "G1 Z-1. F1000\nX60.\nY40.\nX0.\nY0.\nM30\n"


def test_backlash_is_answered_where_the_axis_turns(tmp_path):
    backlash = "[effects.backlash.X]\nreversal_um = 12\ntake_up_mm = 0.0025\n"
    job, effects = job_with(tmp_path, SQUARE, backlash)
    found = compensate(job, effects, resolution_mm=1e-4)
    # the carriage stays behind by half of the reversal value, on the side that it comes from
    assert numbers(found.text, "X")[-2:] == [60.006, -0.006]
    assert numbers(found.text, "Y")[-2:] == [40.0, 0.0]
    assert found.growth == 1.0, "the play of X is taken up along X, where it cuts nothing"


def test_a_correction_that_turns_an_axis_back_does_not_chatter(tmp_path):
    # Y stands after it has come from below; the bow of X moves it down again by micrometres
    effects_text = (
        "[effects.backlash.Y]\nreversal_um = 10\ntake_up_mm = 0.0025\n"
        "[effects.scale.Y]\nscale_ppm = 100\n"
    )
    body = "G1 Z-1. F1000\nY20.\nX50. Y19.999\nX100. Y19.998\nM30\n"
    job, effects = job_with(tmp_path, body, effects_text)
    found = compensate(job, effects, resolution_mm=1e-5)
    y = numbers(found.text, "Y")
    # going up Y is programmed half the reversal value higher, going down that much lower
    scale = 1.0 + 1e-4
    assert abs(y[-3 if found.growth > 1 else -2] - ((69.999 - 0.005) / scale - 50)) < 0.2e-3
    assert abs(y[-1] - ((69.998 - 0.005) / scale - 50)) < 0.2e-3
    assert found.steps <= 1
    assert found.unrounded.mean_mm < 1e-4


def test_a_correction_that_turns_an_axis_before_a_cut_gets_a_step_though_play_takes_way(tmp_path):
    # on the way down X is corrected by micrometres against its way; the cut turns it once more
    effects_text = (
        "[effects.backlash.X]\nreversal_um = 8\ntake_up_mm = 0.005\n"
        "[effects.squareness.B0Z]\nsquareness_urad = -100\n"
    )
    body = "G0 X-20. Z60.\nG0 X0.\nG0 Z2.\nG1 Z-1. F200\nX20. Y40.\nM30\n"
    job, effects = job_with(tmp_path, body, effects_text)
    found = compensate(job, effects)
    assert found.steps == 1
    # half as much, times e^-1, as the way over which it is taken up leaves of a step of its length
    assert found.unrounded.largest_mm < 0.005 / np.e


def test_lag_on_circles_makes_larger_circles(tmp_path):
    lag_ms2, feed, radius = 400.0, 3000.0, 30.0
    body = f"G1 Z-1. F{feed}\nG2 X0. Y0. I{radius} J0.\nM30\n"
    job, effects = job_with(tmp_path, body, f"[effects.servo_lag]\nlag_ms2 = {lag_ms2}\n")
    found = compensate(job, effects, resolution_mm=1e-5)
    x = numbers(found.text, "X")
    # r' - (v^2 / r') / (2 Kv^2) = r
    towards = 0.5e-6 * lag_ms2 * (feed / 60) ** 2 / radius
    assert abs(min(x) + towards) < 2e-5
    assert found.steps == 1, "the lag begins and ends with the circle"
    assert found.unrounded.largest_mm < 1e-4


def test_lost_motion_on_a_small_circle_is_told_from_the_lag_that_turns_with_it(tmp_path):
    # arcs of some hundredths, cut in place of a step, would have a lag that follows their rounding
    effects_text = (
        "[effects.servo_lag]\nlag_ms2 = 60\n"
        "[effects.backlash.Y]\nreversal_um = 6\ntake_up_mm = 0.003\n"
        "[effects.scale.X]\nscale_ppm = 40\n"
    )
    body = "G1 Z-1. F300\nG1 X2. F1500\nG3 X2. Y0. I-2.\nG1 X8.\nG3 X8. Y0. I-8.\nM30\n"
    job, effects = job_with(tmp_path, body, effects_text)
    found = compensate(job, effects)
    assert found.largest_correction_mm < 0.02
    assert found.after.largest_mm < 3e-3


def test_what_is_faster_than_a_block_is_named_by_line(tmp_path):
    backlash = "[effects.backlash.X]\nreversal_um = 12\ntake_up_mm = 0.005\n"
    body = "G1 Z-1. F1000\nX60.\nY40.\nX0. Y30.\nY0.\nM30\n"
    job, effects = job_with(tmp_path, body, backlash)
    found = compensate(job, effects)
    assert set(found.uncorrected) == {11}
    size, why = found.uncorrected[11]
    assert 1e-4 < size < 3e-3
    assert "lost motion" in why
    assert found.steps == 1
