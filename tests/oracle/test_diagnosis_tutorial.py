"""The tutorial's case: the sample's hidden cause is found, added, and then nothing is left."""

from __future__ import annotations

from pathlib import Path

import pytest

from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.history import history_of
from vmach.history.added_effects import add_effects

SAMPLE = Path(__file__).parents[2] / "samples" / "missing_effect"


def test_lost_motion_of_the_sample_is_found_and_added(tmp_path):
    found = diagnose(survey_job(SAMPLE))
    assert found.verdict == "named"
    assert [(f.name, f.target) for f in found.findings] == [("backlash", "Y")]
    job, (effect,) = add_effects(SAMPLE, ["backlash:Y"], out=tmp_path / "lost-motion.toml")
    # 7 um is what samples/missing_effect/make_measurements.py hides
    assert effect.parameters["reversal_um"] == pytest.approx(7.0, abs=3 * effect.u["reversal_um"])
    steps = history_of(job)
    assert steps[0].rms_um == pytest.approx(1.99, abs=0.02)
    assert steps[1].rms_um == pytest.approx(0.82, abs=0.02)
