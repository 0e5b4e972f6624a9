"""A weighing that makes room for another one comes back as it was."""

import numpy as np
import pytest

from tests.unit.test_diagnosis_verdicts import stretched_and_loose, tip_job
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.residuals.job_survey import survey_job


@pytest.mark.parametrize("many", [False, True])
def test_what_was_put_away_is_asked_back(tmp_path, monkeypatch, many):
    """Of many readings the signatures are gone meanwhile, and each candidate says the same then."""
    if many:
        monkeypatch.setattr("vmach.diagnosis.inference.weighing._LOOKED_OVER", 50)
    weighing = prepare_weighing(survey_job(tip_job(tmp_path, stretched_and_loose)))
    here = weighing.small()
    before, labels = weighing.gains(here), [c.label for c in weighing.candidates]
    asked_back = weighing.put_away()
    assert len(weighing.candidates) == (0 if many else len(labels))
    again = asked_back()
    assert [c.label for c in again.candidates] == labels
    np.testing.assert_array_equal(again.gains(here), before)
