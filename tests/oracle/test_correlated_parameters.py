"""Uncertainty of effects that were fitted together against least squares and draws of the laws."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import numpy as np
import pytest

from tests.small_job import write_job
from tests.unit.test_diagnosis_verdicts import tip_job
from vmach.diagnosis.named_fit import fit_named
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import load_effect_file, read_effects
from vmach.errors import InputError
from vmach.history.added_effects import add_effects
from vmach.history.set_values import set_values
from vmach.job import read_job
from vmach.run.pipeline import predict_points
from vmach.uncertainty.drawn_machine import drawn_steps
from vmach.uncertainty.first_order import prediction_u_mm
from vmach.uncertainty.monte_carlo import Plan
from vmach.uncertainty.points import draw_points

BOW = '''
from vmach import Effect, along, linear


class Bow(Effect):
    """A screw that stretches with the square of the way from home."""

    name = "bow"
    title = "a screw that stretches more the farther it is from home"
    parameters = (linear("bow_um_per_m2", "stretch over a square metre", usual=50.0),)
    targets = ("X",)

    def displacement(self, path, target, bow_um_per_m2):
        return along("X", 1e-9 * bow_um_per_m2 * path.nose_mm[:, 0] ** 2)
'''

BOTH = """
[effects.scale.X]
scale_ppm = 20
[effects.workpiece_temperature]
expansion_ppm = 15
"""
OF_SCALE = '[[fitted]]\neffect = "scale"\ntarget = "X"\none_sigma = [{scale_ppm = 4.0}]\n'
OF_PART = (
    '[[fitted]]\neffect = "workpiece_temperature"\none_sigma = [{expansion_ppm = 3.0}]\n'
)  # fmt: skip
R = -0.9
CORRELATED = (
    '[[correlated]]\neffects = ["scale:X", "workpiece_temperature"]\n'
    f"coefficients = [[{R}]]\n"
)  # fmt: skip


def predicted(folder, more):
    folder.mkdir()
    return predict_points(write_job(folder, more=more), folder / "points.csv")[1]


def u_um(folder, more):
    return 1e3 * prediction_u_mm(predicted(folder, more))


def test_correlation_is_that_of_least_squares(tmp_path):
    """Of a straight and a bent stretch of X, beside a rigid motion of the tool's readings."""
    (tmp_path / "bow.py").write_text(BOW)
    load_effect_file(tmp_path / "bow.py")
    job = tip_job(
        tmp_path, lambda q, side, time: np.outer(0.03 * q[:, 0] + 2e-4 * q[:, 0] ** 2, [1, 0, 0])
    )
    added, _ = add_effects(job, ["scale:X", "bow:X"])
    (entry,) = tomllib.loads(added.read_text())["correlated"]
    rows = np.genfromtxt(tmp_path / "tip.csv", delimiter=",", names=True)
    q = np.column_stack([rows[axis] for axis in "XYZ"])
    along_x = np.array([1.0, 0.0, 0.0])
    turns = [np.cross(axis, q) for axis in np.eye(3)]
    shifts = [np.tile(axis, (len(q), 1)) for axis in np.eye(3)]
    laws = [np.outer(1e-3 * q[:, 0], along_x), np.outer(1e-6 * q[:, 0] ** 2, along_x)]
    design = np.column_stack([column.ravel() for column in (*laws, *shifts, *turns)])
    covariance = np.linalg.inv(design.T @ design)
    wanted = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    assert abs(wanted) > 0.9
    # the sign of a direction is free: both effects have one, with the sign of its change
    signs = [np.sign(next(iter(one["one_sigma"][0].values())))
             for one in tomllib.loads(added.read_text())["fitted"]]  # fmt: skip
    assert entry["effects"] == ["scale:X", "bow:X"]
    assert signs[0] * signs[1] * entry["coefficients"][0][0] == pytest.approx(wanted, abs=0.03)


def test_u_of_a_prediction_has_the_covariance(tmp_path):
    """GUM, eq. 13: u² = a² + b² + 2 r a b, with the changes a and b that laws make, by hand."""
    none = u_um(tmp_path / "none", BOTH)
    together = u_um(tmp_path / "both", BOTH + OF_SCALE + OF_PART + CORRELATED)
    apart = u_um(tmp_path / "apart", BOTH + OF_SCALE + OF_PART)
    here = predicted(tmp_path / "here", BOTH).deviation_mm
    more = predicted(tmp_path / "more", BOTH.replace("20", "24")).deviation_mm
    warm = predicted(tmp_path / "warm", BOTH.replace("15", "18")).deviation_mm
    a, b = 1e3 * (more - here), 1e3 * (warm - here)
    # a bore is touched elsewhere when it moves: of second order
    np.testing.assert_allclose(together**2, none**2 + a**2 + b**2 + 2 * R * a * b, atol=3e-4)
    np.testing.assert_allclose(apart**2, none**2 + a**2 + b**2, atol=3e-4)
    assert np.abs(together - apart).max() > 0.03


def test_draws_have_the_covariance(tmp_path):
    """Monte Carlo of two straight laws: as first order, and parameters drawn with their r."""
    prediction = predicted(tmp_path / "both", BOTH + OF_SCALE + OF_PART + CORRELATED)
    first = prediction_u_mm(prediction)
    plan = Plan(digits=2, most_draws=100_000, least_draws=100_000)
    found = draw_points(prediction, plan)
    np.testing.assert_allclose(found.drawn.u, first, rtol=0.02)
    np.testing.assert_allclose(sum(found.share.values()), 1.0)
    assert "scale X, workpiece_temperature parameters" in found.share
    effects = prediction.effects
    steps = [drawn_steps(effects, (5, k)) for k in range(4000)]
    moved = np.array([
        [e.with_drawn(s).parameters[name] for e, s, name in
         zip(effects, some, ("scale_ppm", "expansion_ppm"), strict=True)]
        for some in steps
    ])  # fmt: skip
    np.testing.assert_allclose(moved.mean(axis=0), [20.0, 15.0], atol=0.2)
    np.testing.assert_allclose(moved.std(axis=0), [4.0, 3.0], rtol=0.04)
    assert np.corrcoef(moved.T)[0, 1] == pytest.approx(R, abs=0.02)


def test_bent_laws_have_it_too(tmp_path):
    """A growing spindle of uncertain size and time beside sag: draws of the laws themselves."""
    more = (
        "[effects.spindle_growth.Z]\ngrowth_um = 40\ntime_constant_s = 60\nspeed_exponent = 0.7\n"
        "[effects.gravity_sag.X]\nsag_um = 10\n"
        '[[fitted]]\neffect = "spindle_growth"\ntarget = "Z"\n'
        "one_sigma = [{growth_um = 8.0}, {time_constant_s = 6.0}]\n"
        '[[fitted]]\neffect = "gravity_sag"\ntarget = "X"\none_sigma = [{sag_um = 6.0}]\n'
        '[[correlated]]\neffects = ["gravity_sag:X", "spindle_growth:Z"]\n'
        "coefficients = [[0.7, -0.5]]\n"
    )
    prediction = predicted(tmp_path / "job", more)
    growth, sag = prediction.effects
    matrix = np.array([[1.0, 0.0, 0.7], [0.0, 1.0, -0.5], [0.7, -0.5, 1.0]])
    drawn = np.linalg.cholesky(matrix) @ np.random.default_rng(2).standard_normal((3, 4000))
    floor = int(np.flatnonzero(prediction.normals[prediction.is_cut][:, 2] > 0.99)[-1])
    states = prediction.states[[floor]]
    expected = [
        replace(growth, parameters={**growth.parameters, "growth_um": 40 + 8 * a,
                                    "time_constant_s": 60 + 6 * b}).displacement(states).shift_mm
        + replace(sag, parameters={"sag_um": 10 + 6 * c}).displacement(states).shift_mm
        for a, b, c in drawn.T
    ]  # fmt: skip
    plan = Plan(digits=2, most_draws=200_000, least_draws=200_000)
    found = draw_points(prediction, plan)
    # tables and what the laws leave open stand beside
    sure = [replace(effect, one_sigma=(), together=0) for effect in prediction.effects]
    beside = prediction_u_mm(replace(prediction, effects=tuple(sure)))[floor]
    wide = np.hypot(np.std([e[0, 2] for e in expected]), beside)
    assert found.drawn.u[floor] == pytest.approx(wide, rel=0.03)


def test_the_first_effect_keeps_its_changes(tmp_path):
    """Cholesky's root of [[1, r], [r, 1]]: 1, 0; r, sqrt(1 - r²)."""
    job = write_job(tmp_path, more=BOTH + OF_SCALE + OF_PART + CORRELATED)
    first, second = read_effects(read_job(job).effects, file=job, job=read_job(job))
    assert [one.get("scale_ppm", 0.0) for one in first.one_sigma] == pytest.approx([4.0, 0.0])
    wanted = [3.0 * R, 3.0 * np.sqrt(1.0 - R**2)]
    assert [one["expansion_ppm"] for one in second.one_sigma] == pytest.approx(wanted)


def test_a_value_that_is_set_has_no_correlation_any_more(tmp_path):
    job = write_job(tmp_path, more=BOTH + OF_SCALE + OF_PART + CORRELATED)
    made, _ = set_values(job, ["scale:X.scale_ppm=10"])
    told = tomllib.loads(made.read_text())
    assert [one["effect"] for one in told["fitted"]] == ["workpiece_temperature"]
    assert "correlated" not in told


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[[-0.9]]", "[[-0.9, 0.1]]", r"\[\[correlated\]\] does not match .* 1 rows of 1"),
        ("[[-0.9]]", "[[-0.9], [0.1, 0.2]]", "a list of rows of the same length"),
        ("[[-0.9]]", "[[-1.9]]", "greater than or equal to -1|-1"),
        ('"scale:X", "w', '"backlash:X", "w', "of backlash X, which has no"),
        ('"scale:X"', '"workpiece_temperature"', "two effects, as NAME:TARGET"),
    ],
)
def test_what_is_wrong_with_it_is_said(tmp_path, old, new, message):
    job = write_job(tmp_path, more=BOTH + OF_SCALE + OF_PART + CORRELATED.replace(old, new))
    with pytest.raises(InputError, match=r"job\.toml:\d+: .*" + message):
        read = read_job(job)
        read_effects(read.effects, file=job, job=read)


def test_coefficients_that_contradict_each_other(tmp_path):
    third = (
        "[effects.backlash.X]\nreversal_um = 4\n"
        '[[fitted]]\neffect = "backlash"\ntarget = "X"\none_sigma = [{reversal_um = 0.5}]\n'
    )
    more = CORRELATED + "".join(
        f'[[correlated]]\neffects = ["backlash:X", "{other}"]\ncoefficients = [[0.9]]\n'
        for other in ("scale:X", "workpiece_temperature")
    )
    job = write_job(tmp_path, more=BOTH + third + OF_SCALE + OF_PART + more)
    read = read_job(job)
    with pytest.raises(InputError, match="contradict others"):
        read_effects(read.effects, file=job, job=read)


def test_a_form_that_holds_what_is_added_does_not_take_its_place(tmp_path):
    """A stretched screw on a bed that sags: a turn about Y with its arms does both."""
    job = tip_job(tmp_path, lambda q, side, time: np.column_stack(
        [0.03 * q[:, 0], 0 * time, 1e-4 * (q[:, 0] + 200.0) ** 2]))  # fmt: skip
    (found,) = fit_named(survey_job(job), ["scale:X"])
    assert found.parameters["scale_ppm"] == pytest.approx(30.0, abs=2.0)
    # beside a sag of 4 um, of which nothing says that it has no slope
    assert found.u["scale_ppm"] < 2.0


BACKLASH = """
[effects.backlash.X]
reversal_um = 6
take_up_mm = 0.005
[[fitted]]
effect = "backlash"
target = "X"
one_sigma = [{reversal_um = 0.2}, {take_up_mm = 0.05}]
"""


def test_a_way_that_is_hardly_known_leaves_no_more_open_than_the_lost_motion(tmp_path):
    """The law is bent: its slope at 5 um, times 50 um, is three times the reversal value."""
    job = write_job(tmp_path, more=BACKLASH)
    program = tmp_path / "part.nc"
    # X turns back by 6 um before it goes along the wall: its play is half taken up
    text = program.read_text().replace("X-15\nY-10\n", "X-15.006\nX-15\nY-10\n", 1)
    program.write_text(text)
    u = 1e3 * prediction_u_mm(predict_points(job, tmp_path / "points.csv")[1])
    # from 6 um behind the reversal, where it is at 0.4 of 3 um, to the other side
    assert 3.0 < u.max() < 4.3
