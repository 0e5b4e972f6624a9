"""Tests of a machine at places, times and feeds that it cannot have had are refused."""

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from vmach.errors import InputError
from vmach.instruments import read_instruments
from vmach.job import read_job

LASER = measurement("laser", file="test.csv", axis="X", at_mm=[0, -100, -50])
BALLBAR = measurement("ballbar", file="test.csv", centre_mm=[-200, -150, -100], radius_mm=100)
DRIFT = measurement("drift", file="test.csv", at_mm=[-200, -150, -100])


def laser(position_mm=lambda x: x, time_s=lambda t: t):
    rows = ["run,position_mm,approach,t_s,deviation_um"]
    for k, x in enumerate(np.linspace(-390.0, -10.0, 9)):
        rows.append(f"1,{position_mm(x):.6f},1,{time_s(5.0 * k)},{k % 2}")
    return "\n".join(rows)


def ballbar(*, degrees=1.0, seconds=1.0, feed_mm_min=1000):
    """Both ways round at 1000 mm/min on a radius of 100 mm: 37.7 s a turn."""
    turn = np.linspace(0.0, 355.0, 72)
    rows = ["run,feed_mm_min,angle_deg,t_s,radius_um"]
    for run, start, way in (("ccw", 0.0, turn), ("cw", 50.0, turn[::-1])):
        rows += [
            f"{run},{feed_mm_min},{degrees * a:.6f},{seconds * (start + 0.5236 * k):.6f},{k % 2}"
            for k, a in enumerate(way)
        ]
    return "\n".join(rows)


def read(folder, job, text):
    (folder / "test.csv").write_text(text)
    return read_instruments(read_job(write_job(folder, more=job)))


@pytest.mark.parametrize(
    ("job", "text", "message"),
    [
        (LASER, laser(lambda x: x * 1e-3), "within 0.38 mm.*in metres"),
        (LASER, laser(lambda x: -x), r"test\.csv:2: X of the spindle nose is 390 mm, outside"),
        (LASER.replace('"X"', '"Y"'), laser(), r"csv:2: Y of .* -390 mm.*-300 \.\. 0 mm"),
        (LASER, laser(time_s=lambda t: 40 - t), r"csv:3: t_s is 35 after 40;.* the order of time"),
        (LASER, laser(time_s=lambda t: t - 8), r"csv:2: t_s is -8 after 0"),
        (DRIFT.replace("[-200,", "[200,"), "t_s,spindle_rpm,dx_um,dy_um,dz_um\n0,0,0,0,0\n",
         r"csv:2: X of .* 200 mm, outside"),
        (BALLBAR.replace("[-200,", "[-50,"), ballbar(), r"csv:2: X of .* 50 mm, outside"),
        (BALLBAR, ballbar(degrees=np.pi / 180), r"csv:2: run 'ccw 1000.0' turns by 6.196 degrees"),
        (BALLBAR, ballbar(seconds=1 / 60), "1000 mm/min .*times in seconds"),
        (BALLBAR, ballbar(feed_mm_min=1), "accepted: about feed_mm_min, 1 mm/min"),
        (BALLBAR.replace("radius_mm = 100", "radius_mm = 0.1"), ballbar(), "the radius in mm"),
    ],
)  # fmt: skip
def test_what_cannot_have_been_is_refused(tmp_path, job, text, message):
    with pytest.raises(InputError, match=message):
        read(tmp_path, job, text)


@pytest.mark.parametrize(("job", "text"), [(LASER, laser()), (BALLBAR, ballbar())])
def test_sound_tests_pass_without_a_note(tmp_path, job, text):
    (test,) = read(tmp_path, job, text)
    assert test.notes == ()
