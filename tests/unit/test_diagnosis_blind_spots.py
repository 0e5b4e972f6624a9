"""What is said to go unseen does not contradict what the same readings show."""

import numpy as np
import pytest

from tests.unit.test_diagnosis_verdicts import tip_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.next_test.blind_spots import blind_spots
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.diagnosis.search import prepare_search


def leaning(q, side, time):
    """Y leans by 64 urad against X."""
    return np.outer(0.064 * q[:, 1], [1.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def offset_only(tmp_path_factory):
    """Its file holds a rotation that `frame = "offset"` does not leave free: no law fits."""
    job = tip_job(tmp_path_factory.mktemp("tip"), leaning)
    job.write_text(job.read_text().replace('"rigid"', '"offset"'))
    return survey_job(job)


def test_an_effect_that_hides_behind_what_comes_nearest_is_said_to(offset_only):
    found = diagnose(offset_only)
    assert found.verdict == "unknown"
    (spot,) = (b for b in found.blind_spots if b.label == "squareness B0Z")
    assert spot.from_size_alone < 10.0 < 64.0 < spot.from_size
    assert "on alone, from " in spot.text and spot.text.endswith("are 30 urad")
    assert "beside what comes nearest" in spot.text
    for one in found.blind_spots:
        assert one.from_size_alone is None or one.from_size_alone <= (one.from_size or np.inf)


def test_what_was_found_is_named_as_what_hides_others(tmp_path):
    """With the pose free, the squareness of Y is a rotation away from a bent straightness."""
    search = prepare_search(survey_job(tip_job(tmp_path, leaning)))
    explanation = search.extend(search.nothing, search.index_of("component EXY"))
    texts = {b.label: b.text for b in blind_spots(search, explanation)}
    assert " on alone, " in texts["squareness C0Y"]
    assert "beside component EXY; usual are 30 urad" in texts["squareness C0Y"]
