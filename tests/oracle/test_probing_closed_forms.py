"""[probing]: a zero touched on the machine takes the machine's error there out of the part.

Source: closed forms worked out beside each test, from the definition: the control counts from the
place where it commanded the tool when it touched.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.small_job import measurement, pocket_points, write_job
from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.fit.survey import Survey
from vmach.instruments import measure_part, read_instruments
from vmach.job import read_job
from vmach.machine import Variant
from vmach.nominal.points import SurfacePoints
from vmach.path.preparation import prepare
from vmach.prediction import displacement_of, predict
from vmach.prediction.error_budget import error_budget
from vmach.uncertainty.first_order import prediction_u_mm

#: workpiece zero of the small job in machine coordinates, and the length of its tool
G54, LENGTH = np.array([-200.0, -150.0, -200.0]), 100.0


def deviations(path, **more):
    """Predicted deviation of every point of the small job that is cut, um, and the points."""
    names, points, normals = pocket_points()
    job = read_job(path)
    effects = read_effects(job.effects, file=job.path, job=job)
    found = predict(prepare(job), points, normals, variant=Variant.ABBE, effects=effects, **more)
    assert found.is_cut.all()
    return 1e3 * found.deviation_mm, SurfacePoints(names, names, points, normals)


def moved_um(points, displacement_um):
    """What a displacement of the tool, (P, 3) um, does along the normals."""
    return np.einsum("ij,ij->i", displacement_um, points.normal)


def perfect(tmp_path):
    """Deviations of the program alone: what the tool's shape leaves."""
    return deviations(write_job(tmp_path))[0]


def test_a_constant_offset_is_nothing(tmp_path):
    own = perfect(tmp_path)
    errors = {f"E{a}{a}": (lambda q: 12.0, None) for a in "XYZ"}
    without, _ = deviations(write_job(tmp_path, errors))
    touched, _ = deviations(write_job(tmp_path, errors, more="[probing]\n"))
    assert np.abs(without - own).max() > 11.9
    assert touched == pytest.approx(own, abs=1e-6)


def test_a_linear_error_counts_from_the_place_of_touch(tmp_path):
    """20 um/m in X, touched at x = -30: the tool is 0.02 (x + 30) um too far."""
    own = perfect(tmp_path)
    errors = {"EXX": (lambda q: 0.02 * q, None)}
    more = "[probing]\nx_at_mm = [-30, 4, -2]\n"
    found, points = deviations(write_job(tmp_path, errors, more=more))
    along = np.zeros_like(points.point_mm)
    # the contact is the tool's: on a wall its axis is a radius further in
    tip = points.point_mm[:, 0] + 5.0 * points.normal[:, 0]
    along[:, 0] = 0.02 * (tip + 30.0)
    side = np.abs(points.normal[:, 0]) > 0.99
    assert found[side] - own[side] == pytest.approx(moved_um(points, along)[side], abs=2e-3)


def test_a_tool_of_another_length_touches_for_itself(tmp_path):
    """EZZ is linear in the nose's height: two tools differ by their lengths, until each touches."""
    errors = {"EZZ": (lambda q: 0.05 * q, None)}
    path = write_job(tmp_path, errors, more="\n[probing]\nprobe_length_mm = 80\n")
    job = read_job(path)
    states = prepare(job).path.nodes[:1]

    def z_um(probing):
        other = prepare(replace(job, probing=probing))
        moved = displacement_of(other, states, Variant.ABBE, ())
        return 1e3 * float(moved.shift_mm[0, 2])

    height = float(states.nose_mm[0, 2] - G54[2] - LENGTH)  # of the tip over the zero
    assert z_um(job.probing) == pytest.approx(0.05 * height, abs=1e-9)
    preset = replace(job.probing, tools="preset")  # the probe's touch alone: 80 mm long
    assert z_um(preset) == pytest.approx(0.05 * (height + LENGTH - 80.0), abs=1e-9)
    # a setter 40 mm above the zero: e_z(setter, tool) - e_z(setter, probe) = 0.05 (100 - 80)
    setter = replace(job.probing, tools_at_mm=np.array([50.0, 0.0, 40.0]))
    assert z_um(setter) == pytest.approx(0.05 * height, abs=1e-9)


def test_angles_act_with_the_length_of_the_probe(tmp_path):
    """EBX, read at the nose: the tip of length L is 0.001 L EBX to -X of it; the probe is 60 mm."""
    errors = {"EBZ": (lambda q: 40.0, None), "EXZ": (lambda q: 0.0, (0, 0, 0))}
    path = write_job(tmp_path, errors, more="[probing]\nprobe_length_mm = 60\n")
    preparation = prepare(read_job(path))
    moved = displacement_of(preparation, preparation.path.nodes, Variant.ABBE, ())
    # theta x r: 40 urad about Y, r = (0, 0, -L): x = -40e-6 L; counted from the probe's
    assert 1e3 * moved.shift_mm[:, 0] == pytest.approx(-0.04 * (LENGTH - 60.0), abs=1e-9)


def test_direction_of_the_touch_matters_where_it_is_kept(tmp_path):
    """A reversal of 10 um in X: touched in +, all that is cut in - is 10 um off, not 5."""
    path = write_job(tmp_path, more="[probing]\napproach = [1, 1, -1]\n")
    (tmp_path / "errors").mkdir()
    (tmp_path / "errors" / "EXX.csv").write_text(
        "position_mm,forward,backward\n-400,4,14\n0,4,14\n"
    )
    machine = tmp_path / "machine.toml"
    machine.write_text(machine.read_text() + '[tables]\ndirections = "separate"\n'
                       '[errors.EXX]\ntable = "errors/EXX.csv"\n')  # fmt: skip
    preparation = prepare(read_job(path))
    nodes = preparation.path.nodes
    moved = 1e3 * displacement_of(preparation, nodes, Variant.ABBE, ()).shift_mm[:, 0]
    way = nodes.direction[:, 0]
    assert moved[way > 0] == pytest.approx(0.0, abs=1e-9)
    assert moved[way < 0] == pytest.approx(10.0, abs=1e-9)


def test_effects_of_the_job_count_from_the_zero_too(tmp_path):
    """A squareness as an effect: dx = -EC0Y y of machine coordinates, touched at y = 0."""
    effect = "[effects.squareness.C0Y]\nsquareness_urad = 100.0\n"
    more = effect + "[probing]\n"
    preparation = prepare(read_job(write_job(tmp_path, more=more)))
    job = preparation.job
    effects = read_effects(job.effects, file=job.path, job=job)
    nodes = preparation.path.nodes
    moved = displacement_of(preparation, nodes, Variant.ABBE, effects)
    y = nodes.nose_mm[:, 1] - G54[1]
    assert np.abs(1e3 * moved.shift_mm[:, 0]) == pytest.approx(np.abs(0.1 * y), abs=1e-9)


def test_shares_add_up_and_the_program_has_its_own(tmp_path):
    errors = {"EXX": (lambda q: 0.02 * q, None), "EYY": (lambda q: 30.0, None)}
    path = write_job(tmp_path, errors, squareness="[squareness]\nEC0Y = 50\n", more="[probing]\n")
    job = read_job(path)
    _, points, normals = pocket_points()
    found = predict(prepare(job), points, normals, variant=Variant.ABBE)
    budget = error_budget(found)
    assert budget.share_mm.sum(axis=1) == pytest.approx(found.deviation_mm, abs=1e-12)
    assert np.abs(budget.share_mm[:, budget.sources.index("EYY")]).max() < 1e-12
    own = perfect(tmp_path)
    assert 1e3 * budget.share_mm[:, 0] == pytest.approx(own, abs=5e-3)


def test_what_is_not_known_at_the_zero_does_not_count_either(tmp_path):
    """The scale of all positioning tables: u = share x distance from the zero, not from home."""
    errors = {f"E{a}{a}": (lambda q: 0.0, None) for a in "XYZ"}
    u = "[uncertainty]\nreading_um = 1e-6\nsquareness_urad = 0.0\npositioning_um_per_m = 1000\n"
    _, points, normals = pocket_points()
    side = np.abs(normals[:, 0]) == 1.0
    job = read_job(write_job(tmp_path, errors, squareness=u, more="[probing]\n"))
    found = predict(prepare(job), points, normals, variant=Variant.ABBE)
    tip = points[:, 0] + 5.0 * normals[:, 0]
    assert 1e3 * prediction_u_mm(found)[side] == pytest.approx(np.abs(tip)[side], abs=2e-3)


def test_an_instrument_on_the_machine_does_not_see_the_zero(tmp_path):
    drift = "t_s,spindle_rpm,dx_um,dy_um,dz_um\n0,0,0,0,0\n60,0,1,0,0\n120,0,2,0,0\n"
    errors = {"EXX": (lambda q: 0.02 * q, None)}
    more = measurement("drift", at_mm=[-100, -100, -100])
    found = []
    for probing in ("", "[probing]\n"):
        path = write_job(tmp_path, errors, more=probing + more)
        (tmp_path / "drift.csv").write_text(drift)
        found.append(read_instruments(read_job(path))[0].predicted_mm)
    assert np.array_equal(*found)
    assert 1e3 * found[0][0] == pytest.approx(0.02 * -100.0)


def test_a_fit_sees_an_effect_as_the_prediction_does(tmp_path):
    """Columns of a fit are the change of the prediction with the effect's size."""
    from vmach.effects.catalogue import catalogue

    path = write_job(tmp_path, more="[probing]\nx_at_mm = [-30, 20, 0]\n")
    job = read_job(path)
    preparation = prepare(job)
    part, _ = measure_part(preparation, job.measured)
    survey = Survey(job, (part,), ())
    effect = catalogue()["scale"]
    column = survey.signature(effect, "X", {})[:, 0]
    usual = effect.amplitudes[0]
    more = f"[effects.scale.X]\n{usual.name} = {usual.usual}\n"
    with_it, points = deviations(
        write_job(tmp_path, more=more + "[probing]\nx_at_mm = [-30, 20, 0]\n")
    )
    side = np.abs(points.normal[:, 0]) > 0.99
    assert 1e3 * column[side] == pytest.approx((with_it - perfect(tmp_path))[side], abs=5e-3)


def test_a_compensated_program_makes_what_was_programmed(tmp_path):
    """The program is moved against the error as the part feels it, and nothing is left."""
    import vmach

    own = perfect(tmp_path)
    errors = {"EXX": (lambda q: 0.3 * q, None), "EZZ": (lambda q: 25.0, None)}
    path = write_job(tmp_path, errors, more="[probing]\nx_at_mm = [-30, 0, 0]\n")
    path.write_text(path.read_text().replace('measured = "points.csv"\n', ""))
    before, _ = deviations(path)
    moved = tmp_path / "moved.nc"
    moved.write_bytes(vmach.compensate(path).text)
    assert b"G0 X-0.009 Y0" in moved.read_bytes()  # 30 mm from the touch: 0.3 um/mm x 30 mm
    path.write_text(path.read_text().replace("part.nc", "moved.nc"))
    names, points, normals = pocket_points()
    found = predict(prepare(read_job(path)), points, normals, variant=Variant.ABBE,
                    known_surface=np.ones(len(names), dtype=bool), is_compensated=True)  # fmt: skip
    assert np.abs(before - own).max() > 15.0
    assert np.abs(1e3 * found.deviation_mm - own).max() < 1.0  # the control's digits: 0.5 um


def test_a_touch_outside_the_travel_is_refused(tmp_path):
    path = write_job(tmp_path, more="[probing]\nzero_at_mm = [500, 0, 0]\n")
    with pytest.raises(InputError, match=r"\[probing\]: to touch, X goes to 300.000 mm"):
        deviations(path)


def test_points_that_nothing_cuts_leave_nothing_to_touch_for(tmp_path):
    job = read_job(write_job(tmp_path, {"EXX": (lambda q: 0.1 * q, None)}, more="[probing]\n"))
    far, normal = np.array([[300.0, 0.0, 0.0]]), np.array([[1.0, 0.0, 0.0]])
    found = predict(prepare(job), far, normal, variant=Variant.ABBE)
    assert not found.is_cut.any()
