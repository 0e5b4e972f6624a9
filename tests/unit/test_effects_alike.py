"""Waves that evenly spaced places cannot tell apart are all told."""

import tomllib

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import catalogue
from vmach.effects.laws.geometry.cyclic_pitch import even_step_mm
from vmach.history.added_effects import add_effects

PITCH_MM, AMPLITUDE_UM, PHASE_RAD = 10.0, 5.0, 0.7
EVEN = np.linspace(-392.0, -8.0, 25)  # a step of 16 mm
RANDOM = np.random.default_rng(2).uniform(-5.0, 5.0, 25)


def wave(place_mm, pitch_mm=PITCH_MM, phase_rad=PHASE_RAD):
    return np.sin(2.0 * np.pi * place_mm / pitch_mm + phase_rad)


class Path:
    def __init__(self, places):
        self.nose_mm = np.column_stack([places, np.full((len(places), 2), -100.0)])


@pytest.mark.parametrize(
    ("places", "step"),
    [
        (EVEN, 16.0),
        (np.round(EVEN + 0.004, 2), 16.0),
        (np.delete(EVEN, [3, 4, 9]), 16.0),
        (EVEN + RANDOM, None),
        (EVEN[:8], None),
    ],
)
def test_the_step_of_even_places(places, step):
    assert even_step_mm(places) == (None if step is None else pytest.approx(step, abs=1e-3))


def test_all_that_is_alike_reads_the_same_and_the_truth_is_among_it():
    effect = catalogue()["cyclic_pitch"]
    told = {"amplitude_um": 5.0, "pitch_mm": 1.0 / (2.0 / 16.0 - 0.1), "phase_rad": 0.3}
    others = effect.alike([Path(EVEN)], "X", told)
    for other in others:
        mine = wave(EVEN, told["pitch_mm"], told["phase_rad"])
        np.testing.assert_allclose(
            wave(EVEN, other["pitch_mm"], other["phase_rad"]), mine, atol=1e-9
        )
        assert 3.0 <= other["pitch_mm"] <= 50.0
    assert any(abs(other["pitch_mm"] - PITCH_MM) < 1e-9 for other in others)
    assert effect.alike([Path(EVEN + RANDOM)], "X", told) == ()
    assert effect.alike([Path(EVEN)], "Y", told) == ()  # it stood still


def laser_job(folder, shift=0.0):
    """A laser on an axis with a cyclic pitch, at even targets that are shifted."""
    places = np.round(EVEN + shift, 3)
    job = write_job(folder, more=measurement("laser", axis="X", at_mm=[-200, -150, -100], u_um=0.2))
    job.write_text(job.read_text().replace('measured = "points.csv"\n', ""))
    noise = np.random.default_rng(5)
    lines = ["run,position_mm,approach,t_s,deviation_um"]
    for run in (1, 2, 3):
        for way, row in ((1, places), (-1, places[::-1])):
            for x in row:
                read = AMPLITUDE_UM * wave(x) + noise.normal(0.0, 0.2)
                lines.append(f"{run},{x:.3f},{way},{5 * len(lines)},{read:.3f}")
    (folder / "laser.csv").write_text("\n".join(lines) + "\n")
    return job


@pytest.mark.parametrize(("shift", "alike"), [(0.0 * RANDOM, True), (RANDOM, False)])
def test_the_interval_of_the_pitch_holds_the_truth(tmp_path, shift, alike):
    """ISO 230-2 adds a random amount to each target, so that the pitch is known."""
    found = diagnose(survey_job(laser_job(tmp_path, shift)))
    (finding,) = found.findings
    assert finding.effect.name == "cyclic_pitch"
    low, high = finding.interval_95["pitch_mm"]
    assert low <= PITCH_MM <= high
    assert ("pitch_mm" in finding.weakly_identified) == alike
    said = [str(note) for note in found.notes if "the places lie evenly" in str(note)]
    assert bool(said) == alike
    if not alike:
        assert finding.parameters["pitch_mm"] == pytest.approx(PITCH_MM, abs=0.02)


def test_a_job_leaves_open_what_is_said_of_an_alike_pitch(tmp_path):
    """GUM, eq. 13: independent changes add up in squares to the standard uncertainty of each."""
    written, (found,) = add_effects(laser_job(tmp_path), ["cyclic_pitch:X"])
    (fitted,) = tomllib.loads(written.read_text())["fitted"]
    assert found.u["pitch_mm"] > 5.0 and found.u["amplitude_um"] < 0.2
    for name, u in found.u.items():
        wide = np.linalg.norm([change.get(name, 0.0) for change in fitted["one_sigma"]])
        assert wide == pytest.approx(u, rel=0.01), name
