"""Files of a ballbar as they come: runs that turn back, rows that are missing."""

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from vmach.effects import set_up_effect
from vmach.errors import InputError
from vmach.instruments import read_instruments
from vmach.job import read_job

BALLBAR = measurement("ballbar", plane="XY", centre_mm=[-200, -150, -100], radius_mm=100)
SQUARENESS_URAD = 30.0
#: one turn in a minute: 2 pi 100 mm
FEED, STEP_S = 628.3, 1.0 / 6.0


def rows(names, senses, kept=lambda angle: True, head="run,feed_mm_min,angle_deg,t_s,radius_um"):
    """Turns of 360 degrees, one after the other, on a machine out of square in XY."""
    lines, clock = [head], 10.0
    for name, sense in zip(names, senses, strict=True):
        for angle in range(361):
            turned = np.radians(sense * angle)
            # dx = -C0Y y along the bar, from the centre
            read = -SQUARENESS_URAD * 0.1 * np.sin(turned) * np.cos(turned)
            if kept(angle):
                lines.append(f"{name},{FEED},{sense * angle % 360},{clock:.4f},{read:.5f}")
            clock += STEP_S
        clock += 5.0
    return lines


def read(tmp_path, lines):
    job_path = write_job(tmp_path, more=BALLBAR)
    (tmp_path / "ballbar.csv").write_text("\n".join(lines) + "\n")
    job = read_job(job_path)
    square = set_up_effect("squareness", "C0Y", {"squareness_urad": SQUARENESS_URAD}, job=job)
    return read_instruments(job, effects=[square])[0]


def left_um(test):
    free = test.nuisance
    apart = test.measured_mm - test.predicted_mm
    return 1e3 * np.abs(apart - free @ np.linalg.lstsq(free, apart, rcond=None)[0]).max()


@pytest.mark.parametrize("overshoot", [0, 1])
def test_a_run_that_turns_back_is_refused_where_it_does(tmp_path, overshoot):
    """Both senses under one name: the way back would be read as the way on."""
    lines = rows(["1", "1"], [1, -1])
    lines = lines if not overshoot else lines[:-overshoot]
    with pytest.raises(InputError, match=r"ballbar\.csv:363: run '1' turns back") as caught:
        read(tmp_path, lines)
    assert "names of their own" in str(caught.value)


def test_lines_are_those_of_the_file(tmp_path):
    lines = rows(["1", "1"], [1, -1])
    with pytest.raises(InputError, match=r"ballbar\.csv:366: run '1' turns back"):
        read(tmp_path, [lines[0], "", "", "", *lines[1:]])


@pytest.mark.parametrize("sense", [1, -1])
def test_the_time_tells_how_far_missing_rows_reach(tmp_path, sense):
    """Two hundred degrees without readings: the shorter way round would be the wrong one."""
    gap = rows(["1", "2"], [sense, sense], kept=lambda angle: not 70 < angle < 270)
    test = read(tmp_path, gap)
    assert left_um(test) < 0.02
    middle = test.states.nose_mm[:, :2] - [-200.0, -150.0]
    angle = np.radians([float(line.split(",")[2]) for line in gap[1:]])
    circle = 100.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    np.testing.assert_allclose(middle, circle, atol=0.01)


def test_a_run_in_which_no_time_passes(tmp_path):
    lines = rows(["1"], [1])
    with pytest.raises(InputError, match=r"ballbar\.csv:2: no time passes in run '1'"):
        read(tmp_path, [lines[0], *[f"1,{FEED},{a},10.0,{a}" for a in range(20)]])


def test_a_run_that_stands(tmp_path):
    with pytest.raises(InputError, match=r"ballbar\.csv:2: run '1' does not turn"):
        lines = rows(["1"], [1])
        read(tmp_path, [lines[0], *[f"1,{FEED},30,{a},{a}" for a in range(20)]])
