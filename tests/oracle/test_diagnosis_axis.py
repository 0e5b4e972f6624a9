"""An axis as a shop finds it: no table, slow errors, lost motion, runs that drift.

Source: closed forms written here: a parabola with a wave, half the lost motion on either side
(ISO 230-2, reversal B), a drift that slows from run to run, stops with errors of their own.
"""

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.fit.noise.discrepancy import members_of
from vmach.history.rounds import add_in_rounds

#: of the axis: slow error over its travel, lost motion, drift over five runs, scatter of a stop
SLOW_UM, LOST_UM, DRIFT_UM, STOP_UM = 60.0, 25.0, 3.0, 0.7
RUNS = 5


def axis_job(folder, axis, *, u_um, seed, local_um=0.0, varies=0.0, tabled=False):
    """Five bidirectional runs along an axis of a machine without tables, zero at the first stop.

    Each stop has an error of its own that every run repeats; the lost motion varies by a share.
    With a table of the axis, which says zero, there is no slow error.
    """
    middle = [-200, -150, -150]
    more = measurement("laser", axis=axis, at_mm=middle, u_um=u_um)
    errors = {f"E{axis}{axis}": (np.zeros_like, None)} if tabled else None
    job = write_job(folder, errors, more=more)
    text = [line for line in job.read_text().splitlines() if not line.startswith("measured")]
    job.write_text("\n".join(text) + "\n")
    random = np.random.default_rng(seed)
    place = np.linspace(-380.0 if axis == "X" else -280.0, 0.0, 20)
    share = np.linspace(0.0, 1.0, 20)
    slow = SLOW_UM * (0.9 * share**2 + 0.1 * np.sin(8.0 * share + 1.0)) * (not tabled)
    lost = LOST_UM * (1.0 + varies * np.sin(5.0 * share))
    slow = slow + local_um * random.standard_normal(20)
    rows = []
    for run in range(RUNS):
        drift = DRIFT_UM * (run / (RUNS - 1)) ** 0.7
        for side, order in ((1, range(20)), (-1, reversed(range(20)))):
            for i in order:
                chance = STOP_UM * random.standard_normal()
                rows.append(
                    (run + 1, place[i], side, slow[i] - side * lost[i] / 2 + drift + chance)
                )
    lines = [
        f"{n},{x},{way},{8.0 * k},{v - rows[0][3]:.3f}" for k, (n, x, way, v) in enumerate(rows)
    ]
    header = "run,position_mm,approach,t_s,deviation_um"
    (folder / "laser.csv").write_text("\n".join([header, *lines]) + "\n")
    return job


@pytest.mark.parametrize(("axis", "u_um"), [("X", 0.5), ("X", 1.0), ("Y", 3.0), ("Z", 5.0)])
def test_lost_motion_is_shown_whatever_uncertainty_is_stated(tmp_path, axis, u_um):
    found = diagnose(survey_job(axis_job(tmp_path, axis, u_um=u_um, seed=11)))
    assert found.verdict in ("named", "class", "partly")
    (lost,) = [f for f in found.findings if f.name == "backlash"]
    assert (lost.target, lost.status) == (axis, "shown")
    assert lost.parameters["reversal_um"] == pytest.approx(LOST_UM, abs=1.0)
    (slow,) = [f for f in found.findings if f.name == "component"]
    # a laser reads the positioning error, whatever tilt does the same to its line (ISO 230-1)
    assert slow.target == f"E{axis}{axis}"
    assert found.remains_um < 4.0 and found.rms_um["after"] < 4.0


@pytest.mark.parametrize("seed", [21, 22, 23])
def test_short_errors_that_every_run_repeats_are_no_cyclic_pitch(tmp_path, seed):
    """Twenty stops with 2 um each: runs that repeat them say nothing of a law that they follow."""
    found = diagnose(survey_job(axis_job(tmp_path, "X", u_um=1.0, seed=seed, local_um=2.0)))
    names = {f.name for f in found.findings}
    assert "backlash" in names and not names & {"cyclic_pitch", "hysteresis", "axis_expansion"}
    assert 1.0 < found.remains_um < 4.0


@pytest.mark.parametrize("seed", [31, 32, 33])
def test_lost_motion_that_varies_along_an_axis_is_shown_by_its_mean(tmp_path, seed):
    """A form that holds lost motion and more, as a curve of it does, does not take its place."""
    found = diagnose(survey_job(axis_job(tmp_path, "X", u_um=0.5, seed=seed, varies=0.2)))
    (lost,) = [f for f in found.findings if f.name == "backlash"]
    share = np.linspace(0.0, 1.0, 20)
    mean_um = LOST_UM * (1.0 + 0.2 * np.sin(5.0 * share).mean())
    assert lost.parameters["reversal_um"] == pytest.approx(mean_um, abs=2.0)


def test_variation_of_lost_motion_has_no_part_of_its_mean(tmp_path):
    """ISO 230-2: the mean reversal value of an axis is that of its positions, each once."""
    survey = survey_job(axis_job(tmp_path, "X", u_um=1.0, seed=11))
    members = members_of(survey)
    varies = members.columns_mm[members.names.index("reversals")]
    side = np.genfromtxt(tmp_path / "laser.csv", delimiter=",", names=True)["approach"]
    np.testing.assert_allclose(side @ varies, 0.0, atol=1e-9 * np.abs(varies).sum())


@pytest.mark.parametrize("u_um", [0.5, 1.0, 3.0, 5.0])
def test_lost_motion_is_the_result_of_a_test_of_its_own(tmp_path, u_um):
    """A table does not say how much an axis has today, and local errors are no doubt about it."""
    job = axis_job(tmp_path, "Y", u_um=u_um, seed=41, local_um=3.0, varies=0.15, tabled=True)
    found = diagnose(survey_job(job))
    assert [(f.name, f.target) for f in found.findings] == [("backlash", "Y")]
    assert found.findings[0].parameters["reversal_um"] == pytest.approx(25.5, abs=2.0)
    assert found.remains_um < 4.0


def test_an_axis_without_a_table_gets_a_map_and_its_lost_motion(tmp_path):
    """What was found is added in rounds until nothing is left; 4 um of 23 at most remain."""
    last = add_in_rounds(axis_job(tmp_path, "X", u_um=1.0, seed=12)).steps[-1]
    text = last.job.read_text()
    assert "[effects.backlash.X]" in text and "[effects.component." in text
    assert last.after_um < 4.0
