"""A machine with lost motion and a ballbar whose uncertainty is stated wrong, beside the right one.

The same readings are diagnosed with both.
"""

from __future__ import annotations

import pytest

from tests.hidden_effects import program_runs
from tests.hidden_effects.experiment import make_experiment
from tests.hidden_effects.part import PartDesign

SEED, TRUE_UM = 65_700_500, 0.3
INSTRUMENTS = ("ballbar_xy", "laser_X")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lost_motion") / "job"
    make_experiment(
        folder,
        effects=["backlash"],
        seed=SEED,
        design=PartDesign(),
        instruments=INSTRUMENTS,
        noise="white",
    )
    return folder


def told(folder, stated_um):
    """The effects, the width of the interval of the lost motion, and the questions."""
    job = folder / "job.toml"
    before = job.read_text()
    first = before.index("ballbar_xy.csv")
    line = f"u_um = {TRUE_UM:g}"
    assert before[first:].count(line) == 2
    job.write_text(before[:first] + before[first:].replace(line, f"u_um = {stated_um:g}", 1))
    try:
        report, _ = program_runs.diagnose(folder)
    finally:
        job.write_text(before)
    (effect,) = report["effects"]
    low, high = next(iter(effect["interval_95"].values()))
    return f"{effect['effect']}:{effect['target']}", high - low, report


@pytest.mark.parametrize("stated_um", [5.0 * TRUE_UM, TRUE_UM / 4.0])
def test_one_wrong_uncertainty_changes_no_interval(folder, stated_um):
    name, width, _ = told(folder, TRUE_UM)
    assert name.startswith("backlash:")
    other, as_wide, report = told(folder, stated_um)
    assert other == name
    # two standard uncertainties of a scatter by the median of 720 normal values are 8.6 %
    assert as_wide == pytest.approx(width, rel=0.1)
    (question,) = [note for note in report["notes"] if "too large?" in note or "too small?" in note]
    assert question.startswith("ballbar_xy.csv: its readings scatter")
    assert question.endswith("the scatter that they show is what counted")
