"""Verdicts on tip measurements whose hidden cause is written here from scratch."""

from __future__ import annotations

import json
import re
import warnings
from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest

from tests.small_job import measurement, write_job, write_table
from vmach.diagnosis.diagnose import diagnose, not_followed
from vmach.diagnosis.findings import Finding
from vmach.diagnosis.gates.impossible_sizes import impossible_size_notes, impossible_terms
from vmach.diagnosis.inference import moves, verdicts
from vmach.diagnosis.inference.noise import noise_before
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.remains import remains_um, where_they_act_um
from vmach.diagnosis.inference.support import Support, in_its_place
from vmach.diagnosis.inference.verdicts import Reason, Weak
from vmach.diagnosis.next_test.planned_program import write_program
from vmach.diagnosis.report import as_json, as_text
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.diagnosis.rivals import Rivals, credible, other_sets, rivals_of
from vmach.diagnosis.words import weak_words, with_unit
from vmach.effects import Circumstances, catalogue
from vmach.errors import InputError
from vmach.fit.survey import Survey
from vmach.history import draw_history, history_of
from vmach.history.added_effects import add_effects
from vmach.instruments import planned_tests, read_instruments, settings_of
from vmach.job import read_job
from vmach.measurements import apart_from_few, apart_from_neighbours

TIP = measurement("tip", frame="rigid", u_um=0.5)


def tip_job(folder, hidden, *, seed=1, count=70):
    """A job with tip readings: noise, a rigid motion, and what `hidden(q, side, t)` gives, um."""
    job = write_job(folder, more=TIP).read_text()
    job = "\n".join(line for line in job.splitlines() if not line.startswith("measured"))
    (folder / "job.toml").write_text(job)
    random = np.random.default_rng(seed)
    q = random.uniform([-390, -290, -190], [-10, -10, -10], (count, 3))
    side = random.choice([-1.0, 1.0], (count, 3))
    time = 10.0 * np.arange(count)
    e = hidden(q, side, time) + 0.5 * random.standard_normal((count, 3))
    e = e + np.array([4.0, -7.0, 2.0]) + np.cross([0.02, -0.01, 0.03], q)
    rows = ["id,t_s,X,Y,Z,sx,sy,sz,dx_um,dy_um,dz_um"]
    for k in range(count):
        numbers = [time[k], *q[k], *side[k], *e[k]]
        rows.append(f"{k}," + ",".join(map(repr, map(float, numbers))))
    (folder / "tip.csv").write_text("\n".join(rows))
    return folder / "job.toml"


def nothing(q, side, time):
    return np.zeros_like(q)


def lost_motion(q, side, time):
    return np.column_stack([-2.0 * side[:, 0], 0 * time, 0 * time])


def stretched_and_loose(q, side, time):
    return np.column_stack([0.03 * q[:, 0], -1.5 * side[:, 1], 0 * time])


def worn_guide(q, side, time):
    dent = 6.0 * np.exp(-0.5 * ((q[:, 0] + 150) / 25.0) ** 2)
    return np.column_stack([0 * time, 0 * time, dent])


def foreign(q, side, time):
    """A ripple in space that belongs to no axis."""
    wave = 4.0 * np.sin((q[:, 0] + 1.7 * q[:, 1] + 0.6 * q[:, 2]) / 37.0)
    return np.column_stack([wave, -0.5 * wave, 0.8 * wave])


def test_nothing_is_said_about_a_sound_machine(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, nothing)))
    assert found.verdict == "nothing" and found.findings == ()
    assert found.rms_um["after"] == pytest.approx(0.5, rel=0.2)


def test_backlash_is_named_with_its_size(tmp_path):
    # a loop of hysteresis over the shortest travel does nearly the same: 70 readings leave it 1 %
    found = diagnose(survey_job(tip_job(tmp_path, lost_motion, count=120)))
    assert found.verdict == "named"
    (finding,) = found.findings
    assert (finding.name, finding.target) == ("backlash", "X")
    error = finding.parameters["reversal_um"] - 4.0
    assert abs(error) < 3 * finding.u["reversal_um"] < 1.0
    assert found.failures[0].by == "direction" and "X" in found.failures[0].text
    table = as_json(found)
    assert json.loads(json.dumps(table))["effects"][0]["class"] == ["backlash"]
    assert table["candidates"][0]["effect"] == "backlash"
    assert "lost motion" in as_text(found)


def test_two_causes_at_once_are_both_found(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, stretched_and_loose, count=120)))
    labels = {(f.name, f.target): f.parameters for f in found.findings}
    assert set(labels) == {("scale", "X"), ("backlash", "Y")}
    assert labels["scale", "X"]["scale_ppm"] == pytest.approx(30, rel=0.1)
    assert labels["backlash", "Y"]["reversal_um"] == pytest.approx(3, rel=0.15)


def test_local_damage_is_a_component_and_its_place(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, worn_guide, count=150)))
    (finding,) = found.findings
    assert (finding.name, finding.target) == ("component", "EZX")
    peak = np.array(finding.parameters["correction_um"])
    place = np.array(finding.parameters["position_mm"])
    assert abs(place[np.argmax(peak)] + 150) < 30
    assert "X -" in finding.where


def test_what_no_effect_explains_is_called_unknown(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, foreign, count=80)))
    assert found.verdict == "unknown"
    (finding,) = found.findings
    assert finding.name == "unknown" and finding.effect is None
    assert found.remains_um == pytest.approx(2.2, rel=0.3)
    assert as_json(found)["remains_um"] > 1.5
    # something unknown gets a test too, as a program
    assert found.next_measurement.program.startswith("%")


def test_an_effect_is_named_beside_something_unknown(tmp_path):
    def stretch_and_ripple(q, side, time):
        return np.outer(0.1 * q[:, 0], [1.0, 0.0, 0.0]) + 0.5 * foreign(q, side, time)

    found = diagnose(survey_job(tip_job(tmp_path, stretch_and_ripple, count=80)))
    assert found.verdict == "partly"
    table = as_json(found)
    (scale,) = table["effects"]
    assert (scale["effect"], scale["target"]) == ("scale", "X")
    assert scale["share"] > 0.9
    low, high = scale["interval_95"]["scale_ppm"]
    wide = 0.5 * (3.0 / 1.96 - 1.0) * (high - low)  # one of twenty may miss the interval of 95 %
    assert low - wide < 100.0 < high + wide
    assert high - low < 10.0
    assert "something else remains" in as_text(found)


def test_clean_data_are_left_alone(tmp_path):
    """Ten sets of readings drawn from the model's own uncertainty: no accusation."""
    survey = survey_job(tip_job(tmp_path, nothing))
    weighing = prepare_weighing(survey)
    (tip,) = survey.measurements
    random = np.random.default_rng(12)
    verdicts = []
    for _ in range(10):
        noise = tip.u_mm * random.standard_normal(len(tip))
        fresh = Survey(survey.job, (replace(tip, measured_mm=tip.predicted_mm + noise),))
        verdicts.append(diagnose(fresh, like=weighing).verdict)
    assert verdicts == ["nothing"] * 10


def test_units_stand_behind_their_numbers():
    assert with_unit("growth_um", 26.0) == "26 um"
    assert with_unit("speed_exponent", 0.7) == "speed_exponent = 0.7"


def test_add_keeps_the_old_job_and_the_error_falls(tmp_path):
    old = tip_job(tmp_path, stretched_and_loose, count=120)
    before = old.read_bytes()
    second, _ = add_effects(old, ["backlash"])
    third, found = add_effects(second, ["scale:X"])
    assert old.read_bytes() == before
    assert [effect.label for effect in found] == ["backlash Y", "scale X"]
    assert found[1].parameters["scale_ppm"] == pytest.approx(30, rel=0.1)
    steps = history_of(third)
    assert [s.added for s in steps] == [(), ("backlash Y",), ("scale X",)]
    assert steps[0].rms_um > steps[1].rms_um > steps[2].rms_um
    assert steps[2].rms_um == pytest.approx(0.5, rel=0.2)
    draw_history(steps, tmp_path / "history.png")
    assert (tmp_path / "history.png").stat().st_size > 5000
    with pytest.raises(InputError, match="already"):
        add_effects(third, ["scale:X"])


def test_added_job_in_another_folder_finds_its_files(tmp_path):
    old = tip_job(tmp_path, lost_motion)
    (tmp_path / "later").mkdir()
    new, _ = add_effects(old, ["backlash:X"], out=tmp_path / "later" / "job.toml")
    assert diagnose(survey_job(new)).verdict == "nothing"
    assert history_of(new)[0].job.resolve() == old.resolve()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("backlsh", "did you mean 'backlash'"),
        ("backlash:Q", "accepted: backlash:X"),
        ("probe_radius", "no machined surface"),
    ],
)
def test_add_refuses_what_cannot_be_fitted(tmp_path, name, message):
    with pytest.raises(InputError, match=message):
        add_effects(tip_job(tmp_path, nothing), [name])


def test_planned_tests_stay_within_the_travel_and_are_programs(tmp_path):
    from gcode import read_program

    job = read_job(write_job(tmp_path))
    low, high = job.machine.travel_mm
    for test in planned_tests(job):
        assert (test.states.nose_mm > low - 1e-9).all()
        assert (test.states.nose_mm < high + 1e-9).all()
        file = tmp_path / "next.nc"
        file.write_text(write_program(test, job))
        moves = read_program(file, work_offsets_mm=job.work_offsets_mm).moves
        ends = np.unique(np.round(moves.end_mm, 3), axis=0)
        for nose in np.unique(np.round(test.states.moves.end_mm, 3), axis=0)[:5]:
            assert np.abs(ends - nose).max(axis=1).min() < 2e-3


@pytest.mark.parametrize(
    ("plane", "normal", "upright", "square"),
    [("XY", 2, None, "C0Y"), ("YZ", 0, 2, "A0Y"), ("ZX", 1, 2, "B0X")],
)
def test_a_planned_ballbar_turns_in_its_plane_and_shows_its_squareness(
    tmp_path, plane, normal, upright, square
):
    """Upright arcs stay above the centre but for their run-ups; in each, the plane's squareness
    shows as half the radius times the sine of twice the angle (ISO 230-4)."""
    from gcode import MoveKind, read_program

    job = read_job(write_job(tmp_path))
    (test,) = (t for t in planned_tests(job) if t.name == f"ballbar {plane}")
    centre, radius = test.settings["centre_mm"], test.settings["radius_mm"]
    file = tmp_path / "next.nc"
    file.write_text(write_program(test, job))
    moves = read_program(file, work_offsets_mm=job.work_offsets_mm).moves
    arcs = np.flatnonzero(moves.kind == MoveKind.ARC)
    sweep = np.abs(moves.sweep_rad[arcs])
    assert sweep.sum() == pytest.approx(4 * np.radians(540 if upright is None else 220), abs=1e-4)
    assert {int(np.argmax(np.abs(axis))) for axis in moves.axis[arcs]} == {normal}
    np.testing.assert_allclose(moves.centre_mm[arcs], np.tile(centre, (len(arcs), 1)), atol=2e-4)
    assert len(set(np.sign(moves.sweep_rad[arcs] * moves.axis[arcs].sum(axis=1)))) == 2
    out = test.sensing
    np.testing.assert_allclose(test.states.nose_mm, centre + radius * out, atol=1e-9)
    if upright is not None:
        assert out[:, upright].min() > 0.0
        lowest = np.minimum(moves.start_mm, moves.end_mm)[arcs, upright].min()
        assert lowest == pytest.approx(centre[upright] - radius * np.sin(np.radians(20)), abs=1e-3)
    path = Circumstances(test.states, job)
    shown = np.einsum("pi,pik->pk", out, catalogue()["squareness"].columns(path, square, {}))[:, 0]
    across, upward = (out[:, "XYZ".index(axis)] for axis in plane)
    expected = 2.0 * across * upward  # sin of twice the angle

    def left(values):
        free = test.nuisance
        return values - free @ np.linalg.lstsq(free, values, rcond=None)[0]

    usual = 1e-6 * catalogue()["squareness"].amplitudes[0].usual
    ratio = left(shown) @ left(expected) / (left(expected) @ left(expected))
    np.testing.assert_allclose(left(shown), ratio * left(expected), atol=1e-9)
    assert abs(ratio) == pytest.approx(0.5 * radius * usual, rel=1e-6)


@pytest.mark.parametrize(("machine_um", "is_possible"), [(-9.0, False), (-2.0, True), (9.0, True)])
def test_a_size_surely_below_zero_is_no_finding(machine_um, is_possible):
    parameters = {"tool_um": 3.0, "machine_um": machine_um, "slot_um": -50.0}
    parameters |= dict.fromkeys(["taper_um", "climb_um"], 0.0)
    u = dict.fromkeys(parameters, 1.0)
    finding = Finding(catalogue()["tool_deflection"], "", parameters, u, Rivals((), ()), None, {})
    notes = impossible_size_notes([finding])
    assert (not notes) == is_possible
    assert all((note.size, note.unit) == (-9.0, "um") for note in notes)
    assert all("machine_um = -9" in str(note) for note in notes)


@pytest.mark.parametrize(
    ("name", "parameters", "says"),
    [
        ("runout", {"runout_um": 4.0, "marks_share": 0.8}, ""),
        ("runout", {"runout_um": 4.0, "marks_share": 9.0}, "cannot be above 1"),
        ("runout", {"runout_um": 4.0, "marks_share": -7.0}, "below zero"),
        ("tool_deflection", {"taper_um": 6.0}, ""),
        ("tool_deflection", {"taper_um": -9.0}, "more than tool_um = 3"),
        ("tool_deflection", {"climb_um": 9.0}, "more than tool_um = 3"),
    ],
)  # fmt: skip
def test_nature_bounds_what_an_effect_can_be(name, parameters, says):
    effect = catalogue()[name]
    usual = {"tool_um": 3.0} | {p.name: 0.0 for p in effect.parameters if p.name != "tool_um"}
    parameters = usual | parameters
    u = dict.fromkeys(parameters, 1.0)
    notes = impossible_size_notes([Finding(effect, "", parameters, u, Rivals((), ()), None, {})])
    assert bool(notes) == bool(says)
    assert says in "".join(map(str, notes))


def test_what_makes_an_effect_has_to_be_there():
    """Feed marks without a runout, and a part that only moves, are other things."""
    for name, missing in (("runout", "runout_um"), ("workpiece_warming", "expansion_ppm")):
        effect = catalogue()[name]
        for size, is_none in ((0.0, True), (9.0, False)):
            value = {p.name: 0.5 for p in effect.parameters} | {missing: size}
            fit = SimpleNamespace(
                terms=[SimpleNamespace(effect=effect)],
                parameters=lambda k, v=value: v,
                uncertainty=lambda k, v=value: dict.fromkeys(v, 1.0),
            )
            assert bool(impossible_terms(fit)) == is_none


def test_the_next_program_says_how_its_readings_come_back(tmp_path):
    """Its comments are a section of the job, and the columns that its reader asks for."""
    path = write_job(tmp_path)
    job, text = read_job(path), path.read_text()
    for test in planned_tests(job):
        comments = re.findall(r"^\((.*)\)$", write_program(test, job), re.M)
        section = comments[comments.index("[[measurements]]") :]
        path.write_text("\n".join([text, *section, ""]))
        stated = settings_of(read_job(path), 0)
        (columns,) = (c.partition(": ")[2] for c in comments if c.startswith("readings into"))
        (tmp_path / stated.file).write_text(columns + "\n")
        with pytest.raises(InputError, match="no rows of data"):  # and no column is missing
            read_instruments(read_job(path))
        nose = test.states.nose_mm
        if stated.kind == "laser":
            still = [k for k, axis in enumerate("XYZ") if axis != stated.axis]
            np.testing.assert_allclose(nose[:, still] - np.array(stated.at_mm)[still], 0, atol=1e-9)
        elif stated.kind == "drift":
            np.testing.assert_allclose(nose - stated.at_mm, 0, atol=1e-9)
        elif stated.kind == "ballbar":
            away = np.linalg.norm(nose - stated.centre_mm, axis=1)
            np.testing.assert_allclose(away, stated.radius_mm, atol=1e-9)


@pytest.mark.parametrize("states_u", [True, False])
def test_readings_without_any_error_say_nothing(tmp_path, states_u):
    job = write_job(tmp_path)  # of a machine without errors, measured where it should be
    points = tmp_path / "points.csv"
    if not states_u:
        lines = [line.rsplit(",", 1)[0] for line in points.read_text().splitlines()]
        points.write_text("\n".join(lines))
    found = diagnose(survey_job(job))
    assert found.verdict == "nothing"
    assert found.remains_um == pytest.approx(0.0, abs=1e-6)


def test_what_a_rival_makes_needless_goes_before_what_is_small():
    """A curve that two tables share: without the needless one the other is as large as both."""
    needless = Support(odds=2.5, size_um=14.0, rest_um=2.0, share=0.8)
    small = Support(odds=45.0, size_um=3.0, rest_um=2.0, share=0.1)
    assert needless.probability > 0.5 > small.probability
    assert needless.order < small.order


def test_an_effect_that_is_half_of_everything_has_to_be_four_times_as_large_as_the_rest():
    support = Support(odds=50.0, size_um=8.0, rest_um=2.0, share=0.5)
    assert support.probability == pytest.approx(0.5, abs=0.01)
    assert not replace(support, rest_um=2.1).is_shown and replace(support, rest_um=1.9).is_shown
    assert not replace(support, share=0.48).is_shown and replace(support, share=0.52).is_shown
    assert replace(support, share=0.001, rest_um=0.0).is_shown  # it leaves nothing


def test_a_class_is_the_fewest_effects_that_hold_99_per_cent():
    gains = np.random.default_rng(3).uniform(0.0, 6.0, 7)
    share = np.exp(gains) / np.exp(gains).sum()
    enough = [
        chosen
        for count in range(1, 8)
        for chosen in combinations(range(7), count)
        if share[list(chosen)].sum() >= 1.0 - np.exp(-4.6)
    ]
    assert 2 < len(enough[0]) < 7
    assert sorted(credible(gains)) == sorted(
        max((c for c in enough if len(c) == len(enough[0])), key=lambda c: share[list(c)].sum())
    )


def sets_instead(scores, label, alone=()):
    """What takes the place of an effect, and of which, in sets of given scores."""
    weighing = SimpleNamespace(tried={frozenset(labels): s for labels, s in scores.items()})
    best = SimpleNamespace(labels=max(weighing.tried, key=weighing.tried.get))
    found = other_sets(weighing, best, label, dict(alone))
    return [("".join(sorted(one.without)), "".join(sorted(one.instead))) for one in found]


def test_effects_of_a_set_that_explains_as_much_belong_to_the_class():
    scores = {"ab": -10.0, "acd": -13.0, "ae": -16.0, "abg": -11.0, "a": -12.0}
    assert sets_instead(scores, "b") == [("b", "cd")]
    assert sets_instead(scores, "a") == []


def test_sets_are_told_of_what_was_found_where_another_is_a_little_more_probable():
    """The search goes on only where that makes the whole more probable by half."""
    weighing = SimpleNamespace(tried={frozenset("ab"): -10.2, frozenset("acd"): -10.0})
    told = SimpleNamespace(labels=frozenset("ab"))
    (one,) = other_sets(weighing, told, "b", {})
    assert (one.instead, one.odds) == ({"c", "d"}, pytest.approx(0.2))
    assert other_sets(weighing, SimpleNamespace(labels=frozenset("x")), "x", {}) == ()


def test_one_effect_may_stand_for_two():
    scores = {"abx": -10.0, "cx": -11.0, "ax": -14.5, "dx": -16.5}
    assert sets_instead(scores, "a") == sets_instead(scores, "b") == [("ab", "c")]
    assert sets_instead(scores, "x") == []


def test_what_stands_idly_beside_a_rival_is_none():
    scores = {"ab": -10.0, "ac": -10.1, "acd": -11.0, "aef": -12.0}
    assert sets_instead(scores, "b") == [("b", "c"), ("b", "ef")]
    assert sets_instead(scores, "b", alone={"f": -1.5}) == [("b", "c")]
    # the two together are more probable than one of them alone
    assert sets_instead(scores, "b", alone={"f": -2.5}) == [("b", "c"), ("b", "ef")]


def test_two_exchanges_at_once_are_told_one_by_one():
    scores = {"ab": -10.0, "ac": -10.5, "db": -10.5, "dc": -11.0}
    assert sets_instead(scores, "b") == [("b", "c")]
    assert sets_instead(scores, "a") == [("a", "d")]


def test_effects_that_come_near_each_other_are_counted_together():
    gains = np.array([3.0, 3.0, 2.0, 9.0])
    candidates = [SimpleNamespace(label=n, effect=n, target="") for n in "abcd"]
    weighing = SimpleNamespace(
        candidates=candidates,
        prior_of=lambda effect, _: 4.0 if effect == "b" else 0.0,
        index_of="abcd".index,
        gains=lambda _: gains,
        without=lambda *_, **__: None,
        tried={},
    )
    found = SimpleNamespace(
        terms=[SimpleNamespace(label="a"), SimpleNamespace(label="d")],
        labels={"a", "d"},
        score=20.0,
    )
    more, prior = in_its_place(weighing, found, 0)
    whole = 2.0 + np.exp(-1.0)
    assert more == pytest.approx(np.log(whole))
    # one of the three is what machines often have
    assert prior == pytest.approx(np.log((1.0 + np.exp(4.0) + np.exp(-1.0)) / whole))
    # one was tried with the others fitted to it; what does more, or less, is another matter
    weighing.tried = {
        frozenset(tried): score
        for tried, score in {"ad": 20.0, "cd": 20.5, "bd": 3.0, "bcd": 25.0, "ab": 25.0}.items()
    }
    assert in_its_place(weighing, found, 0)[0] == pytest.approx(np.log(2.0 + np.exp(0.5)))


def judged_by(monkeypatch, labels, odds_of, scores=()):
    """The verdicts on some effects whose odds, in a set of them, and whose scores are given."""
    scores = dict(scores)

    def found(labels):
        terms = [SimpleNamespace(label=n) for n in labels]
        score = scores.get("".join(labels), 0.0)
        return SimpleNamespace(terms=terms, labels=labels, posterior=Mock(), score=score)

    def supports(_, here, count):
        odds = odds_of(here.labels)
        return [Support(odds[n], size_um=2.0, rest_um=0.0) for n in here.labels[:count]]

    weighing = SimpleNamespace(
        careful=lambda _: None,
        without=lambda here, ks: found([n for k, n in enumerate(here.labels) if k not in ks]),
        explain=lambda terms, *_, **__: found([term.label for term in terms]),
    )
    monkeypatch.setattr(verdicts, "supports_of", supports)
    return verdicts.judged(weighing, found(labels))


def test_what_is_not_certain_stays_beside_the_others_while_they_are_judged(monkeypatch):
    """Without the first effect, of odds 2.1, the second would lose what speaks for it."""
    shown, _, weak = judged_by(
        monkeypatch, ["a", "b"], lambda here: {"a": 2.1, "b": 7.0 if "a" in here else 1.2}
    )
    assert shown.labels == ["b"] and [w.term.label for w in weak] == ["a"]


def test_of_two_that_stand_for_each_other_one_is_shown(monkeypatch):
    """Each is needless beside the other, and without both nothing explains the readings."""
    shown, by, weak = judged_by(
        monkeypatch,
        ["b", "a"],
        lambda here: dict.fromkeys(here, 2.0 if len(here) == 2 else 50.0),
        scores={"a": 5.0, "b": 3.0},
    )
    assert shown.labels == ["a"] and by["a"].is_shown
    assert [w.term.label for w in weak] == ["b"]


def test_what_is_less_probable_than_nothing_is_no_rival():
    """One effect in a hundred: what is left of the probability is that of none at all."""
    gains = np.append(4.0, np.full(99, -4.6))
    labels = [f"e{k}" for k in range(100)]
    effect = SimpleNamespace(
        name="e0", signature="", parameters=(), is_sudden=False, is_never_exact=False
    )
    weighing = SimpleNamespace(
        candidates=[SimpleNamespace(label=n, effect=effect) for n in labels],
        gains=lambda _: gains,
        without=lambda *_, **__: SimpleNamespace(terms=(), score=0.0),
        extend=lambda _, k, **__: SimpleNamespace(fit=None, score=gains[k]),
        tried={frozenset(["e0"]): 4.0},
        index_of=labels.index,
    )
    term = SimpleNamespace(label="e0", effect=effect)
    explanation = SimpleNamespace(
        fit=SimpleNamespace(terms=(term,)), score=4.0, labels=frozenset(["e0"])
    )
    assert len(credible(gains)) > 1
    assert rivals_of(weighing, explanation, 0).names == ("e0",)


def test_a_rival_is_weighed_as_it_fits_and_not_as_it_is_estimated():
    """What its own law leaves open is in no estimate, nor is a size that nature does not have."""
    labels, scores = ["a", "exact", "huge", "far"], [9.0, 8.4, -1700.0, -9.0]
    effect = SimpleNamespace(
        name="a", signature="", parameters=(), is_sudden=False, is_never_exact=False
    )
    weighing = SimpleNamespace(
        candidates=[SimpleNamespace(label=n, effect=effect) for n in labels],
        gains=lambda _: np.array([9.0, -20.0, 8.5, -30.0]),
        without=lambda *_, **__: SimpleNamespace(terms=(), score=0.0),
        extend=lambda _, k, **__: SimpleNamespace(fit=None, score=scores[k]),
        tried={},
        index_of=labels.index,
    )
    term = SimpleNamespace(label="a", effect=effect)
    found = SimpleNamespace(fit=SimpleNamespace(terms=(term,)), score=9.0, labels={"a"})
    assert rivals_of(weighing, found, 0).labels == ("a", "exact")


def test_an_effect_that_leaves_all_to_its_helpers_is_no_rival():
    """A height that one tool's length makes: neither radii nor scales beside that length do."""
    labels = ["spindle_growth Z", "tool_length T1", "tool_radius T1", "scale X"]
    readings = np.eye(4)
    columns = [readings[0], readings[0], readings[1], readings[2]]
    candidates = [
        SimpleNamespace(
            label=label,
            effect=catalogue()[label.split()[0]],
            target=label.split()[1],
            signatures_mm=column[:, None, None],
        )
        for label, column in zip(labels, columns, strict=True)
    ]
    others = SimpleNamespace(
        terms=(), score=0.0, posterior=SimpleNamespace(whiten=lambda columns: columns)
    )
    gains = np.array([9.0, -9.0, -9.0, -9.0])
    weighing = SimpleNamespace(
        candidates=candidates,
        gains=lambda _: gains,
        without=lambda *_, **__: others,
        extend=lambda _, k, **__: SimpleNamespace(fit=None, score=gains[k]),
        tried={frozenset(labels[:1]): 9.0},
        index_of=labels.index,
    )
    fit = SimpleNamespace(terms=candidates[:1], explained_mm=lambda _: 5.0 * readings[0])
    found = SimpleNamespace(fit=fit, score=9.0, labels=frozenset(labels[:1]))
    rivals = rivals_of(weighing, found, 0)
    assert rivals.names == ("spindle_growth", "tool_length")


@pytest.mark.parametrize(("along_y", "is_told"), [(1.0, False), (2.2, True)])
def test_scatter_that_knows_the_axes_is_no_noise(tmp_path, along_y, is_told):
    """Walls along X and Y of one part: a device's noise is the same on both."""
    job = write_job(tmp_path)
    points = tmp_path / "points.csv"
    random, lines = np.random.default_rng(2), points.read_text().splitlines()
    rows = [lines[0]]
    for line in lines[1:]:
        cells = line.split(",")
        n = np.array(cells[5:8], dtype=float)
        size = along_y if abs(n[1]) > abs(n[0]) else 1.0
        for k in range(4):  # four points close together
            place = np.array(cells[2:5], dtype=float)
            place[2] += 0.05 * k * (n[2] == 0.0)
            seen = place + 5e-4 * size * random.standard_normal() * n
            name = [f"{len(rows)}", cells[1], *(f"{v:.6f}" for v in place), *cells[5:8]]
            rows.append(",".join([*name, *(f"{v:.6f}" for v in seen), "0.5"]))
    points.write_text("\n".join(rows))
    weighing = prepare_weighing(survey_job(job), [catalogue()["backlash"]])
    told = remains_um(weighing, weighing.nothing())
    assert (told > 0.5) == is_told
    # it is a rest beside an effect of that axis, and none beside one of the other
    both = weighing.nothing()
    for label in ("backlash X", "backlash Y"):
        both = weighing.extend(both, weighing.index_of(label), resize=False)
    _, (beside_x, beside_y) = where_they_act_um(weighing, both, 2)
    assert beside_x < 0.3
    assert beside_y == pytest.approx(0.5 * np.sqrt(along_y**2 - 1.0), abs=0.3)


def test_what_wanders_in_time_is_a_doubt_about_effects_that_do(tmp_path):
    """A slow rest is no leaving of lost motion, whose sides come in an order of chance."""

    def wandering(q, side, time):
        return lost_motion(q, side, time) + 4.0 * np.sin(time / 110.0)[:, None]

    effects = [catalogue()[name] for name in ("backlash", "ambient_drift")]
    weighing = prepare_weighing(survey_job(tip_job(tmp_path, wandering)), effects)
    play, drift = (
        weighing.extend(weighing.small(), weighing.index_of(label), resize=False)
        for label in ("backlash X", "ambient_drift XYZ")
    )
    sizes = weighing.resized(play, play.posterior.sizes).posterior.sizes
    shares = []
    for one in (play, drift):
        here = weighing.explain(one.terms, sizes, refine=False, resize=False)
        _, (rest,) = where_they_act_um(weighing, here, 1)
        shares.append(rest / remains_um(weighing, here))
    # sides in an order of chance are a wandering as far as that has columns for the readings
    assert shares[0] < 0.5 and shares[1] > 0.8


def test_readings_that_stand_apart_are_told_by_the_others_where_they_are_few():
    value = np.array([1.0, 1.1, 40.0, 0.9, 1.0, 5.0, 6.0, *np.arange(8.0)])
    group = np.array(["five"] * 5 + ["two"] * 2 + ["eight"] * 8)
    apart = apart_from_few(value, group)
    assert apart[:5] == pytest.approx([0.05, 0.1, 39.0, 0.15, 0.05], abs=0.06)
    assert np.isinf(apart[5:7]).all() and not apart[7:].any()
    # what neighbours tell elsewhere stays
    both = apart_from_neighbours(value, group, few=apart)
    assert both[:7] == pytest.approx(apart[:7])
    assert both[7:] == pytest.approx(apart_from_neighbours(value, group)[7:])


def test_readings_that_are_what_was_predicted_have_plain_noise(tmp_path):
    weighing = prepare_weighing(survey_job(tip_job(tmp_path, nothing)), [catalogue()["backlash"]])
    survey = weighing.survey
    exact = [
        replace(m, measured_mm=m.predicted_mm.copy(), predicted_mm=m.predicted_mm.copy())
        for m in survey.measurements
    ]
    weighing = weighing.on(replace(survey, measurements=tuple(exact)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        noise = noise_before(weighing)
    assert np.all(noise.weight == 1.0) and noise.log_prior == 0.0


def test_a_measurement_that_is_not_followed_is_noted():
    """Odd readings, and what the measuring machine did, are told elsewhere: they do not count."""
    rms = {
        "part.csv": {"before": 4.0, "after": 9.0, "expected_noise": 0.8},
        "drift.csv": {"before": 3.0, "after": 1.2, "expected_noise": 0.3},
    }
    after_mm = 1e-3 * np.array([0.9, -0.9, 18.0, 1.2, -1.2])
    weight = np.array([1.0, 1.0, 0.01, 1.0, 1.0])
    survey = SimpleNamespace(rows=(slice(0, 3), slice(3, 5)))
    weighing = SimpleNamespace(
        survey=survey, base=SimpleNamespace(noise=SimpleNamespace(weight=weight))
    )
    residuals = SimpleNamespace(
        fit="some", rms_um_by_measurement=list(rms.items()), after_mm=after_mm
    )
    found = SimpleNamespace(is_structure=False, weighing=weighing)
    (note,) = not_followed(found, residuals, {})
    assert "does not follow drift.csv: 1.2 um RMS are left where noise makes 0.3" in str(note)
    of_device = {"scale of the instrument": np.array([0.0, 0.0, 0.0, 1.2e-3, -1.2e-3])}
    assert not [*not_followed(found, residuals, of_device)]
    assert not [*not_followed(SimpleNamespace(is_structure=True), residuals, {})]


def test_each_measurement_has_its_residual(tmp_path):
    job = write_job(tmp_path, more=TIP)
    (tmp_path / "tip").mkdir()
    tip_job(tmp_path / "tip", nothing)
    (tmp_path / "tip.csv").write_text((tmp_path / "tip" / "tip.csv").read_text())
    found = diagnose(survey_job(job))
    each = as_json(found)["measurements"]
    assert [m["name"] for m in each] == ["points.csv", "tip.csv"]
    count = np.array([len(m) for m in found.residuals.survey.measurements])
    squares = np.array([m["rms_um"]["before"] for m in each]) ** 2
    assert np.sqrt(count @ squares / count.sum()) == pytest.approx(found.rms_um["before"], rel=1e-3)
    assert re.search(r"tip.csv: [\d.]+ um, noise", as_text(found))


def test_a_curve_that_a_part_alone_shows_has_no_level():
    finding = Finding(
        catalogue()["component"], "EZX", {}, {}, Rivals(("component",), ("component EZX",)),
        "X -500 .. -400 mm", {}, is_relative=True,
    )  # fmt: skip
    said = as_text(SimpleNamespace(
        verdict="named", findings=(finding,), proposals=(), weak=(), failures=(), blind_spots=(),
        next_measurement=None, notes=(), remains_um=0.0, of_device_um={},
        rms_um={"before": 2.0, "after": 1.0, "expected_noise": 1.0},
        residuals=SimpleNamespace(
            states=("before", "after"), rms_um_by_measurement=[],
            survey=SimpleNamespace(effects=()),
        ),
    ))  # fmt: skip
    assert "where: X -500 .. -400 mm\n    up to a level and a slope" in said
    assert "error table EZX (straightness of X in Z)" in said


@pytest.mark.parametrize(
    ("support", "said"),
    [
        (Support(2.96, 3.8, 0.0), "log odds 3.0, less than 3.45"),
        # a rest of half its size is even odds, one of its size 1 to 4
        (Support(11.3, 1.0, 1.0), "log odds 11.3, but to 80 % an imitation of something else"),
    ],
)
def test_a_weak_effect_comes_with_the_number_that_decides(support, said):
    assert weak_words(Weak(None, support, Reason.DOUBTFUL)) == said
    assert weak_words(Weak(None, support, Reason.REPLACED)) == str(Reason.REPLACED)


def test_a_share_of_tables_that_no_control_has_is_not_told(tmp_path):
    """A machine that errs by six times its tables errs by something else."""

    def waved(x):
        return 2.0 * np.sin(x / 40.0) + 0.02 * x

    def hidden(q, side, time):
        return np.column_stack([6.0 * waved(q[:, 0]), 6.0 * waved(q[:, 1]), 0 * time])

    job = tip_job(tmp_path, hidden, count=150)
    for name in ("EXX", "EYY"):
        write_table(tmp_path, name, (-400.0, 0.0), waved)
        with (tmp_path / "machine.toml").open("a") as machine:
            machine.write(f'[errors.{name}]\ntable = "errors/{name}.csv"\n')
    found = diagnose(survey_job(job))
    assert "error_tables" not in {finding.name for finding in found.findings}


def test_a_size_is_impossible_for_the_search_as_it_is_for_the_verdict(tmp_path, monkeypatch):
    """What laws leave open counts as uncertainty there; else none would take the effect's place."""
    weighing = prepare_weighing(survey_job(tip_job(tmp_path, stretched_and_loose, count=150)))
    wrong = weighing.extend(weighing.nothing(), weighing.index_of("component EXX"))
    careful = weighing.careful(wrong)
    monkeypatch.setattr(moves, "impossible_terms", lambda fit: [0] if fit is careful else [])
    assert moves.search_possible(weighing, wrong).labels == {"scale X", "backlash Y"}


def test_sets_that_were_tried_count_beside_slightly_other_noise(tmp_path):
    weighing = prepare_weighing(
        survey_job(tip_job(tmp_path, lost_motion)), [catalogue()["backlash"]]
    )
    found = weighing.extend(weighing.nothing(), weighing.index_of("backlash X"))
    weighing.tried = {found.labels: -3.0, frozenset(["backlash Y"]): -5.0}
    other = weighing.with_noise(replace(weighing.base.noise, share=0.5))
    assert not other.tried
    told = other.remembered_as(weighing, replace(found))
    assert told.labels == found.labels and other.tried[found.labels] == found.score
    assert other.tried[frozenset(["backlash Y"])] == pytest.approx(found.score - 2.0)


def test_what_stands_for_two_with_an_impossible_size_gives_way_to_both(tmp_path, monkeypatch):
    """Neither of them alone comes near it."""
    weighing = prepare_weighing(survey_job(tip_job(tmp_path, stretched_and_loose, count=150)))
    wrong = weighing.extend(weighing.nothing(), weighing.index_of("component EXX"))

    def impossible(fit):
        return [k for k, term in enumerate(fit.terms) if term.label == "component EXX"]

    monkeypatch.setattr(moves, "impossible_terms", impossible)
    found = moves.search_possible(weighing, wrong)
    assert found.labels == {"scale X", "backlash Y"}
