"""Turns, bends and curves that a form may go into, against closed forms and hidden causes."""

import pathlib
from types import SimpleNamespace

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from tests.unit.test_diagnosis_verdicts import tip_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.proposals.effect_text import effect_text
from vmach.diagnosis.proposals.form import FormEffect, amounts
from vmach.diagnosis.proposals.form_columns import FormColumns
from vmach.diagnosis.proposals.states import SWELLING, bend_about, curve_in
from vmach.diagnosis.report import as_json, as_text
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import catalogue, load_effect_file

SAMPLE = pathlib.Path(__file__).parents[2] / "samples" / "missing_effect"


class Path(SimpleNamespace):
    """Circumstances with what the code of a direction asks for."""

    def __len__(self):
        return len(self.on_part_mm)


def test_a_plate_bends_as_its_deflection_slopes():
    """Normals stay normal: (-z dw/dx, -z dw/dy, w), by differences of each deflection."""
    middle = np.array([100.0, 50.0, -15.0])
    place = np.random.default_rng(1).uniform([0, 0, -30], [200, 100, 0], (40, 3))
    moved = bend_about(middle).at(Path(on_part_mm=place))
    x, y, z = (0.01 * (place - middle)).T
    deflections = (lambda x, y: x * x, lambda x, y: y * y, lambda x, y: x * y)
    for k, w in enumerate(deflections):
        h = 1e-6
        along_x = (w(x + h, y) - w(x - h, y)) / (2 * h)
        along_y = (w(x, y + h) - w(x, y - h)) / (2 * h)
        expected = np.stack([-z * along_x, -z * along_y, w(x, y)], axis=1)
        np.testing.assert_allclose(moved[:, :, k], expected, atol=1e-9)


def test_a_part_swells_about_its_zero():
    """So much per 100 mm, whichever way, and the same shift everywhere."""
    place = np.random.default_rng(2).uniform([-90, -60, -30], [90, 60, 0], (40, 3))
    moved = SWELLING.at(Path(on_part_mm=place))
    np.testing.assert_allclose(moved[:, :, 0], place / 100.0, atol=1e-15)
    for k in range(3):
        np.testing.assert_array_equal(moved[:, :, 1 + k], np.tile(np.eye(3)[k], (40, 1)))


def test_a_curve_holds_its_ends_beyond_what_was_measured():
    at = [curve_in(0, -100.0, 300.0).at(Path(on_part_mm=p, nose_mm=p)) for p in (
        np.array([[-100.0, 0, 0], [300.0, 0, 0]]), np.array([[-900.0, 0, 0], [900.0, 0, 0]])
    )]  # fmt: skip
    np.testing.assert_array_equal(at[0], at[1])
    assert at[0].shape == (2, 5)


def skewing(q, side, time):
    """The saddle skews by 40 urad whenever X turns, about a place 100 mm off the middle."""
    turn = 20e-3 * side[:, 0]
    return np.stack([-turn * (q[:, 1] + 50.0), 0.5 * turn * 100.0, 0.0 * turn], axis=1)


def test_a_skew_at_each_reversal_is_a_turn(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, skewing, count=120)))
    assert found.verdict in ("unknown", "partly")
    first = found.proposals[0]
    assert first.form.formula == "direction of X, as a turn about Z"
    assert first.form.state_words == ("direction of X", "X in 100 mm", "Y in 100 mm")
    assert first.held_out_um[1] < 0.7  # the noise is 0.5 um
    # 20 urad, times the arms and where they start
    hidden = {
        "along Y per 100 mm in X": 0.0, "along X per 100 mm in Y": -2.0,
        "along X": -1.0, "along Y": 1.0,
    }  # fmt: skip
    for name, of in first.of_each.items():
        assert abs(first.amounts_um[name] - hidden[of]) < 4.0 * first.u_um[name], of
    clear = {first.of_each[name] for name in first.clear_amounts}
    assert clear == hidden.keys() - {"along Y per 100 mm in X"}
    said = as_text(found)
    assert "): along X per 100 mm in Y" in said and ": along Y per 100 mm in X" not in said
    assert [one["of"] for one in as_json(found)["proposals"][0]["each"]] == [*hidden]
    assert '"along X per 100 mm in Y", usual=' in effect_text(first, name="skewing")


def test_every_amount_of_every_form_is_said_in_words_of_its_own():
    survey = survey_job(SAMPLE / "job.toml")
    columns = FormColumns(survey)
    columns.add_conspicuous(*np.random.default_rng(3).normal(0.0, 1e-3, (2, len(survey))))
    for form in columns.forms:
        assert len(set(form.each)) == columns.columns(form).shape[1], form.formula


def test_the_effect_that_is_written_does_what_its_form_does():
    """All kinds of states and directions: some of each, as Python that is run."""
    survey = survey_job(SAMPLE / "job.toml")
    columns = FormColumns(survey)
    columns.add_conspicuous(*np.random.default_rng(3).normal(0.0, 1e-3, (2, len(survey))))
    kinds = {}
    for form in columns.forms:
        kinds.setdefault((form.kinds, form.direction.words), form)
    random = np.random.default_rng(4)
    for form in random.permutation(list(kinds.values()))[:300]:
        size_um = amounts_of(form, random)
        proposal = SimpleNamespace(
            form=form, amounts_um=size_um, amount_um=1.0, amount_u_um=0.1, size_um=1.0, odds=9.0
        )
        written = {}
        exec(effect_text(proposal, name="written"), written)
        for said in ("needs_surface", "turns_tool", "follows_travel"):
            assert getattr(written["Written"], said) == getattr(FormEffect(form), said), said
        for path in survey.paths:
            made = written["Written"]().displacement(path, "", **size_um)
            expected = FormEffect(form, len(size_um)).displacement(path, "", **size_um)
            np.testing.assert_allclose(made, expected, atol=1e-12, err_msg=form.formula)


def amounts_of(form, random):
    """Amounts of a form by chance, by the names of its parameters."""
    return {parameter.name: random.normal() for parameter in amounts(len(form.each))}


def worn(q, side, time):
    """Y has 20 um of play where its screw is worn, within 40 mm about Y-120."""
    play = 20.0 * np.exp(-0.5 * ((q[:, 1] + 120.0) / 40.0) ** 2)
    return np.outer(-0.5 * play * side[:, 1], [0.0, 1.0, 0.0])


def test_play_at_one_place_of_a_screw_is_a_curve_of_reversals(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, worn, count=150)))
    first = found.proposals[0]
    assert first.form.formula == "direction of Y x a curve in Y in 100 mm, along Y"
    assert first.held_out_um[1] < 0.4 * first.held_out_um[0]
    # the file that is written does what was hidden, but for what the cosines leave
    file = tmp_path / "proposed_wear.py"
    file.write_text(effect_text(first, name="proposed_wear"))
    effect = load_effect_file(file)
    try:
        path = found.residuals.survey.paths[0]
        moved = 1e3 * effect.displacement(path, "", **first.amounts_um)
        expected = worn(path.nose_mm, path.play_side, None)
        left = np.sqrt(np.mean((moved - expected) ** 2)) / np.sqrt(np.mean(expected**2))
        assert left < 0.35
    finally:
        catalogue().pop("proposed_wear", None)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_cause_by_chance_is_proposed_nothing_that_foretells_it(tmp_path, seed):
    """Where each reading is off by chance no form foretells the others."""

    def by_chance(q, side, time):
        return np.random.default_rng(seed).normal(size=q.shape) * 6.0

    found = diagnose(survey_job(tip_job(tmp_path, by_chance, count=60, seed=seed)))
    assert all(p.share_left(0.5) < 1.0 for p in found.proposals)
    assert not any(p.share_left(0.5) < 0.8 for p in found.proposals)


def test_a_head_that_nods_with_the_square_of_its_speed_is_told(tmp_path):
    """What is out of balance pulls so: 4 um at 6000 rpm, read at speeds in any order."""
    random = np.random.default_rng(6)
    rpm = np.repeat(random.choice([1000, 2000, 3000, 4000, 5000, 6000], 20), 6)
    moved = np.outer((rpm / 6000.0) ** 2, [0.0, 4.0, 0.0])
    read = np.column_stack([
        20.0 * np.arange(len(rpm)), rpm, moved + random.normal(0.0, 0.3, moved.shape)
    ])  # fmt: skip
    rows = [",".join(map(repr, row)) for row in read.tolist()]
    (tmp_path / "drift.csv").write_text("\n".join(["t_s,spindle_rpm,dx_um,dy_um,dz_um", *rows]))
    drift = measurement("drift", at_mm=[-200, -150, -100])
    lines = write_job(tmp_path, more=drift).read_text().splitlines()
    (tmp_path / "job.toml").write_text("\n".join(r for r in lines if not r.startswith("measured")))
    found = diagnose(survey_job(tmp_path / "job.toml"))
    assert found.verdict == "unknown"
    first = found.proposals[0]
    speed = "spindle speed in 10000 rpm"
    assert first.form.formula == f"{speed} x {speed}, along Y"
    assert first.amount_um == pytest.approx(4.0 / 0.36, abs=4.0 * first.amount_u_um)


def pushed_across(q, side, time):
    """Lost motion of Y of 3 um, and Y is pushed when X and Z come from the same side."""
    return np.outer(1.5 * side[:, 1] + 4.0 * side[:, 0] * side[:, 2], [0.0, 1.0, 0.0])


def test_a_form_of_the_motion_of_other_axes_is_no_doubt_about_lost_motion(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, pushed_across, count=160)))
    assert [finding.label for finding in found.findings] == ["backlash Y"]
    assert found.proposals[0].form.state_words == ("direction of X", "direction of Z")
