"""What effects depend on, against closed forms and independent simulation."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lsim

from gcode import read_program
from tests.small_job import write_job
from vmach.effects import Circumstances, catalogue
from vmach.job import read_job
from vmach.path.instrument_motion import MotionRecord, stop_and_go
from vmach.path.preparation import prepare
from vmach.path.toolpath import PathStates


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    return read_job(write_job(tmp_path_factory.mktemp("job")))


def circle(radius_mm=20.0, seconds=6.0, turns=1.0):
    """A circle in XY from its rightmost point, readings all along it."""
    centre = np.array([-200.0, -150.0, -100.0])
    record = MotionRecord(centre + np.array([radius_mm, 0, 0]), tool_length_mm=100.0)
    record.stand(until_s=1.0)
    end = centre + radius_mm * np.array([np.cos(2 * np.pi * turns), np.sin(2 * np.pi * turns), 0])
    arc = record.arc(
        end,
        centre_mm=centre,
        axis=np.array([0.0, 0.0, 1.0]),
        sweep_rad=2 * np.pi * turns,
        until_s=1.0 + seconds,
    )
    parameter = np.linspace(0.001, 0.999, 721)
    return record.states(np.full(721, arc), parameter), 2 * np.pi * turns * parameter


def test_direction_on_a_circle_flips_at_the_quadrants(job):
    states, angle = circle()
    path = Circumstances(states, job)
    away = np.abs(np.sin(2 * angle)) > 0.05
    np.testing.assert_array_equal(path.play_side[away, 0], -np.sign(np.sin(angle[away])))
    np.testing.assert_array_equal(path.play_side[away, 1], np.sign(np.cos(angle[away])))


def test_travel_since_reversal_on_a_circle(job):
    states, angle = circle(radius_mm=20.0)
    path = Circumstances(states, job)
    second = (angle > np.pi + 0.1) & (angle < 2 * np.pi - 0.1)
    way = 20.0 * (1 + np.cos(angle[second]))
    np.testing.assert_allclose(path.travel_since_reversal_mm[second, 0], way, atol=5e-3)


def test_motion_smaller_than_the_dead_band_does_not_reverse(job):
    nose = np.array([[0, 0, 0], [10, 0, 0], [9.9995, 0, 0], [9.99, 0, 0]], float) - 150.0
    states = stop_and_go(nose, 10.0 * np.arange(4), side=np.zeros((4, 3)), tool_length_mm=100.0)
    side = Circumstances(states, job).play_side[:, 0]
    assert side[1] == 1.0
    assert side[2] > 0.0
    assert side[3] == -1.0


def test_play_operator_against_brute_force(job):
    """Random way of one axis: the carriage is dragged along by the edges of the band."""
    random = np.random.default_rng(11)
    x = -150.0 + np.cumsum(random.uniform(-3e-3, 3e-3, 200))
    nose = np.column_stack([x, np.full(200, -150.0), np.full(200, -100.0)])
    states = stop_and_go(nose, np.arange(200.0), side=np.zeros((200, 3)), tool_length_mm=100.0)
    side = Circumstances(states, job).play_side[:, 0]
    carriage, expected = x[0], []
    for drive in x:
        carriage = min(max(carriage, drive - 1e-3), drive + 1e-3)
        expected.append((drive - carriage) / 1e-3)
    np.testing.assert_allclose(side, expected, atol=1e-9)


def test_backlash_is_half_the_reversal_value_to_each_side(job):
    states, angle = circle()
    path = Circumstances(states, job)
    moved = catalogue()["backlash"].displacement(path, "X", reversal_um=6.0, take_up_mm=0.005)
    later = np.abs(np.sin(angle)) > 0.15
    np.testing.assert_allclose(moved[later, 0], 3e-3 * np.sign(np.sin(angle[later])))


def test_spindle_growth_against_a_simulated_first_order_lag(job):
    """Three speeds, with scipy's linear simulation as the independent witness."""
    time = np.arange(0.0, 6000.0, 20.0)
    rpm = np.where(time < 2000, 8000.0, np.where(time < 4000, 0.0, 4000.0))
    nose = np.full((len(time), 3), -100.0)
    states = stop_and_go(nose, time, side=np.zeros((len(time), 3)), tool_length_mm=100.0, rpm=rpm)
    path = Circumstances(states, job)
    moved = catalogue()["spindle_growth"].displacement(
        path, "Z", growth_um=20.0, time_constant_s=900.0, speed_exponent=0.7
    )
    drive = (rpm / 8000.0) ** 0.7
    _, output, _ = lsim(([1.0], [900.0, 1.0]), drive, time, interp=False)
    np.testing.assert_allclose(moved[:, 2], -20e-3 * output, atol=1e-6)


def test_servo_lag_is_the_second_order_of_a_simulated_lag(job):
    """A first-order lag on a circle shrinks it by a tau^2 / 2, to leading order."""
    tau, radius, seconds = 2e-3, 20.0, 2.0
    states, angle = circle(radius, seconds)
    path = Circumstances(states, job)
    moved = catalogue()["servo_lag"].displacement(
        path, "", lag_ms2=(1e3 * tau) ** 2, polyline_share=1.0
    )
    out = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    shrink = np.einsum("ij,ij->i", moved, out)
    rate = 2 * np.pi / seconds
    expected = radius * (1.0 / np.hypot(1.0, rate * tau) - 1.0)
    np.testing.assert_allclose(shrink, expected, rtol=1e-3)


def test_inertia_is_a_simulated_mass_on_a_spring(job):
    """A mass dragged round a circle by a spring runs wide by m a / k, to leading order."""
    hertz, radius, seconds = 40.0, 20.0, 2.0
    states, angle = circle(radius, seconds)
    softness_s2 = 1.0 / (2 * np.pi * hertz) ** 2
    moved = catalogue()["inertia"].displacement(
        Circumstances(states, job), "Y", sway_ms2=1e6 * softness_s2, polyline_share=1.0
    )
    drive = 2 * np.pi / seconds
    time = np.linspace(0.0, 40 * seconds, 160001)
    damped = ([1.0], [softness_s2, 2 * 0.05 * np.sqrt(softness_s2), 1.0])
    _, answer, _ = lsim(damped, radius * np.sin(drive * time), time)
    size = np.ptp(answer[-4001:]) / 2.0 - radius
    np.testing.assert_allclose(moved[:, 1], size * np.sin(angle), rtol=0.02, atol=1e-3 * size)
    assert not moved[:, [0, 2]].any()


def test_corner_rounding_is_a_simulated_lag_behind_a_ramp_of_the_velocity(job):
    """Round a right angle at 50 mm/s; the velocity turns evenly within 3 ms, tau is 20 ms."""
    tau, rise, speed = 20e-3, 3e-3, 50.0
    record = MotionRecord(np.array([-200.0, -150.0, -100.0]), tool_length_mm=100.0)
    record.line(np.array([-100.0, -150.0, -100.0]), until_s=2.0)
    second = record.line(np.array([-100.0, -50.0, -100.0]), until_s=4.0)
    since = np.linspace(0.0, 0.1, 201)
    path = Circumstances(record.states(np.full(201, second), since / 2.0), job)
    moved = catalogue()["corner_rounding"].displacement(
        path, "", lag_ms=1e3 * tau, time_constant_ms=1e3 * tau, rise_ms=1e3 * rise
    )
    time = np.arange(-0.5, 0.1, 2e-5)
    for axis, (before, after) in enumerate([(speed, 0.0), (0.0, speed)]):
        velocity = before + (after - before) * np.clip(time / rise, 0.0, 1.0)
        command = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * 2e-5)])
        # a position loop of first order, already following when it starts
        _, follows, _ = lsim(([1.0], [tau, 1.0]), command, time - time[0])
        late = follows - command + tau * velocity
        late -= tau * velocity[0] * np.exp(-(time - time[0]) / tau)
        expected = np.interp(since, time, late)
        np.testing.assert_allclose(moved[:, axis], expected, atol=0.002 * tau * speed)
    assert moved[0, 0] == moved[0, 1] == 0.0


def test_curvature_of_a_polyline_is_that_of_its_curve(tmp_path):
    angle = np.linspace(0, np.pi / 2, 91)
    lines = [f"G1 X{30 * np.cos(a):.5f} Y{30 * np.sin(a):.5f} F600" for a in angle]
    program = tmp_path / "p.nc"
    program.write_text("G21 G90 G94 G17\n" + "\n".join(lines) + "\nM30\n")
    moves = read_program(program).moves
    inside = np.arange(3, len(moves) - 2)
    states = PathStates(
        moves, np.array([0.0, 0.0]), inside, np.full(len(inside), 0.5), np.zeros((len(inside), 3))
    )
    path = Circumstances(states, read_job(write_job(tmp_path)))
    speed = np.linalg.norm(path.velocity_mm_per_s, axis=1)
    centripetal = np.linalg.norm(path.acceleration_mm_per_s2, axis=1)
    np.testing.assert_allclose(centripetal, speed**2 / 30.0, rtol=1e-3)


POCKET = """\
G21 G90 G94 G17
T1 M6
S6000 M3
G54 G43 H1
G0 X0 Y0 Z5
G1 Z-6 F300
G1 X9.5 F600
G3 X9.5 Y0 I-9.5 J0
G1 X0
G1 X10 F600
G3 X10 Y0 I-10 J0
G1 X0
G0 Z5
M30
"""


def test_radial_depth_is_the_allowance_of_the_roughing_pass(tmp_path):
    """A bore roughed to 0.5 mm and finished: 0.5 mm on every side."""
    job_path = write_job(tmp_path)
    (tmp_path / "part.nc").write_text(POCKET)
    job = read_job(job_path)
    moves = prepare(job).program.moves
    finish = int(np.flatnonzero(moves.sweep_rad)[-1])
    parameter = np.linspace(0.1, 0.9, 33)
    angle = 2 * np.pi * parameter
    normal = -np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    states = PathStates(
        moves,
        np.array([np.nan, 100.0]),
        np.full(33, finish),
        parameter,
        np.column_stack([-5 * normal[:, :2], np.full(33, 3.0)]),
        normal,
    )
    path = Circumstances(states, job)
    np.testing.assert_allclose(path.radial_depth_mm, 0.5, atol=2e-3)
    moved = catalogue()["tool_deflection"].displacement(
        path,
        "",
        tool_um=4.0,
        machine_um=0.0,
        taper_um=0.0,
        climb_um=0.0,
        slot_um=0.0,
        feed_exponent=1.0,
        width_exponent=2.0,
        allowance_mm=0.3,
    )
    # (depth of cut / 10) (width / 1)^2 (feed per tooth / 0.1) (L / 100)^3 (20 / d)^4
    depth = path.axial_depth_mm
    force = depth / 10 * 0.5**2 * (600 / (6000 * 2) / 0.1)
    left = np.einsum("ij,ij->i", moved, normal)
    np.testing.assert_allclose(left, 4e-3 * force * (20 / 10) ** 4, rtol=5e-3)


@pytest.mark.parametrize(("way", "climbs"), [("G3", 1.0), ("G2", -1.0)])
def test_a_slender_tool_bends_most_at_its_tip_and_more_when_it_mills_down(tmp_path, way, climbs):
    """A bore finished left about is milled down, right about up, by a tool that turns clockwise."""
    job_path = write_job(tmp_path)
    job_path.write_text(job_path.read_text().replace("length_mm = 100", "length_mm = 80"))
    (tmp_path / "part.nc").write_text(POCKET.replace("G3", way))
    job = read_job(job_path)
    moves = prepare(job).program.moves
    finish = int(np.flatnonzero(moves.sweep_rad)[-1])
    parameter, height = np.array([0.1, 0.4, 0.6, 0.9]), np.array([0.0, 1.5, 3.0, 6.0])
    angle = climbs * 2 * np.pi * parameter
    normal = -np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    states = PathStates(
        moves,
        np.array([np.nan, 80.0]),
        np.full(4, finish),
        parameter,
        np.column_stack([-5 * normal[:, :2], height]),
        normal,
    )
    numbers = {"feed_exponent": 0.8, "width_exponent": 0.9, "allowance_mm": 0.3, "slot_um": 99.0}
    bent = {"tool_um": 4.0, "machine_um": 1.5, "taper_um": 3.0, "climb_um": 0.7}
    moved = catalogue()["tool_deflection"].displacement(
        Circumstances(states, job), "", **bent, **numbers
    )
    # 6 mm deep, 0.5 mm wide, 0.05 mm per tooth; 80 mm long and 10 mm thick
    force = 0.6 * 0.5**0.9 * 0.5**0.8
    slender = 0.8**3 * 2.0**4
    tool_um = 4.0 + 3.0 * (0.5 - height / 6.0) + 0.7 * climbs
    left = np.einsum("ij,ij->i", moved, normal)
    np.testing.assert_allclose(left, 1e-3 * (1.5 + tool_um * slender) * force, rtol=5e-3)


def test_a_slot_from_the_full_is_pushed_aside_as_a_whole(tmp_path):
    """To the left of the way, where material is milled up, by as much on both walls."""
    job_path = write_job(tmp_path)
    start = "G21 G90 G94 G17\nT1 M6\nS6000 M3\nG54 G43 H1\n"
    (tmp_path / "part.nc").write_text(start + "G0 X0 Y0 Z5\nG1 Z-6 F300\nG1 X40 F1200\nM30\n")
    job = read_job(job_path)
    moves = prepare(job).program.moves
    along = int(np.flatnonzero(moves.at_feed)[-1])
    walls = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])  # on the right and on the left
    contact = np.array([[0.0, -5.0, 3.0], [0.0, 5.0, 3.0]])
    states = PathStates(
        moves, np.array([np.nan, 100.0]), np.full(2, along), np.full(2, 0.5), contact, walls
    )
    moved = catalogue()["tool_deflection"].displacement(
        Circumstances(states, job), "", tool_um=0.0, machine_um=0.0, taper_um=0.0, climb_um=0.0,
        slot_um=2.0, feed_exponent=1.0, width_exponent=0.9, allowance_mm=0.3,
    )  # fmt: skip
    # 6 mm deep, 0.1 mm per tooth, 100 mm long and 10 mm thick
    np.testing.assert_allclose(moved[:, 1], 2e-3 * 0.6 * 2.0**4)
    assert not moved[:, [0, 2]].any()


@pytest.mark.parametrize("depth_mm", [6.0, 18.0])
def test_a_slot_is_cut_from_the_full_beside_the_hole_of_its_plunge(tmp_path, depth_mm):
    """A plunge is a long way down, and none across: the wall beside it is of the same cut."""
    job_path = write_job(tmp_path)
    start = PAST_A_WALL.split("{before}")[0]
    plunge = f"G0 X0 Y0 Z5\nG1 Z-{depth_mm} F300\nG1 X40 F1200\nM30\n"
    (tmp_path / "part.nc").write_text(start + plunge)
    job = read_job(job_path)
    moves = prepare(job).program.moves
    along = int(np.flatnonzero(moves.at_feed)[-1])
    states = PathStates(
        moves,
        np.array([np.nan, 100.0]),
        np.full(5, along),
        np.linspace(0.05, 0.95, 5),
        np.tile([0.0, 5.0, 3.0], (5, 1)),
        np.tile([0.0, -1.0, 0.0], (5, 1)),
    )
    assert Circumstances(states, job).radial_depth_mm == pytest.approx(np.full(5, 10.0))


PAST_A_WALL = """\
G21 G90 G94 G17
T1 M6
S6000 M3
G54 G43 H1
{before}G0 X0 Y0 Z5
G1 Z-6 F300
G1 X40 F600
G1 Y7
G1 X0
G0 Z5
M30
"""


@pytest.mark.parametrize(
    ("before", "depth"),
    [("", 10.0), ("G0 X0 Y7.5 Z5\nG1 Z-6 F300\nG1 X40 F600\nG0 Z5\n", 0.5)],
    ids=["slotted", "roughed"],
)
def test_a_cut_that_would_have_taken_the_wall_away_is_not_counted(tmp_path, before, depth):
    """The way there crosses the wall at Y 2, 3 mm deep, yet the wall was measured."""
    job_path = write_job(tmp_path)
    (tmp_path / "part.nc").write_text(PAST_A_WALL.format(before=before))
    job = read_job(job_path)
    moves = prepare(job).program.moves
    along_wall = int(np.flatnonzero(moves.at_feed)[-1])
    parameter = np.linspace(0.2, 0.8, 5)
    states = PathStates(
        moves,
        np.array([np.nan, 100.0]),
        np.full(5, along_wall),
        parameter,
        np.tile([0.0, -5.0, 3.0], (5, 1)),
        np.tile([0.0, 1.0, 0.0], (5, 1)),
    )
    assert Circumstances(states, job).radial_depth_mm == pytest.approx(np.full(5, depth))


def test_every_slot_may_have_been_roughed_otherwise(tmp_path):
    """Each slot by itself is open by the push of 0.3 mm more, and the law by 15 % everywhere."""
    slots = "".join(f"G0 X0 Y{y} Z5\nG1 Z-6 F300\nG1 X40 F600\nG0 Z5\n" for y in (-12, 12))
    job_path = write_job(tmp_path)
    start = "G21 G90 G94 G17\nT1 M6\nS6000 M3\nG54 G43 H1\n"
    (tmp_path / "part.nc").write_text(f"{start}{slots}M30\n")
    job = read_job(job_path)
    moves = prepare(job).program.moves
    along = np.flatnonzero(moves.at_feed & (moves.end_mm[:, 0] > moves.start_mm[:, 0] + 1))
    states = PathStates(
        moves,
        np.array([np.nan, 100.0]),
        np.repeat(along, 2),
        np.array([0.4, 0.6, 0.4, 0.6]),
        np.tile([0.0, 5.0, 3.0], (4, 1)),
        np.tile([0.0, -1.0, 0.0], (4, 1)),
    )
    path = Circumstances(states, job)
    law = catalogue()["tool_deflection"]
    numbers = {p.name: p.usual for p in law.parameters}
    numbers |= {"allowance_mm": 0.3, "slot_um": 0.0}
    push = law.displacement(path, "", **numbers)[:, 1]
    slack = law.slack(path, "", numbers)[:, 1]
    share = (slack @ slack.T) / np.outer(push, push)
    assert np.diag(share) == pytest.approx(np.full(4, 1.0 + 0.15**2), rel=1e-3)  # between knots
    assert share[0, 1] > 1.0
    assert abs(share[0, 2]) < 0.15**2


def test_marks_of_a_single_flute_are_the_mean_of_its_arcs():
    """A wall milled by one flute: the mean height of circular arcs one turn's feed apart."""
    radius, turn = 5.0, 2.0
    x = np.linspace(-turn / 2, turn / 2, 20001)
    mean_mm = np.mean(radius - np.sqrt(radius**2 - x**2))
    wall = np.tile([0.0, 1.0, 0.0], (5, 1))
    path = SimpleNamespace(
        feed_per_tooth_mm=np.full(5, turn / 4),
        normal=wall,
        side_normal=wall,
        tool=np.array([1, 1, 1, 2, 2]),
        of_tool=lambda name: np.full(5, {"flutes": 4.0, "diameter_mm": 2 * radius}[name]),
    )
    effect = catalogue()["runout"]
    left = effect.displacement(path, "T1", runout_um=8.0, marks_share=1.0)
    expected = np.where(path.tool == 1, mean_mm - 8e-3, 0.0)
    np.testing.assert_allclose(left[:, 1], expected, rtol=0.02)
    np.testing.assert_array_equal(left[:, [0, 2]], 0.0)


def test_the_stretch_of_a_screw_goes_with_the_speed_of_its_axis(job):
    """Stated at 100 mm/min: the same expansion is foretold for programs of any speed."""
    for speed_mm_min in (100.0, 250.0):
        way = speed_mm_min / 60.0 * 15.0
        time = 15.0 * np.arange(401)
        nose = np.full((len(time), 3), -100.0)
        nose[1::2, 0] -= way
        states = stop_and_go(nose, time, side=np.zeros((len(time), 3)), tool_length_mm=100.0)
        stretch = catalogue()["axis_expansion"].displacement(
            Circumstances(states, job), "X",
            expansion_ppm=50.0, at_home_um=0.0, time_constant_s=1000.0, work_share=1.0,
        )[:, 0]  # fmt: skip
        warmth = speed_mm_min / 100.0 * (1.0 - np.exp(-time / 1000.0))
        expected = 50e-6 * warmth * nose[:, 0]
        np.testing.assert_allclose(stretch, expected, rtol=0, atol=0.02 * np.abs(expected).max())


def test_locally_heated_screw_against_finite_differences(job):
    """The heat equation with loss to the air, stepped in 0.25 s on 5 mm cells."""
    time = np.arange(0.0, 1500.0, 2.0)
    x = np.interp(np.mod(time, 40.0), [0.0, 20.0, 40.0], [-300.0, -180.0, -300.0])
    x[time > 900] = np.interp(np.mod(time[time > 900], 10.0), [0.0, 5.0, 10.0], [-90, -60, -90])
    nose = np.column_stack([x, np.full(len(x), -150.0), np.full(len(x), -100.0)])
    states = stop_and_go(nose, time, side=np.zeros((len(x), 3)), tool_length_mm=100.0)
    low, high = (float(end[0]) for end in job.machine.travel_mm)
    stretch = catalogue()["axis_expansion"].displacement(
        Circumstances(states, job), "X",
        expansion_ppm=0.0, at_home_um=0.0, local_ppm=50.0, time_constant_s=600.0, work_share=1.0,
    )[:, 0]  # fmt: skip
    cells = int((high - low) / 5.0)
    width, step = (high - low) / cells, 0.25
    middle = low + width * (np.arange(cells) + 0.5)
    edges = np.append(middle - 0.5 * width, high)
    warmth, expected = np.zeros(cells), np.zeros(len(time))
    for k in range(1, len(time)):
        ends = np.sort(x[k - 1 : k + 1])
        passed = np.diff(np.clip(edges, *ends)) / width
        heat = passed / 2.0 * (high - low) / (100.0 / 60.0) / 600.0  # stated at 100 mm/min
        for _ in range(8):
            padded = np.pad(warmth, 1, mode="edge")
            spread = 13.0 * (padded[2:] - 2 * warmth + padded[:-2]) / width**2
            warmth = warmth + step * (spread + heat - warmth / 600.0)
        summed = np.append(0.0, np.cumsum(warmth) * width)
        expected[k] = 50e-6 * (np.interp(x[k], edges, summed) - np.interp(0.0, edges, summed))
    assert np.ptp(expected) > 5e-3
    np.testing.assert_allclose(stretch, expected, rtol=0, atol=0.01 * np.abs(expected).max())
