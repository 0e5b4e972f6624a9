"""A carriage that tilts as no table of the machine can say, read by a level: simulated here."""

import re

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.small_job import measurement, write_job
from vmach.cli import app
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.proposals.form_columns import FormColumns
from vmach.diagnosis.proposals.states import DIRECTIONS, TILTS
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import catalogue, load_effect_file

PLACES = np.linspace(-380.0, -20.0, 15)
STOP_S = 12.0
#: of a reading, um over a metre
NOISE = 0.8


def level_job(folder, tilt, *, about="B", seed=0):
    """Four runs along X, out and back; `tilt` gives um over a metre of place, side and time."""
    random, rows = np.random.default_rng(seed), []
    for run in range(1, 5):
        for side in (1, -1):
            for place in PLACES[::side]:
                time_s = STOP_S * len(rows)
                value = tilt(place, side, time_s) + NOISE * random.standard_normal()
                rows.append(f"{run},{place:.2f},{side},{time_s:.1f},{value:.2f}")
    job = write_job(
        folder,
        more=measurement("level", axis="X", about=about, at_mm=[-200, -150, -150], u_um=NOISE),
    )
    kept = [line for line in job.read_text().splitlines() if not line.startswith("measured")]
    job.write_text("\n".join(kept) + "\n")
    head = "run,position_mm,approach,t_s,tilt_um_per_m"
    (folder / "level.csv").write_text("\n".join([head, *rows]) + "\n")
    return job


def pitch(place):
    """A pitch as tables hold it, um over a metre."""
    return 18.0 * np.sin(np.pi * (place + 400.0) / 250.0)


def nods(place, side, time_s):
    """The carriage tips forward, whichever way it goes."""
    return -4.0 * side


@pytest.mark.parametrize(("about", "axis"), [("A", "X"), ("B", "Y")])
@pytest.mark.parametrize("table", [lambda place: 0.0, pitch])
def test_a_tilt_that_follows_the_direction_of_travel_is_a_form(tmp_path, about, axis, table):
    """Beside a pitch that a table says, or alone."""
    job = level_job(tmp_path, lambda *at: table(at[0]) + nods(*at), about=about)
    found = diagnose(survey_job(job))
    first = found.proposals[0]
    assert first.form.formula == f"direction of X, as a tilt about {axis} over a metre"
    assert first.amount_um == pytest.approx(-4.0, abs=4.0 * first.amount_u_um)
    assert "read the tilts again" in first.form.refute
    assert found.verdict == ("unknown" if table(-300.0) == 0.0 else "partly")


def test_a_tilt_that_swings_is_a_form(tmp_path):
    """A chiller that warms one side of a column, every 400 s."""
    job = level_job(tmp_path, lambda place, side, t: 5.0 * np.sin(2.0 * np.pi * t / 400.0 + 0.4))
    first = diagnose(survey_job(job)).proposals[0]
    assert first.form.kinds == {"wave in time"} and first.form.direction in TILTS
    (period_s,) = re.findall(r"a wave of ([\d.]+) s in time", first.form.formula)
    assert float(period_s) == pytest.approx(400.0, rel=0.02)


def straight(place):
    """Runs out and back make it a wave in time, um over a metre."""
    return 0.06 * (place + 200.0)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("table", [pitch, straight])
def test_a_pitch_is_no_form(tmp_path, table, seed):
    """A tilt over places is an angular error motion by definition (ISO 230-1)."""
    job = level_job(tmp_path, lambda place, side, t: table(place), seed=seed)
    found = diagnose(survey_job(job))
    assert {f.label for f in found.findings} == {"component EBX"}
    assert not found.proposals


def test_a_carriage_that_runs_true_gets_neither(tmp_path):
    found = diagnose(survey_job(level_job(tmp_path, lambda place, side, t: 0.0)))
    assert found.verdict == "nothing" and found.proposals == ()


def test_a_tilt_is_an_effect_file_that_can_be_added(tmp_path):
    job, file = level_job(tmp_path, nods), tmp_path / "proposed_nod.py"
    run = CliRunner().invoke
    said = run(app, ["effects", "propose", str(job), "-o", str(file)]).stdout
    assert "as a tilt about Y over a metre" in said
    effect = load_effect_file(file)
    try:
        assert effect.turns_tool and not effect.needs_surface
        path = survey_job(job).paths[0]
        moved = effect.displacement(path, "", amount_um=-4.0)
        # 4 um over a metre are 4 urad, about Y, against the motion; the tip stays
        wanted = np.outer(-4e-6 * path.play_side[:, 0], [0.0, 1.0, 0.0])
        np.testing.assert_allclose(moved.tilt_rad, wanted, atol=1e-12)
        assert not moved.shift_mm.any()
        added = run(app, ["add", str(job), "proposed_nod", "-o", str(tmp_path / "2.toml")]).stdout
        before, after = map(float, re.search(r"([\d.]+) um before, ([\d.]+) um", added).groups())
        assert before > 3.0 and after < 1.2 * NOISE
    finally:
        catalogue().pop("proposed_nod", None)


def test_tilts_are_asked_for_where_something_reads_them(tmp_path):
    """A level senses no displacement, a laser no tilt; each asks for its own forms."""
    level = survey_job(level_job(tmp_path, nods))
    asked = {form.direction for form in FormColumns(level).forms}
    assert asked == set(TILTS)
    (folder := tmp_path / "laser").mkdir()
    laser = level_job(folder, nods)
    text = laser.read_text().replace('"level"', '"laser"').replace('about = "B"\n', "")
    laser.write_text(text)
    table = (folder / "level.csv").read_text()
    (folder / "level.csv").write_text(table.replace("tilt_um_per_m", "deviation_um"))
    asked = {form.direction for form in FormColumns(survey_job(laser)).forms}
    assert set(DIRECTIONS[:3]) < asked and not asked & set(TILTS)
