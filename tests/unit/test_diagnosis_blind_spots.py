"""What is said to go unseen does not contradict what the same readings show."""

import numpy as np

from tests.unit.test_diagnosis_verdicts import tip_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.next_test.blind_spots import blind_spots
from vmach.diagnosis.residuals.job_survey import survey_job


def leaning(q, side, time):
    """Y leans by 64 urad against X."""
    return np.outer(0.064 * q[:, 1], [1.0, 0.0, 0.0])


def test_what_is_seen_alone_is_never_said_to_need_more_than_beside_others(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, leaning)))
    assert found.blind_spots
    for one in found.blind_spots:
        assert one.from_size_alone is None or one.from_size_alone <= (one.from_size or np.inf)


def test_what_was_found_is_named_as_what_hides_others(tmp_path):
    """With the pose free, the squareness of Y is a rotation away from a bent straightness."""
    weighing = prepare_weighing(survey_job(tip_job(tmp_path, leaning)))
    explanation = weighing.extend(weighing.nothing(), weighing.index_of("component EXY"))
    texts = {b.label: b.text for b in blind_spots(weighing, explanation)}
    assert " alone, below " in texts["squareness C0Y"]
    assert "beside component EXY; usual size 30 urad" in texts["squareness C0Y"]
