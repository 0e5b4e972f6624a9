"""Many readings are searched over some of them first, and what that finds is fitted to all."""

import numpy as np

from tests.unit.test_diagnosis_verdicts import stretched_and_loose, tip_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.residuals.job_survey import survey_job


def test_every_stretch_of_every_feature_keeps_a_reading(tmp_path):
    survey = survey_job(tip_job(tmp_path, stretched_and_loose))
    few = survey.thinned(40)
    for whole, some in zip(survey.measurements, few.measurements, strict=True):
        many = max(len(whole) // 40, 1)
        assert len(some) in (len(whole) // many, -(-len(whole) // many))
        at = {value: k for k, value in enumerate(whole.measured_mm)}
        rows = [at[value] for value in some.measured_mm]
        assert rows == sorted(set(rows))
        np.testing.assert_array_equal(whole.id[rows], some.id)
        np.testing.assert_array_equal(whole.sensing[rows], some.sensing)
        for feature in np.unique(whole.group):
            own = np.count_nonzero(whole.group == feature)
            kept = np.count_nonzero(some.group == feature)
            assert abs(kept - own / many) <= 2.0


def test_few_readings_are_all_kept(tmp_path):
    survey = survey_job(tip_job(tmp_path, stretched_and_loose))
    assert survey.thinned(len(survey) // 2 + 1) is survey


def test_what_some_readings_tell_is_told_of_all(tmp_path, monkeypatch):
    survey = survey_job(tip_job(tmp_path, stretched_and_loose))
    said = diagnose(survey)
    monkeypatch.setattr("vmach.diagnosis.inference.verdicts._SEARCHED", 40)
    also = diagnose(survey)
    assert [f.label for f in also.findings] == [f.label for f in said.findings]
    for one, other in zip(said.findings, also.findings, strict=True):
        for name, value in one.parameters.items():
            assert abs(other.parameters[name] - value) <= 0.1 * one.u[name]


def test_of_a_scan_as_many_readings_as_can_be_weighed_are_looked_at(tmp_path, monkeypatch):
    path = tip_job(tmp_path, stretched_and_loose)
    whole = survey_job(path)
    monkeypatch.setattr("vmach.diagnosis.residuals.job_survey._LOOKED_AT", 50)
    few = survey_job(path)
    assert len(whole) == 210 and len(few) == 53
    said = [note.sentence for note in few.notes if "looked at" in note.sentence]
    assert said == ["of 210 readings 53 are looked at, one of each 4 neighbours"]
    assert not any("looked at" in note.sentence for note in whole.notes)
