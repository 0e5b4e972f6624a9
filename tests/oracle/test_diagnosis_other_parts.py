"""Diagnosis of parts, machines and laws of a second maker, beside noise of several kinds."""

import pytest

from tests.oracle import other_parts as maker
from tests.oracle.other_parts import write_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.residuals.job_survey import survey_job


def found_of(folder, seed, part, causes, noise="white"):
    hidden = write_job(folder, seed, part, causes, noise)
    return hidden, diagnose(survey_job(folder / "job.toml"))


@pytest.mark.parametrize(("part", "noise"), [("pockets", "rigid"), ("contour", "correlated")])
def test_a_machine_as_its_tables_say_lacks_nothing(tmp_path, part, noise):
    assert found_of(tmp_path, 11, part, [], noise)[1].verdict == "nothing"


@pytest.mark.parametrize("noise", ["white", "heavy tails", "u half"])
def test_three_effects_are_told_with_their_amounts(tmp_path, noise):
    causes = [maker.backlash, maker.squareness, maker.tool_radius]
    hidden, found = found_of(tmp_path, 12, "pockets", causes, noise)
    told = {f.label: f for f in found.findings}
    assert told.keys() == {h.label for h in hidden}
    for one in hidden:
        for name, true in one.numbers.items():
            finding = told[one.label]
            assert finding.parameters[name] == pytest.approx(true, abs=4.0 * finding.u[name])


def test_a_screw_that_warms_is_no_form_in_its_place(tmp_path):
    """It stretches evenly: a product of position and warm-up has fewer amounts."""
    causes = [maker.cyclic_pitch, maker.axis_expansion]
    hidden, found = found_of(tmp_path, 70020, "pockets", causes, "rigid")
    assert {f.label for f in found.findings} == {h.label for h in hidden}


@pytest.mark.parametrize(
    ("cause", "said"),
    [
        (
            maker.deeper_walls_lean,
            "depth below the top in 10 mm to the power 1.5, out of the walls",
        ),
        (
            maker.tool_warms_in_use,
            "time since the tool change, settling within 300 s, out of the walls",
        ),
        (
            maker.chilled_part,
            "time since the tool change, settling within 75 s, as the part swells",
        ),
    ],
)
def test_a_cause_that_nobody_foresaw_is_described(tmp_path, cause, said):
    _, found = found_of(tmp_path, 13, "contour", [cause])
    assert found.verdict == "unknown"
    assert said in [p.form.formula for p in found.proposals]
