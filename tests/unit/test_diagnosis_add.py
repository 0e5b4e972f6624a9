"""What `vmach add` says: what it brought, what is not called for, and why something cannot be."""

import json
import re
import tomllib
from importlib import import_module

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.unit.test_diagnosis_verdicts import lost_motion, nothing, tip_job
from vmach.cli import app
from vmach.diagnosis.named_fit import fit_named
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import load_effect_file
from vmach.errors import InputError
from vmach.history import history_of
from vmach.history.added_effects import add_effects


def add(*words):
    found = CliRunner().invoke(app, ["add", *map(str, words)])
    assert found.exit_code == 0, found.exception
    return found.stdout


@pytest.fixture(scope="module")
def loose(tmp_path_factory):
    """A machine with 4 um of lost motion in X, seen at its tip."""
    return tip_job(tmp_path_factory.mktemp("loose"), lost_motion)


def test_it_says_sizes_with_their_uncertainty_and_how_the_error_fell(loose):
    said = add(loose, "backlash:X")
    assert "(u = 0." in said and "um before" in said and "note:" not in said
    found = json.loads(add(loose, "backlash:X", "--json"))
    assert found["rms_um"]["before"] > 1.0 > 0.7 > found["rms_um"]["after"]
    assert found["notes"] == []


def test_what_a_job_leaves_open_is_as_wide_as_what_is_said(loose, tmp_path):
    """GUM, eq. 13: independent changes add up in squares to the standard uncertainty of each."""
    job = tmp_path / "loose.toml"
    (found,) = json.loads(add(loose, "backlash:X", "--json", "-o", job))["effects"]
    (fitted,) = tomllib.loads(job.read_text())["fitted"]
    for name, u in found["u"].items():
        wide = np.linalg.norm([change[name] for change in fitted["one_sigma"]])
        assert wide == pytest.approx(u, rel=0.01), name


def test_it_says_what_the_measurements_do_not_call_for(loose):
    said = add(loose, "backlash:X", "squareness:C0Y")
    assert "note: these measurements do not call for squareness C0Y" in said
    assert "call for backlash" not in said


def test_clean_readings_call_for_nothing(tmp_path):
    survey = survey_job(tip_job(tmp_path, nothing))
    for name in ("backlash:X", "scale:Y", "component:EZX"):
        (found,) = fit_named(survey, [name])
        assert not found.is_called_for, name


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["backlash", "backlash:X"], "backlash X is named twice; accepted: backlash:Y, backlash:Z"),
        (["backlash:X", "backlash:X"], "backlash:X is named twice"),
        (["backlash:Q"], "backlash has no target 'Q'; accepted: backlash:X, backlash:Y"),
        (["probe_radius"], "cannot show probe_radius: no machined surface was measured$"),
        (["fixture"], "this job has nothing that fixture could act on$"),
        (["backlsh"], "did you mean 'backlash'"),
        (["bed_twist"], "is it an effect of your own.*--effect-file"),
    ],
)
def test_why_an_effect_cannot_be_added(loose, names, message):
    before = sorted(loose.parent.iterdir())
    with pytest.raises(InputError, match=message):
        add_effects(loose, names)
    assert sorted(loose.parent.iterdir()) == before


def test_an_effect_that_is_there_is_refused_with_its_line(loose, tmp_path):
    job, _ = add_effects(loose, ["backlash:X"], out=tmp_path / "second.toml")
    line = 1 + job.read_text().splitlines().index("[effects.backlash.X]")
    with pytest.raises(InputError, match=rf"second\.toml:{line}: .*already"):
        add_effects(job, ["backlash:X"])


def test_a_correction_is_told_by_its_place(tmp_path):
    def dent(q, side, time):
        return np.outer(8.0 * np.exp(-0.5 * ((q[:, 0] + 150.0) / 25.0) ** 2), [0.0, 0.0, 1.0])

    said = add(tip_job(tmp_path, dent, count=150), "component:EZX")
    assert "component EZX: a correction curve, X -" in said and "most at -1" in said


SLOPE = """\
from vmach.effects import Effect, along, linear
class Slope(Effect):
    name = "bed_slope"
    title = "slope of the bed"
    parameters = (linear("rise_um_per_m", "rise along X", usual=10.0),)
    targets = ("",)
    def displacement(self, path, target, rise_um_per_m):
        return along("Z", 1e-6 * rise_um_per_m * path.nose_mm[:, 0])
"""


@pytest.mark.usefixtures("no_effects_added")
def test_a_job_says_which_file_its_own_effect_is_in(loose, tmp_path, monkeypatch):
    """The file is named by the history, as seen from each job of the chain."""
    shop = tmp_path / "shop"
    shop.mkdir()
    (shop / "slope.py").write_text(SLOPE)
    load_effect_file(shop / "slope.py")
    second, _ = add_effects(loose, ["bed_slope"], out=tmp_path / "second.toml")
    third, _ = add_effects(second, ["backlash:X"], out=shop / "third.toml")
    assert 'effect_files = {bed_slope = "shop/slope.py"}' in second.read_text()
    assert third.read_text().endswith('effect_files = {bed_slope = "slope.py"}\n')
    monkeypatch.setattr(import_module("vmach.effects.catalogue"), "_added", {})
    for job, file in ((third, shop / "slope.py"), (second, tmp_path / "shop" / "slope.py")):
        with pytest.raises(InputError, match=rf"it is in {re.escape(str(file))}: vmach --effect-f"):
            history_of(job)
    (shop / "slope.py").unlink()
    with pytest.raises(InputError, match=r"it was in .*slope\.py, which is not there"):
        history_of(third)
