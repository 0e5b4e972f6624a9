"""Runs of a laser whose table holds no times, on a screw that warms: simulated here by itself."""

import numpy as np
import pytest

from tests.hidden_effects.program_runs import diagnose
from tests.small_job import measurement, write_job
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.fit.clocks import by_other_clocks, in_likeliest_order
from vmach.fit.survey import Survey
from vmach.instruments import read_instruments
from vmach.job import read_job

PLACES = np.linspace(-380.0, -20.0, 19)
RUNS = 5
#: what is simulated: s at each place, um, um/m, s, um
STOP_S, LOST_UM, STRETCH_UM_PER_M, SETTLES_S, NOISE_UM = 8.0, 9.0, 45.0, 1100.0, 0.5


def readings(first, seed=0):
    """(run, side) to readings in the order of the places, each run begun from a side, um."""
    random, found, time_s = np.random.default_rng(seed), {}, 0.0
    for run in range(1, RUNS + 1):
        for side in (first, -first):
            value = np.empty(len(PLACES))
            for k in range(len(PLACES))[::side]:
                warm = 1e-3 * STRETCH_UM_PER_M * PLACES[k] * -np.expm1(-time_s / SETTLES_S)
                value[k] = warm - side * LOST_UM / 2 + NOISE_UM * random.standard_normal()
                time_s += STOP_S
            found[run, side] = value
    return found


def side_by_side(folder, first, seed=0):
    """A job with the table as ISO 230-2 prints it."""
    found, words = readings(first, seed), {1: "forward", -1: "backward"}
    columns = [(run, side) for run in range(1, RUNS + 1) for side in (1, -1)]
    lines = ["position_mm," + ",".join(f"{words[side]}_{run}" for run, side in columns)]
    for k, place in enumerate(PLACES):
        lines.append(f"{place:.1f}," + ",".join(f"{found[own][k]:.2f}" for own in columns))
    laser = measurement("laser", axis="X", at_mm=[-200, -150, -150], u_um=NOISE_UM)
    job = write_job(folder, more=laser)
    kept = [line for line in job.read_text().splitlines() if not line.startswith("measured")]
    job.write_text("\n".join(kept) + "\n")
    (folder / "laser.csv").write_text("\n".join(lines) + "\n")
    return job


@pytest.mark.parametrize(("first", "said"), [(1, "forward first"), (-1, "backward first")])
def test_lost_motion_is_told_whichever_side_runs_began_from(tmp_path, first, said):
    """In the other order it would be wrong by what the screw stretches from run to run."""
    side_by_side(tmp_path, first)
    report, _ = diagnose(tmp_path)
    found = {e["effect"]: e for e in report["effects"]}
    low, high = found["backlash"]["interval_95"]["reversal_um"]
    assert low < LOST_UM < high and high - low < 0.3 * LOST_UM
    # 5 s a stop are taken, 8 s were: a time constant is known no better than that
    low, high = found["axis_expansion"]["interval_95"]["time_constant_s"]
    assert low < SETTLES_S < high
    (note,) = [n for n in report["notes"] if "no times" in n]
    assert said in note and "State t_s" in note


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("first", [1, -1])
def test_readings_tell_the_order_of_runs_on_a_screw_that_warms(tmp_path, first, seed):
    (laser,) = survey_job(side_by_side(tmp_path, first, seed)).measurements
    assert laser.assumed.clock.first == first
    # the true order: what the first run read comes first
    kept = readings(first, seed)[1, first][::first]
    np.testing.assert_allclose(1e3 * laser.measured_mm[: len(PLACES)], kept, atol=0.006)


def test_without_warmth_no_order_is_taken_for_the_customary_one(tmp_path):
    """Nothing drifts: both orders say the same, and forward comes first by custom."""
    job = side_by_side(tmp_path, 1)
    lines = (tmp_path / "laser.csv").read_text().splitlines()
    cold = [lines[0]]
    for k, line in enumerate(lines[1:]):
        sides = [-LOST_UM / 2, LOST_UM / 2] * RUNS
        chance = np.random.default_rng(k).standard_normal(2 * RUNS)
        row = np.array(sides) + NOISE_UM * chance
        cold.append(line.split(",")[0] + "," + ",".join(f"{v:.2f}" for v in row))
    (tmp_path / "laser.csv").write_text("\n".join(cold) + "\n")
    (laser,) = survey_job(job).measurements
    assert laser.assumed.clock.first == 1.0


def test_other_clocks_read_the_same_readings_in_the_same_rows(tmp_path):
    job = read_job(side_by_side(tmp_path, 1))
    survey = Survey(job, read_instruments(job), ())
    taken, length_s = survey.measurements[0], np.ptp(survey.paths[0].time_s)
    others = list(by_other_clocks(survey))
    for other in others:
        (laser,) = other.survey.measurements
        np.testing.assert_array_equal(laser.id, taken.id)
        np.testing.assert_array_equal(laser.measured_mm, taken.measured_mm)
        np.testing.assert_array_equal(laser.states.nose_mm, taken.states.nose_mm)
        # lost motion is of the side, not of the clock
        sides = [s.paths[0].play_side[1:, 0] for s in (survey, other.survey)]
        np.testing.assert_array_equal(*sides)
    times = [np.ptp(other.survey.paths[0].time_s) / length_s for other in others]
    # 2 and 12.5 s in place of 5 s, less the ways between; runs from the other side take as long
    assert times[0] == pytest.approx(0.4, abs=0.02) and times[1] == pytest.approx(2.5, abs=0.05)
    assert times[2] == pytest.approx(1.0, abs=0.01)
    # three nodes of Gauss and Hermite; a run begins forward three times out of four
    assert [other.weight for other in others] == pytest.approx([0.25, 0.25, 1 / 3])


def test_a_table_with_times_has_no_other_clock(tmp_path):
    job = side_by_side(tmp_path, 1)
    rows, time_s = ["run,position_mm,approach,t_s,deviation_um"], 0.0
    for (run, side), value in readings(1).items():
        for k in range(len(PLACES))[::side]:
            rows.append(f"{run},{PLACES[k]:.1f},{side},{time_s:.1f},{value[k]:.2f}")
            time_s += STOP_S
    (tmp_path / "laser.csv").write_text("\n".join(rows) + "\n")
    survey = survey_job(job)
    assert survey.measurements[0].assumed is None and not list(by_other_clocks(survey))
    assert in_likeliest_order(survey).measurements == survey.measurements
