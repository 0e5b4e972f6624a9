"""What each effect of the catalogue does to the tool: its law, size and sign, by closed forms."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.machine_cases import constant, make_machine
from tests.small_job import write_job
from vmach.effects import Circumstances, catalogue
from vmach.job import read_job
from vmach.machine import Chain, ComponentError, Variant, displacement
from vmach.machine.rotary import RotaryAxis
from vmach.path.instrument_motion import MotionRecord, stop_and_go
from vmach.run.pipeline import predict_points

#: travel of the small job: X -400..0, Y -300..0, Z -300..0; length of its tool, mm
LOW_MM, LENGTH_MM = np.array([-400.0, -300.0, -300.0]), 100.0
CHAIN = "t (C) Z Y b X' w"
TOOL_MM = np.array([0.0, 0.0, -LENGTH_MM])


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    return read_job(write_job(tmp_path_factory.mktemp("job")))


def standing(job, nose_mm, time_s=None, rpm=None):
    """The tip at places (P, 3), one after the other."""
    nose = np.asarray(nose_mm, dtype=float)
    time = 10.0 * np.arange(len(nose)) if time_s is None else np.asarray(time_s, dtype=float)
    side = np.zeros((len(nose), 3))
    states = stop_and_go(nose, time, side=side, tool_length_mm=LENGTH_MM, rpm=rpm)
    return Circumstances(states, job)


def law(name, path, target, **parameters):
    return catalogue()[name].displacement(path, target, **parameters)


def places(count=6):
    return np.random.default_rng(4).uniform(LOW_MM, 0.0, (count, 3))


@pytest.mark.parametrize("axis", range(3))
def test_a_long_scale_goes_too_far_from_home(job, axis):
    nose = places()
    moved = law("scale", standing(job, nose), "XYZ"[axis], scale_ppm=20.0)
    expected = np.zeros_like(nose)
    expected[:, axis] = 20e-6 * nose[:, axis]  # 20 um in a metre
    np.testing.assert_allclose(moved, expected, atol=1e-12)


@pytest.mark.parametrize("target", ["C0Y", "B0X", "A0Y", "B0Z", "A0Z"])
def test_the_line_of_an_axis_out_of_square_is_turned(job, target):
    """The carriage runs along its line, which a small rotation about A, B or C has turned."""
    nose, angle = places(), 30e-6
    own, about = np.eye(3)["XYZ".index(target[2])], np.eye(3)["ABC".index(target[0])]
    moved = law("squareness", standing(job, nose), target, squareness_urad=1e6 * angle)
    way = (nose @ own)[:, None] * own
    expected = Rotation.from_rotvec(angle * about).apply(way) - way
    np.testing.assert_allclose(moved, expected, atol=1e-6)  # but for angle^2 / 2 of 400 mm
    assert np.abs(moved).max() > 1e-3


@pytest.mark.parametrize(("axis", "target"), [(0, "X"), (1, "Y")])
def test_sag_over_the_travel_of_an_axis(job, axis, target):
    """A ram drops at both ends; a table drops at one, so that the tool stands higher there."""
    nose = np.full((5, 3), -150.0)
    nose[:, axis] = LOW_MM[axis] * (1.0 - np.linspace(0.0, 1.0, 5))  # from the lower to the upper
    path = standing(job, nose)
    ram = law("gravity_sag", path, target, sag_um=8.0)
    table = law("table_load_sag", path, target, sag_um=8.0)
    assert 1e3 * ram[:, 2] == pytest.approx([-8.0, -2.0, 0.0, -2.0, -8.0])
    assert 1e3 * table[:, 2] == pytest.approx([-8.0, -1.0, 0.0, 1.0, 8.0])
    assert not ram[:, :2].any() and not table[:, :2].any()


@pytest.mark.parametrize("target", ["A", "B"])
def test_a_warm_head_turns_the_tool_about_the_nose(job, target):
    """At 8000 rpm for one time constant: 63 % of the tilt, right-handed, of a tool 100 mm long."""
    about = np.eye(3)["AB".index(target)]
    rpm, time = np.full(3, 8000.0), np.array([0.0, 500.0, 1e5])
    path = standing(job, np.full((3, 3), -100.0), time, rpm)
    more = {"time_constant_s": 500.0, "speed_exponent": 0.7}
    warmth = np.array([0.0, 1.0 - np.exp(-1.0), 1.0])
    tilted = law("head_tilt", path, target, tilt_urad=40.0, shift_um=0.0, **more)
    turn = Rotation.from_rotvec(40e-6 * warmth[:, None] * about)
    np.testing.assert_allclose(tilted.shift_mm, turn.apply(TOOL_MM) - TOOL_MM, atol=1e-6)
    np.testing.assert_allclose(tilted.tilt_rad, turn.as_rotvec(), atol=1e-12)
    # the nose moves to where the tip of a tool goes that a positive tilt turns
    shifted = law("head_tilt", path, target, tilt_urad=0.0, shift_um=4.0, **more)
    np.testing.assert_allclose(shifted.shift_mm, tilted.shift_mm, atol=1e-6)
    assert not shifted.tilt_rad.any()


@pytest.mark.parametrize("target", [f"E{kind}{axis}" for kind in "XYZ" for axis in "XYZ"])
def test_a_reflector_elsewhere_is_the_table_read_elsewhere(job, target):
    """The difference of two machines whose files say different places of the reflector."""
    written, first_mm, second_mm = np.array([-50.0, -80.0, -120.0]), 30.0, -45.0
    direction, axis = "XYZ".index(target[1]), target[2]
    true = written.copy()
    true[(direction + 1) % 3] += first_mm
    true[(direction + 2) % 3] += second_mm
    angles = {f"E{a}{axis}": constant(f"E{a}{axis}", k * 1e-5) for k, a in enumerate("ABC", 1)}

    def machine(at):
        linear = constant(target, 5e-3, tuple(at))
        made = make_machine(CHAIN, {**angles, target: linear})
        return replace(made, axes=job.machine.axes)

    nose = places()
    path = standing(replace(job, machine=machine(written)), nose)
    moved = law("reflector", path, target, first_mm=first_mm, second_mm=second_mm)
    there, here = (
        displacement(machine(at), nose, TOOL_MM, Variant.ABBE).shift_mm for at in (true, written)
    )
    np.testing.assert_allclose(moved, there - here, atol=1e-12)
    assert np.abs(moved).max() > 1e-4


@pytest.mark.parametrize("target", ["EXX", "EZY", "EYZ", "EBX", "EAZ", "ECY"])
def test_a_correction_of_a_table_is_what_the_table_would_say(job, target):
    knots, values = [-300.0, -200.0, -100.0, 0.0], [4.0, -6.0, 2.0, 9.0]
    angular = target[1] in "ABC"
    size = 1e-3 * np.array(values) * (1e-3 if angular else 1.0)
    at = np.array([-20.0, -30.0, -40.0])
    table = ComponentError(target, np.array(knots), size, size, None if angular else at)
    machine = replace(make_machine(CHAIN, {target: table}), axes=job.machine.axes)
    nose = np.random.default_rng(4).uniform(-300.0, 0.0, (20, 3))
    flat = replace(
        machine, components={target: replace(table, forward=0 * size, backward=0 * size)}
    )
    path = standing(replace(job, machine=flat), nose)
    key = "correction_urad" if angular else "correction_um"
    moved = law("component", path, target, position_mm=knots, **{key: values})
    whole = displacement(machine, nose, TOOL_MM, Variant.ABBE)
    np.testing.assert_allclose(moved.shift_mm, whole.shift_mm, atol=1e-12)
    np.testing.assert_allclose(moved.tilt_rad, whole.tilt_rad, atol=1e-15)
    assert np.abs(whole.tilt_rad if angular else whole.shift_mm).max() > 1e-6


@pytest.mark.parametrize("letter", "ABC")
@pytest.mark.parametrize("side", ["table", "head"])
def test_a_rotary_axis_out_of_place_is_that_of_the_machine_file(letter, side):
    """EX0C = 12 um and the like: first harmonics of the angle, as an R-test shows them.

    The machine file counts in the axes of the workpiece, an effect in those of the machine.
    """
    axis = "ABC".index(letter)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    offset_mm = np.zeros(3)
    offset_mm[[first, second]] = 0.012, -0.007
    chain = {"table": f"t (C1) Z Y b X' {letter}' w", "head": f"t (C1) {letter} Z Y X b w"}[side]
    rotary = {letter: RotaryAxis(-7.0, 7.0, np.zeros(3), location_mm=offset_mm)}
    machine = replace(make_machine("t X Y Z b w", {}), chain=Chain.parse(chain), rotary=rotary)
    degrees = np.array([0.0, 20.0, 90.0, -130.0])
    angle_rad = np.zeros((4, 3))
    angle_rad[:, axis] = np.radians(degrees)
    expected = displacement(machine, np.zeros((4, 3)), TOOL_MM, Variant.ABBE, rotary_rad=angle_rad)
    bare = replace(machine, rotary={letter: replace(rotary[letter], location_mm=np.zeros(3))})
    path = turning(bare, np.degrees(angle_rad))
    moved = sum(
        law("rotary_location", path, f"{'XYZ'[k]}0{letter}", offset_um=um).shift_mm
        for k, um in ((first, 12.0), (second, -7.0))
    )
    back = Rotation.from_rotvec(-angle_rad if side == "table" else 0 * angle_rad)
    np.testing.assert_allclose(moved, back.apply(expected.shift_mm), atol=1e-12)


def turning(machine, rotary_deg):
    """A machine that turns its rotary axes, step by step, and nothing else."""
    still = np.zeros_like(rotary_deg)
    states = stop_and_go(
        still, 10.0 * np.arange(len(still)), side=still, tool_length_mm=LENGTH_MM,
        rotary_deg=rotary_deg,
    )  # fmt: skip
    return Circumstances(states, SimpleNamespace(machine=machine))


def test_a_wave_with_the_pitch_of_the_screw(job):
    nose = np.full((5, 3), -100.0)
    nose[:, 1] = [0.0, -2.5, -5.0, -7.5, -10.0]  # quarters of a pitch from home
    path = standing(job, nose)
    for phase, expected in ((0.0, [0, -3, 0, 3, 0]), (np.pi / 2, [3, 0, -3, 0, 3])):
        moved = law("cyclic_pitch", path, "Y", amplitude_um=3.0, pitch_mm=10.0, phase_rad=phase)
        assert 1e3 * moved[:, 1] == pytest.approx(expected, abs=1e-9)
        assert not moved[:, [0, 2]].any()


def test_the_shop_drifts_in_waves_of_time_from_nothing(job):
    time = np.array([0.0, 600.0, 1200.0, 1800.0])  # quarters of the period
    path = standing(job, np.full((4, 3), -100.0), time)
    one = law("ambient_drift", path, "Y", period_s=2400.0, sine_um=5.0, cosine_um=2.0)
    assert 1e3 * one[:, 1] == pytest.approx([0.0, 3.0, -4.0, -7.0])
    assert not one[:, [0, 2]].any()
    sizes = {"sine_x_um": 1.0, "sine_y_um": 2.0, "sine_z_um": 3.0}
    none = {f"cosine_{axis}_um": 0.0 for axis in "xyz"}
    every = law("ambient_drift", path, "XYZ", period_s=2400.0, **sizes, **none)
    assert 1e3 * every[1] == pytest.approx([1.0, 2.0, 3.0])


RADIUS_MM = 20.0


def on_a_circle(job, seconds=6.0):
    """Counterclockwise in XY, twice round: the second time; and the angles."""
    centre = np.array([-200.0, -150.0, -100.0])
    start = centre + np.array([RADIUS_MM, 0.0, 0.0])
    record = MotionRecord(start, tool_length_mm=LENGTH_MM)
    rounds = [
        record.arc(
            start,
            centre_mm=centre,
            axis=np.array([0.0, 0.0, 1.0]),
            sweep_rad=2 * np.pi,
            until_s=(k + 1) * seconds,
        )
        for k in range(2)
    ]
    share = np.linspace(0.0007, 0.9993, 360)
    states = record.states(np.full(len(share), rounds[1]), share)
    return Circumstances(states, job), 2 * np.pi * share


def test_what_reverses_with_an_axis_on_a_circle(job):
    """X turns back at 0 and at 180 degrees; d is its way since then."""
    path, angle = on_a_circle(job)
    side = np.where(angle < np.pi, -1.0, 1.0)  # X goes down on the upper half
    way = RADIUS_MM * (1.0 - side * -np.cos(angle))
    clear = way > 0.05  # it has crossed the dead band
    build_up = 1.0 - 2.0 * np.exp(-way / 8.0)
    loop = law("hysteresis", path, "X", width_um=6.0, travel_mm=8.0)
    np.testing.assert_allclose(loop[clear, 0], (-3e-3 * side * build_up)[clear], atol=2e-6)
    spike = law("quadrant_glitch", path, "X", spike_um=5.0, travel_mm=0.6, sticks_mm=0.02)
    # it follows from nothing on: stuck at first, behind by what is commanded
    held_back = -5e-3 * side * (1.0 - np.exp(-way / 0.02)) * np.exp(-way / 0.6)
    np.testing.assert_allclose(spike[clear, 0], held_back[clear], atol=2e-5)
    play = law("lateral_play", path, "XZ", play_um=4.0, take_up_mm=0.005)
    np.testing.assert_allclose(play[clear, 2], (2e-3 * side)[clear], atol=1e-6)
    assert not loop[:, 1:].any() and not spike[:, 1:].any() and not play[:, :2].any()


def test_loops_that_do_not_match_make_an_ellipse(job):
    """X late by 0.4 ms less than the mean of both axes, Y by as much more."""
    seconds, later_s = 2.0, 0.8e-3
    path, angle = on_a_circle(job, seconds)
    half = 0.5 * later_s * 2 * np.pi / seconds
    moved = law("servo_mismatch", path, "XY", mismatch_ms=1e3 * later_s)
    expected = RADIUS_MM * np.column_stack(
        [np.cos(angle + half) - np.cos(angle), np.sin(angle - half) - np.sin(angle), 0 * angle]
    )
    np.testing.assert_allclose(moved, expected, atol=RADIUS_MM * half**2)
    assert np.abs(expected).max() > 10 * RADIUS_MM * half**2


def foretold(folder, effects):
    """Deviations along the normal, um (P,), places and normals (P, 3), of the small job."""
    folder.mkdir()
    written = write_job(folder, more=effects)
    points, prediction = predict_points(written, folder / "points.csv")
    assert prediction.is_cut.all()
    return 1e3 * prediction.deviation_mm, points.point_mm, points.normal


PLAIN = {
    # material left is positive: a thick tool takes more from walls, a long one from floors
    "tool_radius.T1": ("radius_um = 10", lambda p, n: -10.0 * np.hypot(n[:, 0], n[:, 1])),
    "tool_length.T1": ("length_um = 15", lambda p, n: -15.0 * n[:, 2]),
    "runout.T1": ("runout_um = 7\nmarks_share = 0", lambda p, n: -7.0 * np.hypot(n[:, 0], n[:, 1])),
    "probe_radius": ("radius_um = 5", lambda p, n: np.full(len(n), 5.0)),
    # a part cut 20 ppm too long shrinks towards its zero
    "workpiece_temperature": ("expansion_ppm = 20", lambda p, n: -0.020 * (p * n).sum(axis=1)),
    "datum_shift": (
        "shift_x_um = 3\nshift_y_um = -4\nshift_z_um = 6\ntime_s = 0",
        lambda p, n: n @ [3.0, -4.0, 6.0],
    ),
}


@pytest.mark.parametrize("name", PLAIN)
def test_on_walls_and_floors_of_a_pocket(tmp_path, name):
    parameters, expected = PLAIN[name]
    clean, place, normal = foretold(tmp_path / "clean", "")
    found, _, _ = foretold(tmp_path / "off", f"[effects.{name}]\n{parameters}\n")
    # the bore of 6 mm radius is shifted by 5 um: square of the shift by twice the radius, 2.1 nm
    np.testing.assert_allclose(found - clean, expected(place, normal), atol=2.2e-3)
