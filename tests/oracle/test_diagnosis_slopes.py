"""A curve of a table that nobody measured has no slope that a plain law is (ISO 230-1)."""

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.named_fit import fit_named
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects.laws.geometry.component import Component
from vmach.effects.trial_path import trial_path

LEAN_URAD, SCALE_PPM = 40.0, -25.0


@pytest.mark.parametrize("target", ["EXX", "EXY", "EBY"])
def test_what_lies_beyond_a_slope_has_none(target):
    """Least squares by numpy over a stretch that was not used for the knots."""
    path, effect = trial_path(), Component()
    low, high = path.job.machine.travel_mm[:, "XYZ".index(target[2])]
    nose = np.linspace([0.7 * low + 0.3 * high] * 3, [0.1 * low + 0.9 * high] * 3, 57)
    inner = effect.beyond_slope({"length_mm": 120.0}, target, nose)
    knots = effect.knots_mm(path, target)
    place = np.linspace(nose[0, 0], nose[-1, 0], 2001)
    for seed in range(20):
        amounts = np.random.default_rng(seed).standard_normal(len(knots))
        whole, beyond = (
            np.interp(place, knots, effect.curve(path, target, **one) @ amounts)
            for one in ({"length_mm": 120.0}, inner)
        )
        line = np.polynomial.Polynomial.fit(place, whole, 1)(place)
        # the mean line of a hundred places is nearly that of thousands
        np.testing.assert_allclose(beyond, whole - line, atol=0.02 * np.ptp(whole))


def plate(folder, *, seed, bend_um):
    """Holes of a machine without tables: squareness, a scale, and an X axis that is not straight.

    Closed forms written here: dx = s x - c y, dy = a bow along X.
    """
    random = np.random.default_rng(seed)
    place = np.round(random.uniform(-100.0, 100.0, (220, 2)), 2)
    x, y = place.T
    bow = bend_um * ((y / 100.0) ** 2 - 1.0 / 3.0)
    moved = np.column_stack(
        [1e-3 * SCALE_PPM * x - 1e-3 * LEAN_URAD * y + bow, np.zeros(len(x))]
    ) + 1.0 * random.standard_normal((len(x), 2))
    job = write_job(folder, more=measurement("holes", u_um=1.0))
    text = [line for line in job.read_text().splitlines() if not line.startswith("measured")]
    job.write_text("\n".join(text).replace("tool_length_mm = 100\n", "") + "\n")
    drills = [f"X{a:.3f} Y{b:.3f}" for a, b in place]
    head = ["%", "G21 G17 G90", "T1 M6", "S3000 M3", "G54 G43 H1", "G0 X0 Y0 Z20"]
    lines = [*head, f"G81 Z-10 R2 F300 {drills[0]}", *drills[1:], "G80", "G0 Z20", "M30", "%"]
    (folder / "part.nc").write_text("\n".join(lines) + "\n")
    rows = np.hstack([place, place + 1e-3 * moved])
    np.savetxt(
        folder / "holes.csv", rows, delimiter=",", header="x,y,mx,my", comments="", fmt="%.6f"
    )
    return job


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_squareness_is_shown_beside_an_axis_that_is_not_straight(tmp_path, seed):
    """One curve could do both; what is a slope is called by its name, with a narrow interval."""
    found = diagnose(survey_job(plate(tmp_path, seed=seed, bend_um=4.0)))
    (lean,) = [f for f in found.findings if f.name == "squareness"]
    low, high = lean.interval_95["squareness_urad"]
    assert low - 3.0 < LEAN_URAD < high + 3.0 and high - low < 20.0
    (bow,) = [f for f in found.findings if "component EXY" in f.rivals.labels]
    assert not set(bow.rivals.labels) & {"squareness C0Y", "scale X"}


def test_what_is_added_has_the_size_that_was_said(tmp_path):
    """Fitted by their names the two are split as they are in the diagnosis."""
    survey = survey_job(plate(tmp_path, seed=2, bend_um=4.0))
    named = fit_named(survey, ["component:EXY", "squareness:C0Y", "scale:X"])
    (lean,) = [one for one in named if one.effect.name == "squareness"]
    u = lean.u["squareness_urad"]
    assert u < 5.0
    assert lean.parameters["squareness_urad"] == pytest.approx(LEAN_URAD, abs=3.0 * u)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_stated_squareness_goes_before_a_curve_that_is_as_probable(tmp_path, seed):
    """Nobody measured the tables, and somebody the squareness: what is out is told plainly."""
    job = plate(tmp_path, seed=seed, bend_um=0.0)
    with (tmp_path / "machine.toml").open("a") as machine:
        machine.write("[squareness]\nEC0Y = 5.0\n")
    (lean,) = [f for f in diagnose(survey_job(job)).findings if f.name != "scale"]
    assert lean.label == "squareness C0Y"
    assert "component EXY" in lean.rivals.labels
