"""Forms for what no effect explains, adding in rounds, and the page of rules."""

import itertools
import json
import re
from types import SimpleNamespace

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from typer.testing import CliRunner

from tests.measured_job import write_measured_job
from tests.unit.test_diagnosis_verdicts import nothing, stretched_and_loose, tip_job
from vmach.cli import app
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.findings import something_unknown
from vmach.diagnosis.inference.moves import search
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.rules import RULES
from vmach.diagnosis.next_test.next_measurement import next_measurement
from vmach.diagnosis.proposals.effect_text import effect_text
from vmach.diagnosis.proposals.form import Form, FormEffect
from vmach.diagnosis.proposals.form_columns import FormColumns
from vmach.diagnosis.proposals.forms import Forms
from vmach.diagnosis.proposals.proposal import Proposal
from vmach.diagnosis.proposals.refuting import refuting_tests
from vmach.diagnosis.proposals.states import CONSTANT, DIRECTIONS, State, states_of
from vmach.diagnosis.report import as_json, as_text
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import catalogue, load_effect_file
from vmach.history.rounds import add_in_rounds
from vmach.schemas import json_schema


def run(*words):
    found = CliRunner().invoke(app, [str(word) for word in words])
    assert found.exit_code == 0, found.exception or found.output
    return found.stdout


def both_turned(q, side, time):
    """X is pushed when Y and Z come from the same side: no effect does that."""
    return np.outer(side[:, 1] * side[:, 2] * 4.0, [1.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def pushed_job(tmp_path_factory):
    return tip_job(tmp_path_factory.mktemp("pushed"), both_turned, count=120)


def test_a_clean_machine_gets_no_form(tmp_path):
    assert diagnose(survey_job(tip_job(tmp_path, nothing))).proposals == ()


def test_a_form_names_the_states_that_were_hidden(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, both_turned, count=120)))
    assert found.verdict == "unknown"
    first = as_json(found)["proposals"][0]
    assert first["states"] == ["direction of Y", "direction of Z"]
    assert first["direction"] == "along X"
    assert first["amount_um"] == pytest.approx(4.0, abs=4.0 * first["u_um"])
    assert first["held_out_um"]["with"] < 0.6 * first["held_out_um"]["without"]
    assert "direction of Y x direction of Z, along X" in as_text(found)
    Draft202012Validator(json_schema("diagnose")).validate(json.loads(json.dumps(as_json(found))))


def test_of_many_readings_some_are_looked_through(pushed_job, monkeypatch):
    """Every other reading leads to the same form, fitted to all of them."""
    monkeypatch.setattr("vmach.diagnosis.proposals.leading_forms._LOOKED_THROUGH", 180)
    survey = survey_job(pushed_job)
    assert len(survey) == 360
    first = diagnose(survey).proposals[0]
    assert [state.words for state in first.form.states] == ["direction of Y", "direction of Z"]
    assert first.amount_um == pytest.approx(4.0, abs=4.0 * first.amount_u_um)


def test_a_proposal_is_an_effect_file_that_can_be_added(pushed_job, tmp_path):
    file = tmp_path / "proposed_push.py"
    said = run("effects", "propose", pushed_job, "-o", file)
    assert "1: " in said and str(file) in said
    effect = load_effect_file(file)
    try:
        assert effect.name == "proposed_push"
        assert effect.confirm.startswith("cut the same surfaces in the opposite direction")
        said = run("add", pushed_job, "proposed_push", "-o", tmp_path / "2.toml")
        before, after = map(float, re.search(r"([\d.]+) um before, ([\d.]+) um", said).groups())
        assert after < 0.4 * before
    finally:
        catalogue().pop("proposed_push", None)


def waving(q, side, time):
    """Y is pushed by a wave of 17.3 mm in X: no effect waves across its axis."""
    return np.outer(5.0 * np.sin(2.0 * np.pi * q[:, 0] / 17.3 + 0.7), [0.0, 1.0, 0.0])


def test_a_wave_is_found_whatever_its_period(tmp_path):
    job = tip_job(tmp_path, waving, count=150)
    found = diagnose(survey_job(job))
    assert found.verdict == "unknown"
    first = found.proposals[0]
    assert first.form.kinds == {"wave in X"} and first.form.direction.words == "along Y"
    assert "a wave of 17.3 mm in X" in first.form.formula
    assert first.amount_um == pytest.approx(5.0, abs=0.5)
    # the file that is written does the same as the form, its two amounts apart
    file = tmp_path / "proposed_wave.py"
    file.write_text(effect_text(first, name="proposed_wave"))
    effect = load_effect_file(file)
    try:
        path = found.residuals.survey.paths[0]
        moved = effect.displacement(path, "", **first.amounts_um)
        np.testing.assert_allclose(moved, 1e-3 * waving(path.nose_mm, None, None), atol=1e-3)
    finally:
        catalogue().pop("proposed_wave", None)


@pytest.mark.parametrize(
    ("code", "needs"), [("path.radial_depth_mm", True), ("path.play_side[:, 1]", False)]
)
def test_a_form_over_what_only_a_surface_has_needs_one(tmp_path, code, needs):
    """A chip load has no meaning between cuts: the file that is written has to say so."""
    form = Form(CONSTANT, State("chip load", "a state", code), DIRECTIONS[1])
    assert FormEffect(form).needs_surface == needs
    proposal = SimpleNamespace(
        form=form, amount_um=1.0, amount_u_um=0.1, odds=9.0, amounts_um={"amount_um": 1.0}
    )
    file = tmp_path / f"of_{needs}.py".lower()
    file.write_text(effect_text(proposal, name=file.stem))
    try:
        assert load_effect_file(file).needs_surface == needs
    finally:
        catalogue().pop(file.stem, None)


def lurching(q, side, time):
    """It sits elsewhere as it warms, each axis by another amount: 9, -6 and 4 um in the end."""
    return np.outer(1.0 - np.exp(-time / 300.0), [9.0, -6.0, 4.0]) * np.sign(side[:, :1])


def test_products_with_an_exponential_in_time_are_tried(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, lurching, count=150)))
    states = set().union(*(p.form.kinds for p in found.proposals))
    assert {"direction", "warm-up"} <= states


def test_where_nothing_remains_there_is_nothing_to_propose(tmp_path):
    job = tip_job(tmp_path, nothing)
    found = CliRunner().invoke(app, ["effects", "propose", str(job), "-o", str(tmp_path / "a.py")])
    assert found.exit_code != 0
    assert "there are 0 proposals" in str(found.exception)
    assert not (tmp_path / "a.py").exists()


def test_rounds_add_what_is_shown_until_nothing_is_left(tmp_path):
    job = tip_job(tmp_path, stretched_and_loose, count=120)
    rounds = add_in_rounds(job)
    (step,) = rounds.steps
    assert set(step.added) == {"scale X", "backlash Y"}
    assert step.after_um < 0.7 < step.before_um
    assert rounds.job == step.job and rounds.left.verdict == "nothing"
    assert add_in_rounds(step.job, rounds.left).steps == ()


def test_adding_in_rounds_says_what_remains(pushed_job):
    said = run("diagnose", pushed_job, "--add-all").replace("\n", " ")
    left = re.search(
        r"nothing further is shown, but ([\d.]+) um RMS of something else remain", said
    )
    assert float(left[1]) > 1.0
    assert f"vmach effects propose {pushed_job} -o my_effect.py" in said
    assert "go on from" not in said


def test_a_form_comes_with_the_test_that_would_refute_it(pushed_job, tmp_path):
    said = run("diagnose", pushed_job, "--out", tmp_path / "out")
    assert "to refute it: cut the same surfaces in the opposite direction" in said
    page = (tmp_path / "out" / "diagnosis.html").read_text()
    assert "<li>cut the same surfaces in the opposite direction" in page


def test_every_state_has_a_test_that_would_refute_it(pushed_job):
    survey = survey_job(pushed_job)
    for state in states_of(survey.paths[0]):
        assert refuting_tests([state])


class Cut(SimpleNamespace):
    """Circumstances with how the axes move, at so many places."""

    def __len__(self):
        return len(self.play_side)


def test_what_would_refute_a_product_is_what_its_states_do(pushed_job):
    """The path is cut the other way, and at twice the feed: the numbers say what has to be seen."""
    path = survey_job(pushed_job).paths[0]
    kinds = ("direction", "speed", "low speed", "acceleration", "travel since reversal")
    states = [state for state in states_of(path) if state.kind in kinds]
    random = np.random.default_rng(5)
    side, speed = random.choice([-1.0, 1.0], (40, 3)), random.normal(0.0, 9.0, (40, 3))
    same = {"acceleration_mm_per_s2": speed[::-1], "travel_since_reversal_mm": abs(speed)}
    same["on_arc"] = np.ones(40)
    cut, back, fast = (
        Cut(play_side=sign * side, velocity_mm_per_s=sign * factor * speed, **same)
        for sign, factor in ((1.0, 1.0), (-1.0, 1.0), (1.0, 2.0))
    )
    for pair in itertools.combinations_with_replacement(states, 2):
        said = refuting_tests(pair)
        now, turned, doubled = (np.prod([s.at(p) for s in pair], axis=0) for p in (cut, back, fast))
        if any(state.kind == "direction" for state in pair):
            seen = "sign has to stay" if np.allclose(turned, now) else "sign has to turn"
            assert f"in the opposite direction: the {seen}" in said
        if {s.kind for s in pair} <= {"speed", "direction"} and not (doubled == now).all():
            seen = "double" if np.allclose(doubled, 2.0 * now) else "grow to four times"
            assert f"at twice the feed: it has to {seen}" in said
    (square,) = {refuting_tests([s, s]) for s in states_of(path) if s.kind == "spindle speed"}
    assert square.endswith("it has to fall to a quarter")


def form_of(words, path, job):
    """The form of a state of these words into X, proposed with 4 um."""
    (state,) = [s for s in states_of(path) if s.words == words]
    form = Form(state, CONSTANT, DIRECTIONS[0])
    return Proposal(form, {"amount_um": 4.0}, {"amount_um": 0.4}, 2.0, 50.0, 0.1, (2.0, 0.6))


@pytest.mark.parametrize(
    ("words", "said", "is_runnable"),
    [
        ("direction of Y", "if form 1 is true, it shows there by", True),
        ("depth below the top in 10 mm", "no test without cutting would show", False),
    ],
)
def test_the_next_measurement_would_refute_the_first_form(pushed_job, words, said, is_runnable):
    weighing = prepare_weighing(survey_job(pushed_job))
    survey, nothing_found = weighing.survey, weighing.nothing()
    proposal = form_of(words, survey.paths[0], survey.job)
    test = next_measurement(weighing, nothing_found, (something_unknown(()),), (proposal,))
    assert said in test.text
    assert (test.program is not None) == is_runnable


def test_an_amount_that_may_be_zero_decides_no_measurement(pushed_job):
    weighing = prepare_weighing(survey_job(pushed_job))
    columns = FormColumns(weighing.survey)
    listed = {form.formula: columns.held(form) for form in columns.forms}
    amounts = {"amount_1_um": -9.0, "amount_2_um": 6.0, "amount_3_um": -50.0}
    u = {"amount_1_um": 1.0, "amount_2_um": 1.0, "amount_3_um": 45.0}
    form = listed["time in hours, along X, Y and Z"]
    proposal = Proposal(form, amounts, u, 2.0, 50.0, 0.1, (2.0, 0.6))
    unknown = (something_unknown(()),)
    test = next_measurement(weighing, weighing.nothing(), unknown, (proposal,))
    assert "along Z" not in test.text


def test_every_number_that_decides_is_told():
    said = run("diagnose", "--rules")
    assert len(RULES) <= 8
    for rule in RULES:
        assert f"{rule.name} = {rule.value:g}" in said
        assert rule.origin in said and rule.guard in said


def test_forms_are_looked_through_as_they_are_fitted_where_zeros_were_touched(tmp_path):
    """Two tools, whose zeros are of other touches."""
    job = write_measured_job(tmp_path)
    job.write_text(job.read_text() + "\n[probing]\n")
    survey = survey_job(job)
    columns = FormColumns(survey)
    differ = 0
    for form in columns.forms[::40]:
        looked_at = columns.columns(form)
        fitted = survey.signature(FormEffect(form, looked_at.shape[1]), form.formula, {})
        np.testing.assert_allclose(looked_at, fitted, atol=1e-9)
        differ += bool(np.abs(looked_at).max() > 1e-6)
    assert differ > 20


def test_forms_without_room_are_weighed_once_at_each_look(pushed_job, monkeypatch):
    weighing = prepare_weighing(survey_job(pushed_job))
    forms, leading = Forms(weighing, weighing.nothing()), "vmach.diagnosis.proposals.leading_forms"
    monkeypatch.setattr(f"{leading}._AT_ONCE", 50 * len(weighing.survey))
    monkeypatch.setattr(f"{leading}._ROOM", 120 * len(weighing.survey))
    looks = [[f for bank in forms._leading._weighed() for f in bank.forms] for _ in range(3)]
    assert len(looks[0]) > 150
    assert looks[1] == looks[0] and looks[2] == looks[0]


def test_forms_are_tried_beside_the_effects_that_stay_where_these_are_known(tmp_path):
    weighing = prepare_weighing(survey_job(tip_job(tmp_path, stretched_and_loose)))
    found = search(weighing, weighing.nothing())
    every = found.labels
    assert len(every) > 1
    forms = Forms(weighing, found)
    start = forms._start(found)

    def tried(beside):
        return [fewer.labels for fewer in forms._with_fewer(found, start, beside)]

    assert tried(None)[0] == frozenset() and len(tried(None)) == len(every)
    assert tried(every) == []
    for label in every:
        assert tried(frozenset([label])) == [frozenset([label])]
    assert tried(frozenset()) == [frozenset()]


def test_of_forms_that_round_alike_the_first_is_listed(pushed_job, monkeypatch):
    place = "a spot 30 mm wide at 100 mm in X, 50 mm in Y of the machine"
    near = [State("spot", place, f"path.nose_mm[:, 0] > {x}") for x in (-200.2, -200.4)]
    columns = FormColumns(survey_job(pushed_job))
    before = len(columns)
    for state in near:
        monkeypatch.setattr(columns._spots, "states", lambda _, s=state: [(s, DIRECTIONS[0])])
        columns.add_conspicuous(np.full(360, float(id(state))), np.zeros(360))
    listed = [form for form in columns.forms[before:] if form.second.kind == "spot"]
    assert [form.second for form in listed] == near[:1]


@pytest.mark.parametrize(("gains", "told"), [((30.0, 29.0), "plain"), ((30.0, 20.0), "product")])
def test_of_forms_that_cannot_be_told_apart_the_simplest_is_tried(pushed_job, gains, told):
    weighing = prepare_weighing(survey_job(pushed_job))
    forms = Forms(weighing, weighing.nothing())
    listed = {form.formula: form for form in forms._columns.forms}
    either = {
        "product": listed["direction of X x warm-up within 75 s, along Y"],
        "plain": listed["direction of X, along Y"],
    }
    assert forms._leading._most_probable([*either.values()], np.array(gains), 6) == [either[told]]
