"""Circular tests of ISO 230-4: figures that follow in closed form from one error at a time."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.small_job import write_job
from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.features.circular_test import circular_figures
from vmach.job import read_job
from vmach.machine import Variant
from vmach.path.preparation import prepare
from vmach.report.figures.circular_tests import circular_exceeded
from vmach.run.circular_tests import job_circular_tests

RADIUS_MM, FEED = 100.0, 3000.0
SAMPLE = Path(__file__).parents[2] / "samples/iso230_4"
CIRCLES = """\
%
G21 G17 G90 G94 G40
T1 M6
S6000 M3
G54 G43 H1
G0 X-100 Y0 Z5
G3 X100 I100 J0 F3000
G3 I-100 J0
G3 X-100 I-100 J0
G2 X100 I100 J0
G2 I-100 J0
G2 X-100 I-100 J0
M5
M30
%
"""


def found(folder, errors=None, *, squareness="", effects="", limits="", program=CIRCLES):
    job = write_job(
        folder, errors, squareness=squareness, more=f"[circular_test]\n{limits}\n{effects}"
    )
    (folder / "part.nc").write_text(program)
    job = read_job(job)
    preparation = prepare(job)
    return job_circular_tests(
        job, preparation, Variant.ABBE, read_effects(job.effects, file=job.path, job=job)
    )


def test_a_perfect_machine_makes_a_circle(tmp_path):
    (test,) = found(tmp_path)
    assert (test.plane, test.radius_mm, test.feed_mm_min) == ("XY", RADIUS_MM, FEED)
    assert test.lines == (8, 11)
    assert vars_of(test) == pytest.approx([0.0] * 6, abs=1e-9)


def vars_of(test):
    f = test.figures
    return [f.G_ccw, f.G_cw, f.G_b, f.D, f.F_min, f.F_max]


def test_a_scale_makes_an_ellipse(tmp_path):
    """Radial R s cos^2: R s from end to end, half of that on average."""
    (test,) = found(tmp_path, effects="[effects.scale.X]\nscale_ppm = 100")
    across = RADIUS_MM * 100e-6
    assert vars_of(test) == pytest.approx(
        [across, across, across, across / 2, 0.0, across], abs=2e-5
    )


def test_squareness_leans_it_at_45_degrees(tmp_path):
    """Radial R sigma sin cos: R sigma from end to end, nothing on average."""
    (test,) = found(tmp_path, squareness="[squareness]\nEC0Y = 80\n")
    across = RADIUS_MM * 80e-6
    assert vars_of(test) == pytest.approx(
        [across, across, across, 0.0, -across / 2, across / 2], abs=across / 400
    )


def test_lost_motion_steps_where_the_axis_reverses(tmp_path):
    """Radial +-b/2 |cos| on the quadrants, the other sign the other way round."""
    (test,) = found(tmp_path, effects="[effects.backlash.X]\nreversal_um = 10")
    # a node of the 126 that lies on the step may count for either side of it: 0.08 um on average
    assert vars_of(test) == pytest.approx([0.01, 0.01, 0.01, 0.0, -0.005, 0.005], abs=1e-4)


def test_servo_mismatch_leans_each_way_to_its_own_side(tmp_path):
    """Along the velocity v, opposite on two axes: +-a sin 2 theta, a = v m / 2 for m between them.

    One way alone shows 2 a, both ways together the same, and their mean is a circle.
    """
    (test,) = found(tmp_path, effects="[effects.servo_mismatch.XY]\nmismatch_ms = 0.2")
    speed_mm_s = FEED / 60.0
    across = speed_mm_s * 0.2e-3
    f = test.figures
    assert f.G_ccw == pytest.approx(f.G_cw, rel=1e-6)
    assert f.G_b == pytest.approx(f.G_ccw, rel=0.01)
    assert f.G_ccw == pytest.approx(across, rel=0.01)
    assert pytest.approx(0.0, abs=1e-6) == f.D


def test_an_off_centre_path_is_as_round():
    angle = np.linspace(0, 2 * np.pi, 361)
    radial = 0.02 * np.cos(angle) + 0.003 * np.cos(3 * angle)
    figures = circular_figures((angle, angle), (radial, radial + 0.004))
    assert figures.G_ccw == pytest.approx(0.006, abs=1e-9)
    assert figures.G_b == pytest.approx(0.010, abs=1e-9)
    assert pytest.approx(0.002, abs=1e-5) == figures.D


def test_limits_name_what_is_too_large(tmp_path):
    limits = "G_um = 9\nG_b_um = 11\nD_um = 4\nF_um = 20"
    (test,) = found(tmp_path, effects="[effects.scale.X]\nscale_ppm = 100", limits=limits)
    assert circular_exceeded(test) == ["G", "D"]


def test_a_program_without_pairs_is_refused(tmp_path):
    one_way = CIRCLES.replace("G2 ", "G3 ")
    with pytest.raises(InputError, match=r"part\.nc: \[circular_test\], but no full circle"):
        found(tmp_path, program=one_way)


def test_the_sample_prints_its_table(tmp_path, capsys):
    from vmach.commands.machining import run

    run(SAMPLE, out=tmp_path / "out", solid=False, as_json=True)
    told = json.loads(capsys.readouterr().out)["circular_tests"]
    assert [(t["plane"], t["radius_mm"]) for t in told] == [("XY", 100), ("ZX", 50), ("YZ", 50)]
    assert told[0]["G_b_um"] > told[0]["G_cw_um"] > 0.0
    page = (tmp_path / "out" / "report.html").read_text()
    assert 'id="circles"' in page and "Circular tests, ISO 230-4" in page


@pytest.mark.parametrize("squareness_urad", [3.0, -40.0])
def test_the_uncertainty_of_squareness_is_that_of_the_figures(tmp_path, squareness_urad):
    """G is R times the angle, so that u(G) is R times u of the angle; the mean radius stays."""
    squareness = f"[squareness]\nEC0Y = {squareness_urad}\n"
    job = write_job(tmp_path, squareness=squareness, more="[circular_test]\n")
    machine = tmp_path / "machine.toml"
    machine.write_text(machine.read_text() + "\n[uncertainty]\nsquareness_urad = 2.0\n")
    (tmp_path / "part.nc").write_text(CIRCLES)
    read = read_job(job)
    (test,) = job_circular_tests(read, prepare(read), Variant.ABBE, ())
    wanted = RADIUS_MM * 2e-6
    assert test.u.G_ccw == pytest.approx(wanted, rel=2e-3)
    assert test.u.G_cw == pytest.approx(wanted, rel=2e-3)
    assert test.u.G_b == pytest.approx(wanted, rel=2e-3)
    assert abs(test.u.D) < 1e-9
    assert test.u.F_max == pytest.approx(wanted / 2, rel=2e-3)


def test_figures_are_the_sums_that_their_weights_say():
    """Against the definition: concentric circles found by trying centres around."""
    random = np.random.default_rng(5)
    angle = np.sort(random.uniform(0.0, 2.0 * np.pi, (2, 60)))
    radial = 1e-3 * random.standard_normal((2, 60))
    f = circular_figures(tuple(angle), tuple(radial))
    rows = np.column_stack([np.cos(angle[0]), np.sin(angle[0])])

    def width(centre):
        return np.ptp(radial[0] - rows @ centre)

    grid = np.linspace(-2e-3, 2e-3, 161)
    smallest = min(width(np.array([x, y])) for x in grid for y in grid)
    assert smallest - 1e-4 < f.G_ccw <= smallest + 1e-12
