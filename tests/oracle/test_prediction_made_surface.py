"""Contacts that compete for the points of a groove's floor, against a walk over the tool's way.

The oracle moves a flat disc along the groove in small steps and keeps the lowest height.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.small_job import write_job
from vmach.diagnosis.inference import own_contacts
from vmach.diagnosis.inference.own_contacts import chosen_by_one, over_own_contacts
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import EffectInstance, catalogue

RADIUS_MM, NOISE_UM = 5.0, 0.3
#: the tool comes from the right, plunges at X 0 and cuts to the right: X reverses there
PROGRAM = """\
%
G21 G17 G90 G94 G40
T1 M6
S6000 M3
G54 G43 H1
G0 X30 Y0 Z5
X0
G1 Z-2 F300
X40 F600
G0 Z5
X30 Y15
X40
G1 Z-2 F300
X0 F600
G0 Z5
X30 Y-15
X40
G1 Z-2 F300
X0 F600
G0 Z5
M5
M30
%
"""
GROOVES = ((0.0, 0.0, 40.0), (15.0, 40.0, 0.0), (-15.0, 40.0, 0.0))  # Y, begin and end in X
PLACES = (1.0, 3.0, 4.5, 5.0, 8.0, 15.0, 25.0, 35.0)  # from the begin; the tool just reaches 5


def height_um(play_um, place, sense):
    """The lowest of all heights of a disc, its outermost 0.2 mm left out, over a floor point."""
    tip = np.arange(0.0, 40.0, 0.01)
    over = np.abs(tip - place) < RADIUS_MM - 0.2
    side = np.where(tip < 0.005, -sense, sense)  # it lies against the old side where it reverses
    return (0.5 * play_um * side[over]).min()


@pytest.fixture
def job(tmp_path):
    path = write_job(tmp_path)
    (tmp_path / "part.nc").write_text(PROGRAM)

    def measured(play_um, noise_um=0.0):
        rows, random = ["id,feature,x,y,z,i,j,k,mx,my,mz,u_um"], np.random.default_rng(4)
        for y, begin, end in GROOVES:
            sense = float(np.sign(end - begin))
            for place in PLACES:
                x = begin + sense * place
                z = -2.0 + 1e-3 * (height_um(play_um, place, sense) + noise_um * random.normal())
                point = f"{x},{y},-2.0,0,0,1,{x},{y},{z:.7f}"
                rows.append(f"{len(rows)},groove {y:g},{point},{NOISE_UM}")
        (tmp_path / "points.csv").write_text("\n".join(rows))
        return path

    return measured


def play(survey, play_um):
    parameters = {"play_um": play_um, "take_up_mm": 0.0025}
    return EffectInstance(catalogue()["lateral_play"], "XZ", parameters, survey.job)


def foretold_um(survey, play_um):
    return at_contacts_um(survey.made_beside([play(survey, play_um)]), play_um)


def at_contacts_um(survey, play_um):
    """Over the contacts that the survey has."""
    effect, (part,) = play(survey, play_um), survey.measurements
    return 1e3 * (part.predicted_mm + effect.at(survey.paths[0], effect.parameters)[:, 2])


@pytest.mark.parametrize("play_um", [10.0, -10.0])
def test_of_several_contacts_the_lowest_makes_a_floor(job, play_um):
    survey = survey_job(job(play_um))
    true = [
        height_um(play_um, p, np.sign(end - begin)) for _, begin, end in GROOVES for p in PLACES
    ]
    np.testing.assert_allclose(foretold_um(survey, play_um), true, atol=0.05)


def test_an_explanation_is_weighed_over_the_surface_that_it_leaves(job):
    survey = survey_job(job(10.0, NOISE_UM))
    weighing = prepare_weighing(survey, [catalogue()["lateral_play"]])
    found = weighing.extend(weighing.nothing(), weighing.index_of("lateral_play XZ"))
    other, again = over_own_contacts(weighing, found)
    assert other is not weighing
    assert again.score > found.score + CLEARLY
    assert again.fit.parameters(0)["play_um"] == pytest.approx(10.0, abs=0.6)


def test_an_effect_that_its_own_contacts_do_not_show_is_left_out(job, monkeypatch):
    survey = survey_job(job(10.0, NOISE_UM))
    weighing = prepare_weighing(survey, [catalogue()["lateral_play"]])
    found = weighing.extend(weighing.nothing(), weighing.index_of("lateral_play XZ"))
    # as where a play that lifts the tool leaves the floor to another pass everywhere
    others = [c for c in weighing.candidates if c.label not in found.labels]
    monkeypatch.setattr(own_contacts, "gather_candidates", lambda *_: (others, []))
    other, again = over_own_contacts(weighing, found)
    assert other is not weighing
    assert not again.labels


def test_contacts_stay_where_a_small_effect_changes_nothing(job):
    survey = survey_job(job(0.1, NOISE_UM))
    weighing = prepare_weighing(survey, [catalogue()["lateral_play"]])
    found = weighing.extend(weighing.nothing(), weighing.index_of("lateral_play XZ"))
    assert over_own_contacts(weighing, found)[0] is weighing


def _odds(weighing):
    gains = weighing.gains(weighing.nothing())
    return gains[weighing.index_of("lateral_play XZ")]


def test_contacts_that_hide_an_effect_are_exchanged_for_its_own(job):
    weighing = prepare_weighing(survey_job(job(10.0, NOISE_UM)))
    label, survey = chosen_by_one(weighing)
    assert label.startswith("lateral_play X")
    other = prepare_weighing(survey, weighing.effects)
    sense = [np.sign(end - begin) for _, begin, end in GROOVES for _ in PLACES]
    true = [height_um(10.0, p, s) for s, p in zip(sense, 3 * PLACES, strict=True)]
    off = [np.abs(at_contacts_um(w.survey, 10.0) - true).max() for w in (weighing, other)]
    assert off[1] < 0.05 < 2.0 < off[0]
    assert _odds(other) > _odds(weighing) + CLEARLY


def test_other_contacts_are_not_looked_at_without_need(job):
    assert chosen_by_one(prepare_weighing(survey_job(job(0.0, NOISE_UM)))) is None
