"""What a job's effects leave open: in `u_um` of a prediction, against sums worked out by hand."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tests.small_job import write_job
from vmach.effects import Circumstances, catalogue, read_effects
from vmach.errors import InputError
from vmach.job import read_job
from vmach.path.preparation import prepare
from vmach.run.pipeline import predict_points
from vmach.uncertainty.first_order import prediction_u_mm

LOOSE = "[effects.backlash.X]\nreversal_um = 6\n"
FITTED = '[[fitted]]\neffect = "backlash"\ntarget = "X"\none_sigma = [{rows}]\n'


def foretold(folder, more):
    folder.mkdir()
    job = write_job(folder, more=more)
    points, prediction = predict_points(job, folder / "points.csv")
    return points.normal[prediction.is_cut], prediction_u_mm(prediction)


def test_uncertain_parameters_are_in_the_uncertainty_of_a_prediction(tmp_path):
    """Two independent changes of the reversal value, 3 and 4 um: half of 5 um on walls along X."""
    fitted = FITTED.format(rows="{reversal_um = 3.0}, {reversal_um = 4.0}")
    normal, sure = foretold(tmp_path / "sure", LOOSE)
    _, open_ = foretold(tmp_path / "open", LOOSE + fitted)
    flat = np.abs(normal).max(axis=1) == 1.0  # in the bore X has just turned back here and there
    added = np.sqrt(open_**2 - sure**2)[flat]
    np.testing.assert_allclose(added, 2.5e-3 * np.abs(normal[flat, 0]), rtol=1e-3, atol=1e-9)


def test_what_a_law_leaves_open_is_in_it_too(tmp_path):
    """Spindle growth is inexact by a fifth of what the spindle has grown until then."""
    growth = (  # large, so that nothing else is in the uncertainty to speak of
        "[effects.spindle_growth.Z]\ngrowth_um = 3000\ntime_constant_s = 900\n"
        "speed_exponent = 0.7\n"
    )
    folder = tmp_path / "growth"
    _, sure = foretold(tmp_path / "none", "")
    _, open_ = foretold(folder, growth)
    _, prediction = predict_points(folder / "job.toml", folder / "points.csv")
    states, normal = prediction.states, prediction.normals[prediction.is_cut]
    warm_s = states.time_s - read_job(folder / "job.toml").machine.motion.tool_change_s
    grown_mm = 3.0 * (6000 / 8000) ** 0.7 * -np.expm1(-warm_s / 900)
    added = np.sqrt(open_**2 - sure**2)
    floors = normal[:, 2] > 0.99
    np.testing.assert_allclose(added[floors], 0.2 * grown_mm[floors], rtol=0.01)


@pytest.mark.parametrize("name", ["backlash", "hysteresis", "quadrant_glitch"])
def test_where_an_axis_just_turns_it_lies_on_either_side_of_its_play(tmp_path, name):
    """On one side or the other, of which the law is the mean: a draw of ten thousand."""
    written = write_job(tmp_path)
    program = tmp_path / "part.nc"
    back = "G1 X41.02\nX41.0195\nX41.019\nX41.0185\nG0 Z5\nM5"
    program.write_text(program.read_text().replace("G0 Z5\nM5", back))
    job = read_job(written)
    path = Circumstances(prepare(job).path.nodes, job)
    effect = catalogue()[name]
    stated = {p.name: p.usual for p in effect.parameters}
    law = effect.displacement(path, "X", **stated)[:, 0]
    open_ = np.sum(effect.slack(path, "X", stated) ** 2, axis=(1, 2))
    side = path.play_side[:, 0]
    crossing = (np.abs(side) < 0.999) & (np.abs(side) > 1e-6)
    assert crossing.sum() >= 2 and not open_[np.abs(side) == 1.0].any()
    for mean, own, variance in zip(side[crossing], law[crossing], open_[crossing], strict=True):
        drawn = np.where(np.random.default_rng(2).random(10_000) < 0.5 * (1.0 + mean), 1.0, -1.0)
        assert variance == pytest.approx(np.var(drawn * own / mean), rel=0.1)


def test_the_weather_of_another_day_is_foretold_by_its_size_only(tmp_path):
    """Ten thousand days of a wave with any phase, against the wave that was fitted."""
    job = read_job(write_job(tmp_path))
    path = Circumstances(prepare(job).path.nodes, job)
    effect = catalogue()["ambient_drift"]
    stated = {"sine_um": 3.0, "cosine_um": 4.0, "period_s": 3000.0}
    angle = 2 * np.pi * path.time_s[:, None] / stated["period_s"]
    phase = np.random.default_rng(1).uniform(0, 2 * np.pi, 10_000)
    days = 5e-3 * (np.sin(angle + phase) - np.sin(phase))
    apart = days - effect.displacement(path, "Z", **stated)[:, 2:]
    law = effect.slack(path, "Z", stated)[:, 2]
    found = effect.unforeseen(path, "Z", stated)[:, 2]
    expected = np.mean(apart**2, axis=1) + np.sum(law**2, axis=1)
    np.testing.assert_allclose(np.sum(found**2, axis=1), expected, rtol=0.05)


@pytest.mark.parametrize(
    ("effects", "rows", "message"),
    [
        (LOOSE, "{reversal_mm = 1.0}", "reversal_mm does not match the effect"),
        (LOOSE, "{reversal_um = [1.0, 2.0]}", "reversal_um does not match the effect"),
        ("[effects.backlash.Y]\nreversal_um = 6\n", "{reversal_um = 1.0}", "the job has not"),
        ("", "{reversal_um = 1.0}", "the job has not"),
    ],
)
def test_uncertainties_of_something_else_are_refused(tmp_path, effects, rows, message):
    job = read_job(write_job(tmp_path, more=effects + FITTED.format(rows=rows)))
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        read_effects(job.effects, file=job.path, job=job)
    assert caught.value.line is not None
