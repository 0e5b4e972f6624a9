"""The error on a part that was not fitted, against an alignment of the tests' own."""

import json
import re
import shutil

import pytest
from typer.testing import CliRunner

from tests.hidden_effects import program_runs
from tests.hidden_effects.experiment import make_experiment
from vmach.base.note import Kind
from vmach.cli import app
from vmach.errors import InputError
from vmach.history.added_effects import add_effects
from vmach.history.fitted_before import fitted_before
from vmach.job import read_job


def run(*words):
    return CliRunner().invoke(app, ["history", *map(str, words)])


@pytest.fixture(scope="module")
def fixed(tmp_path_factory):
    """A job to which the missing effect was added, the part to check on, and its own job file."""
    folder = tmp_path_factory.mktemp("history")
    made = make_experiment(folder, effects=["backlash"], seed=31)
    job = program_runs.add(folder, program_runs.diagnose(folder)[0])
    text = (folder / "job.toml").read_text()
    (folder / "check.toml").write_text(
        text.replace("part.nc", "check.nc").replace("part_measured", "check_measured")
    )
    return job, made.check


def test_both_ways_to_say_which_part_agree_with_the_tests_own_alignment(fixed):
    job, check = fixed
    points, program = job.with_name("check_measured.csv"), job.with_name("check.nc")
    wanted = [
        program_runs.aligned_rms_um(program_runs.predicted_um(step, points, program=program), check)
        for step in (job.with_name("job.toml"), job)
    ]
    assert wanted[1] < 1.0 < wanted[0]
    for way in (
        ("--check-job", job.with_name("check.toml")),
        ("--check-program", program, "--check-points", points),
    ):
        steps = json.loads(run(job, "--json", *way).stdout)
        assert [s["check_rms_um"] for s in steps] == pytest.approx(wanted, abs=2e-3)


def test_a_doubt_about_the_machine_of_both_parts_is_said_once(fixed, tmp_path):
    job, _ = fixed
    folder = shutil.copytree(job.parent, tmp_path / "copy")
    machine = folder / "machine.toml"
    text = re.sub(r"^(C0Y|EC0Y) = .*$", r"\1 = 0.5", machine.read_text(), flags=re.MULTILINE)
    machine.write_text(text)
    steps = json.loads(
        run(folder / "job.toml", "--json", "--check-job", folder / "check.toml").stdout
    )
    assert sum("a squareness of 0.5" in note for note in steps[0]["notes"]) == 1


def test_jobs_of_one_name_are_told_by_their_folders(fixed, tmp_path, monkeypatch):
    job, _ = fixed
    monkeypatch.chdir(tmp_path)
    later = add_effects(job, ["scale:X"], out=tmp_path / job.name)[0]
    said = run(later, "--picture", tmp_path / "fall.png").stdout
    assert "drawn in" in said and (tmp_path / "fall.png").exists()
    assert said.replace("\n", "").count(job.parent.name) == 2


def test_half_of_another_part_is_refused(fixed):
    job, _ = fixed
    found = run(job, "--check-program", job.with_name("check.nc"))
    assert found.exit_code == 2
    assert "go together" in found.output
    other = job.with_name("check.toml")
    assert run(job, "--check-job", other, "--check-program", other).exit_code == 2


def test_another_part_has_to_be_measured(fixed):
    job, _ = fixed
    bare = job.with_name("bare.toml")
    bare.write_text(job.with_name("check.toml").read_text().replace("measured =", "#"))
    found = run(job, "--check-job", bare)
    assert found.exit_code != 0
    assert "no part was measured" in str(found.exception)


@pytest.mark.parametrize(
    ("effect", "target", "seed"),
    [("ambient_drift", "XYZ", 31), ("tool_deflection", None, 31), ("axis_expansion", "Y", 32)],
)
def test_another_part_lacks_nothing_once_the_effect_is_in_the_model(tmp_path, effect, target, seed):
    """What the model's own effects leave open is no missing effect: weather has another phase."""
    make_experiment(tmp_path, effects=[effect], seed=seed)
    if target is not None:
        truth = json.loads((tmp_path / "truth.json").read_text())["effects"][0]
        target = truth["target"] or target
    added = program_runs.add(tmp_path, {"effects": [{"effect": effect, "target": target}]})
    other = added.read_text().replace("part.nc", "check.nc")
    (tmp_path / "job.toml").write_text(other.replace("part_measured", "check_measured"))
    report, _ = program_runs.diagnose(tmp_path)
    assert report["verdict"] == "nothing"


def test_what_else_is_missing_shows_beside_what_is_open(tmp_path):
    make_experiment(tmp_path, effects=["spindle_growth", "backlash"], seed=31)
    report, _ = program_runs.diagnose(tmp_path)
    warm = [e for e in report["effects"] if e["effect"] == "spindle_growth"]
    added = program_runs.add(tmp_path, {"effects": warm})
    (tmp_path / "job.toml").write_text(added.read_text())
    report, _ = program_runs.diagnose(tmp_path)
    assert [e["effect"] for e in report["effects"]] == ["backlash"]


@pytest.fixture(scope="module")
def warm(tmp_path_factory):
    """A warm workpiece on a machine with a screw that warms: each takes a part of the other."""
    folder = tmp_path_factory.mktemp("warm")
    make_experiment(folder, effects=["axis_expansion", "workpiece_temperature"], seed=71002)
    both = ["axis_expansion:Y", "workpiece_temperature"]
    add_effects(folder / "job.toml", both, out=folder / "both.toml")
    for first, then in (both, both[::-1]):
        one, two = (folder / f"{word.split('_')[0]}.toml" for word in (first, then))
        add_effects(folder / "job.toml", [first], out=one)
        add_effects(one, [then], out=two.with_stem(f"{one.stem}_{two.stem}"))
    return folder


def test_the_order_in_which_effects_are_added_changes_nothing(warm):
    together, *in_turn = (
        read_job(warm / f"{name}.toml") for name in ("both", "axis_workpiece", "workpiece_axis")
    )
    hidden = json.loads((warm / "truth.json").read_text())["effects"][1]["comparable"]
    for job in in_turn:
        for name, targets in together.effects.items():
            for parameter, value in job.effects[name].get("Y", job.effects[name]).items():
                assert value == pytest.approx(
                    targets.get("Y", targets)[parameter], rel=2e-3, abs=2e-3
                )
        assert set(map(frozenset, job.correlated)) == set(map(frozenset, together.correlated))
        assert job.history[-1]["rms_after_um"] < 0.9  # the noise is 0.8 um
    told = together.effects["workpiece_temperature"]["expansion_ppm"]
    u = together.fitted["workpiece_temperature", ""][0]["expansion_ppm"]
    assert abs(told - hidden["expansion_ppm"]) < 3.0 * abs(u)
    # alone, the screw had taken a part of it; a form of a part that swells takes the rest
    alone = read_job(warm / "axis.toml").effects["axis_expansion"]["Y"]["expansion_ppm"]
    assert abs(alone - together.effects["axis_expansion"]["Y"]["expansion_ppm"]) > 10.0


def test_what_was_fitted_to_other_readings_stays(warm):
    """A job that goes on with another part knows what the first part told."""
    known = warm / "another_part.toml"
    text = (warm / "axis.toml").read_text()
    known.write_text(text.replace("part.nc", "check.nc").replace("part_measured", "check_measured"))
    notes = []
    after = read_job(add_effects(known, ["workpiece_temperature"], tell=notes.append)[0])
    assert [n.place for n in notes if n.kind == Kind.KEPT] == ["axis_expansion Y"]
    assert after.effects["axis_expansion"] == read_job(known).effects["axis_expansion"]
    assert after.fitted["axis_expansion", "Y"] == read_job(known).fitted["axis_expansion", "Y"]


def test_what_was_set_stays(warm):
    said = CliRunner().invoke(
        app, ["set", str(warm / "axis.toml"), "axis_expansion:Y.expansion_ppm=50", "-o",
              str(warm / "set.toml")],
    )  # fmt: skip
    assert said.exit_code == 0, said.output
    after = read_job(add_effects(warm / "set.toml", ["workpiece_temperature"])[0])
    assert after.effects["axis_expansion"] == read_job(warm / "set.toml").effects["axis_expansion"]


def test_further_readings_fit_anew_what_the_first_told(warm):
    """More was measured since: the readings that an effect was fitted to are all still there."""
    more = warm / "more.toml"
    drift = "\n".join(["at_s,x_um,y_um,z_um", *(f"{60 * k},0,0,0" for k in range(20))])
    (warm / "drift.csv").write_text(drift)
    test = '\n[[measurements]]\nkind = "drift"\nfile = "drift.csv"\nu_um = 0.5\n'
    more.write_text((warm / "axis.toml").read_text() + test)
    assert fitted_before(read_job(more)) == (("axis_expansion", "Y"),)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "[effects.axis_expansion.Y]",
            "[effects]\nbacklash = 3\n[effects.axis_expansion.Y]",
            "a table",
        ),
        ("[effects.axis_expansion.Y]", "[effects.axis_expansion.X]", r"\[\[fitted\]\] is of"),
        ('previous = "job.toml"', 'previous = "gone.toml"', None),
        ('previous = "job.toml"', 'previous = "spoiled.toml"', None),
    ],
)
def test_a_job_that_was_spoiled_since_is_refused_or_taken_as_it_is(warm, old, new, said):
    spoiled = warm / "spoiled.toml"
    spoiled.write_text((warm / "axis.toml").read_text().replace(old, new))
    if said is None:
        after = read_job(add_effects(spoiled, ["squareness:C0Y"])[0])
        assert after.effects["axis_expansion"] == read_job(spoiled).effects["axis_expansion"]
        return
    with pytest.raises(InputError, match=said):
        add_effects(spoiled, ["squareness:C0Y"])
