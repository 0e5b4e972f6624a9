"""`vmach set --effects-of`: what was found on one part holds for another one."""

import json
import tomllib

import pytest
from typer.testing import CliRunner

from tests.small_job import write_job
from tests.unit.test_set_values import ERRORS
from vmach.cli import app
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.errors import InputError
from vmach.history import history_of, rms_um
from vmach.history.taken_effects import take_effects_of
from vmach.job import read_job

FOUND = """
[effects.backlash.Y]
reversal_um = 4

[effects.tool_radius.T1]
radius_um = 6

[effects.tool_slip.T1]
slip_um = 5
time_s = 20

[[fitted]]
effect = "backlash"
target = "Y"
one_sigma = [{reversal_um = 0.2}]

[[fitted]]
effect = "tool_radius"
target = "T1"
one_sigma = [{radius_um = 0.3}]

[[fitted]]
effect = "tool_slip"
target = "T1"
one_sigma = [{slip_um = 0.4}]

[[correlated]]
effects = ["backlash:Y", "tool_radius:T1"]
coefficients = [[0.25]]

[[correlated]]
effects = ["backlash:Y", "tool_slip:T1"]
coefficients = [[0.5]]
"""


@pytest.fixture
def jobs(tmp_path):
    """A job with effects, and that of another part in a folder of its own."""
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
    found = write_job(tmp_path / "first", ERRORS)
    found.write_text(found.read_text() + FOUND)
    other = write_job(tmp_path / "second", ERRORS)
    text = other.read_text()
    other.write_text("# kept\n" + text.replace("machine.toml", "../first/machine.toml"))
    return found, other


def test_the_other_part_is_foretold_as_the_history_foretells_it(jobs):
    found, other = jobs
    written, taken, left = take_effects_of(found, other)
    assert written.parent == other.parent and written.read_text().startswith("# kept")
    assert taken == ("backlash Y", "tool_radius T1")
    assert [(one.label, one.why) for one in left] == [
        ("tool_slip T1", "it began at one moment of that part")
    ]
    said = tomllib.loads(written.read_text())
    assert [entry["effect"] for entry in said["fitted"]] == ["backlash", "tool_radius"]
    assert [entry["coefficients"] for entry in said["correlated"]] == [[[0.25]]]
    # without the slip the first job foretells the other part by a way of its own
    alone = found.with_name("alone.toml")
    alone.write_text(found.read_text().replace("slip_um = 5", "slip_um = 0"))
    by_history = history_of(read_job(alone), check=read_job(other))[-1].check_rms_um
    assert rms_um(survey_job(written)) == pytest.approx(by_history, rel=1e-9)
    assert by_history != pytest.approx(rms_um(survey_job(other)), rel=0.05)


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ("diameter_mm = 10", "diameter_mm = 8", "T1 is another tool here"),
        ("length_mm = 100", "length_mm = 90", "T1 is another tool here"),
    ],
)
def test_errors_of_another_tool_stay_behind(jobs, old, new, why):
    found, other = jobs
    other.write_text(other.read_text().replace(old, new, 1))
    _, taken, left = take_effects_of(found, other)
    assert taken == ("backlash Y",)
    assert ("tool_radius T1", why) in [(one.label, one.why) for one in left]


def test_the_command_tells_both_and_refuses_values_beside_it(jobs, tmp_path):
    found, other = map(str, jobs)
    out = str(tmp_path / "second" / "next.toml")
    words = ["set", other, "--effects-of", found]
    told = json.loads(CliRunner().invoke(app, [*words, "-o", out, "--json"]).output)
    assert told["effects"] == ["backlash Y", "tool_radius T1"]
    assert [one["effect"] for one in told["left_out"]] == ["tool_slip T1"]
    refused = CliRunner().invoke(app, [*words, "backlash:Y.reversal_um=5"])
    assert isinstance(refused.exception, InputError)
    assert "either of them" in str(refused.exception)


def test_what_is_there_already_is_refused(jobs):
    found, other = jobs
    other.write_text(other.read_text() + "\n[effects.backlash.Y]\nreversal_um = 1\n")
    with pytest.raises(InputError, match="has the effect backlash Y already"):
        take_effects_of(found, other)


def test_jobs_without_effects_and_other_machines_are_refused(jobs):
    found, other = jobs
    with pytest.raises(InputError, match="has no effects"):
        take_effects_of(other, found)
    other.write_text(other.read_text().replace("../first/machine.toml", "machine.toml"))
    machine = other.with_name("machine.toml")
    take_effects_of(found, other)  # a copy is the same machine
    machine.write_text(machine.read_text().replace("test machine", "another one"))
    with pytest.raises(InputError, match="is another file"):
        take_effects_of(found, other)


def test_none_that_holds_is_refused_with_the_reason(jobs):
    found, other = jobs
    text = found.read_text()
    only = text[: text.index("\n[effects")] + "\n[effects.tool_slip.T1]\nslip_um = 5\ntime_s = 20\n"
    found.write_text(only)
    with pytest.raises(InputError, match=r"none of its effects .* began at one moment"):
        take_effects_of(found, other)
    assert sorted(p.name for p in other.parent.glob("*.toml")) == ["job.toml", "machine.toml"]
