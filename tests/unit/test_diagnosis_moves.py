"""The search goes on from what was chosen too early."""

from dataclasses import replace

import numpy as np

from tests.unit.test_diagnosis_verdicts import tip_job
from vmach.diagnosis.inference.moves import search_beyond
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import catalogue
from vmach.fit.evidence import WIDTHS


def dent_and_play(q, side, time):
    """A dent of 20 um in the positioning of X, and 6 um of lost motion there."""
    x_um = 20.0 * np.exp(-(((q[:, 0] + 200.0) / 60.0) ** 2)) - 3.0 * side[:, 0]
    return np.stack([x_um, 0.0 * x_um, 0.0 * x_um], axis=1)


def test_the_size_of_a_curve_that_was_chosen_too_early_is_chosen_afresh(tmp_path):
    effects = [catalogue()["component"], catalogue()["backlash"]]
    survey = survey_job(tip_job(tmp_path, dent_and_play, count=150))
    weighing = prepare_weighing(survey, effects)
    curve, play = (weighing.index_of(label) for label in ("component EXX", "backlash X"))
    small = weighing.small()
    early = replace(weighing.term(curve, small), width=WIDTHS[0])
    here = weighing.extend(weighing.explain([early], small.posterior.sizes), play)
    found = search_beyond(weighing, here)
    assert found.labels == here.labels == {"component EXX", "backlash X"}
    assert next(t for t in found.terms if t.label == "component EXX").width > WIDTHS[0]
    assert found.score > here.score + 5.0
