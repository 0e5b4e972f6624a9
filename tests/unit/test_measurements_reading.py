"""Reading measurements: what instruments sense, and bad input found, said and survived."""

from __future__ import annotations

import numpy as np
import pytest

from tests.small_job import measurement, pocket_points, write_job, write_points
from vmach.base.note import Kind
from vmach.effects import Circumstances, set_up_effect
from vmach.errors import InputError
from vmach.instruments import measure_part, read_instruments
from vmach.job import read_job
from vmach.path.preparation import prepare

LASER = measurement("laser", axis="X", at_mm=[-100, -100, -50])
DIAGONAL = measurement("diagonal", from_mm=[-350, -50, -250], to_mm=[-50, -250, -50])
BALLBAR = measurement("ballbar", plane="XY", centre_mm=[-200, -150, -100], radius_mm=100)
TIP = measurement("tip", frame="rigid", u_um=1)
DRIFT = measurement("drift", at_mm=[-200, -150, -100])


def laser_rows(readings):
    rows = ["run,position_mm,approach,t_s,deviation_um"]
    out = np.arange(-300.0, -50.0, 50.0)
    ways = [(x, 1) for x in out] + [(x, -1) for x in out[::-1]]
    for k, (x, way) in enumerate(ways):
        rows.append(f"1,{x},{way},{5.0 * k},{readings(x, way)}")
    return "\n".join(rows) + "\n"


def test_laser_sees_backlash_from_both_sides(tmp_path):
    job_path = write_job(tmp_path, more=LASER)
    (tmp_path / "laser.csv").write_text(laser_rows(lambda x, way: -3.0 * way))
    job = read_job(job_path)
    backlash = set_up_effect("backlash", "X", {"reversal_um": 6.0}, job=job)
    (laser,) = read_instruments(job, effects=[backlash])
    np.testing.assert_allclose(laser.measured_mm, laser.predicted_mm, atol=1e-12)
    assert laser.group[0] == "run 1" and laser.nuisance.shape == (10, 1)


def test_rows_without_times_follow_each_other(tmp_path):
    """Tables of ISO 230-2 hold no times: the same places and sides, at the pace of the machine."""
    job_path = write_job(tmp_path, more=LASER)
    timed = [row.split(",") for row in laser_rows(lambda x, way: -3.0 * way).splitlines()]
    rows = [",".join([*cells[:3], cells[4]]) for cells in timed]
    (tmp_path / "laser.csv").write_text("\n".join(rows) + "\n")
    job = read_job(job_path)
    backlash = set_up_effect("backlash", "X", {"reversal_um": 6.0}, job=job)
    (laser,) = read_instruments(job, effects=[backlash])
    np.testing.assert_allclose(laser.measured_mm, laser.predicted_mm, atol=1e-12)
    (note,) = [note for note in laser.notes if note.kind == Kind.CLOCK]
    assert note.place == "t_s" and "5 s at each place" in note.text
    time_s, way_mm = (
        Circumstances(laser.states, job).time_s,
        np.abs(np.diff(laser.states.nose_mm[:, 0])),
    )
    rapid_mm_per_s = job.machine.motion.rapid_mm_per_min / 60.0
    # the quickest move takes a millisecond
    np.testing.assert_allclose(np.diff(time_s), 5.0 + way_mm / rapid_mm_per_s, atol=3e-3)


WIDE = """position_mm,forward_1_um,backward_1_um,forward_2_um,backward_2_um
-300,1,8,2,9
-250,3,7,,6
-200,4,5,5,4
"""


def test_runs_side_by_side_are_read_in_their_order(tmp_path):
    """As tables after ISO 230-2 have them: out and back in turn, an empty cell was not read."""
    job_path = write_job(tmp_path, more=LASER)
    (tmp_path / "laser.csv").write_text(WIDE)
    (laser,) = read_instruments(read_job(job_path))
    out, back = [-300.0, -250.0, -200.0], [-200.0, -250.0, -300.0]
    np.testing.assert_array_equal(laser.states.nose_mm[:, 0], [*out, *back, -300.0, -200.0, *back])
    np.testing.assert_allclose(1e3 * laser.measured_mm, [1, 3, 4, 5, 7, 8, 2, 5, 4, 6, 9])
    assert laser.group.tolist() == ["run 1"] * 6 + ["run 2"] * 5
    sides = Circumstances(laser.states, read_job(job_path)).play_side[:, 0]
    np.testing.assert_array_equal(sides, [1] * 3 + [-1] * 3 + [1] * 2 + [-1] * 3)


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("backward_2_um", "backward_2_mm", "in the unit of deviation_um"),
        ("backward_2_um", "backward_1_um", "position_mm, forward_1, backward_1"),
        ("backward_2_um", "comment", "header"),
        ("-250,", "here,", "position_mm is 'here'"),
        ("-250,3,7,,6", "-250,3,7", "3 cells"),
        (",7,", ",seven,", "backward_1_um is 'seven'"),
        ("\n-300,1,8,2,9\n-250,3,7,,6\n-200,4,5,5,4", "", "no rows"),
        ("1,8,2,9\n-250,3,7,,6\n-200,4,5,5,4", ",,,", "all cells are empty"),
    ],
)
def test_runs_side_by_side_that_are_wrong_are_refused(tmp_path, before, after, said):
    job_path = write_job(tmp_path, more=LASER)
    assert before in WIDE
    (tmp_path / "laser.csv").write_text(WIDE.replace(before, after))
    with pytest.raises(InputError) as caught:
        read_instruments(read_job(job_path))
    assert said in str(caught.value) and "laser.csv" in str(caught.value)


def diagonal_rows(distances, ways):
    rows = ["run,distance_mm,approach,t_s,deviation_um"]
    pairs = zip(distances, ways, strict=True)
    return "\n".join([*rows, *(f"1,{d},{w},{5.0 * k},{k % 2}" for k, (d, w) in enumerate(pairs))])


def test_diagonal_sees_scales_and_the_side_of_each_axis(tmp_path):
    """Scales add up by the squares of the direction's cosines; Y runs the other way."""
    job_path = write_job(tmp_path, more=DIAGONAL)
    distance = np.concatenate([np.arange(0.0, 401.0, 40.0), np.arange(400.0, -1.0, -40.0)])
    way = np.repeat([1, -1], 11)
    (tmp_path / "diagonal.csv").write_text(diagonal_rows(distance, way))
    job = read_job(job_path)
    along = np.array([300.0, -200.0, 200.0]) / np.sqrt(170000.0)
    sizes = {"X": 40.0, "Y": -25.0, "Z": 10.0}
    scales = [set_up_effect("scale", a, {"scale_ppm": v}, job=job) for a, v in sizes.items()]
    (diagonal,) = read_instruments(job, effects=scales)
    rate = 1e-6 * np.sum(np.array(list(sizes.values())) * along**2)
    moved = diagonal.predicted_mm - diagonal.predicted_mm[0]
    np.testing.assert_allclose(moved, rate * distance, atol=1e-12)
    backlash = set_up_effect("backlash", "Y", {"reversal_um": 6.0}, job=job)
    (diagonal,) = read_instruments(job, effects=[backlash])
    # Y arrives from its own positive side while the diagonal runs forward
    np.testing.assert_allclose(diagonal.predicted_mm, 3e-3 * along[1] * way, atol=1e-12)


def test_diagonal_without_length_is_refused(tmp_path):
    same = DIAGONAL.replace("to_mm = [-50, -250, -50]", "to_mm = [-350, -50, -250]")
    job_path = write_job(tmp_path, more=same)
    (tmp_path / "diagonal.csv").write_text(diagonal_rows([0, 10], [1, 1]))
    with pytest.raises(InputError, match="same place"):
        read_instruments(read_job(job_path))


@pytest.mark.parametrize(("distances", "line"), [([0, 200, 420], 4), ([-5, 200, 400], 2)])
def test_places_beyond_a_diagonal_are_refused(tmp_path, distances, line):
    """It is 412.3 mm long: longer ones are of another diagonal, or count from elsewhere."""
    job_path = write_job(tmp_path, more=DIAGONAL)
    (tmp_path / "diagonal.csv").write_text(diagonal_rows(distances, [1, 1, 1]))
    with pytest.raises(InputError, match=rf"diagonal\.csv:{line}: distance_mm is .* beyond an end"):
        read_instruments(read_job(job_path))


def test_ballbar_turns_both_ways(tmp_path):
    """A scale error of X shows as s R cos^2, servo mismatch with the sign of the turn."""
    job_path = write_job(tmp_path, more=BALLBAR)
    angles = np.arange(0.5, 360, 5.0)
    rows = ["run,feed_mm_min,angle_deg,t_s,radius_um"]
    seconds = 2 * np.pi * 100 / 1000 * 60
    for run, start, way in (("ccw", 0.0, angles), ("cw", 100.0, angles[::-1])):
        rows += [f"{run},1000,{a},{start + seconds * k / 72},{k % 2}" for k, a in enumerate(way)]
    (tmp_path / "ballbar.csv").write_text("\n".join(rows))
    job = read_job(job_path)
    scale = set_up_effect("scale", "X", {"scale_ppm": 50.0}, job=job)
    mismatch = set_up_effect("servo_mismatch", "XY", {"mismatch_ms": 1.0}, job=job)
    a = np.radians(np.concatenate([angles, angles[::-1]]))
    (bar,) = read_instruments(job, effects=[scale])
    expected = 50e-6 * (-200 + 100 * np.cos(a)) * np.cos(a)
    np.testing.assert_allclose(bar.predicted_mm, expected, atol=1e-9)
    (bar,) = read_instruments(job, effects=[mismatch])
    turn = np.repeat([1.0, -1.0], 72)
    expected = -turn * 1e-3 * (1000 / 60) * np.sin(a) * np.cos(a)
    np.testing.assert_allclose(bar.predicted_mm, expected, atol=1e-4)


def test_the_pause_between_ballbar_runs_is_run_out_and_run_up(tmp_path):
    """At 10 s a turn and 8 s between the runs: 0.32 of a turn each; the first run-up alike."""
    job_path = write_job(tmp_path, more=BALLBAR)
    angles = np.arange(0.0, 361.0, 5.0)
    rows = ["run,feed_mm_min,angle_deg,t_s,radius_um"]
    for run, start, way in (("ccw", 0.0, angles), ("cw", 18.0, angles[::-1])):
        rows += [f"{run},3770,{a % 360},{start + 10 * k / 72},{k % 2}" for k, a in enumerate(way)]
    (tmp_path / "ballbar.csv").write_text("\n".join(rows))
    (bar,) = read_instruments(read_job(job_path))
    sweeps = bar.states.moves.sweep_rad / (2 * np.pi)
    np.testing.assert_allclose(sweeps[sweeps != 0], [1.64, -1.32], atol=1e-9)
    place = bar.states.nose_mm[[0, 72, 73, 145]]
    np.testing.assert_allclose(place, np.tile([-100.0, -150.0, -100.0], (4, 1)), atol=1e-9)


def test_drift_follows_the_spindle_and_tip_its_sides(tmp_path):
    job_path = write_job(tmp_path, more=DRIFT + TIP)
    rows = ["t_s,spindle_rpm,dx_um,dy_um,dz_um"]
    rows += [f"{60.0 * k},{8000 if k < 30 else 0},{k % 2},0,0" for k in range(60)]
    (tmp_path / "drift.csv").write_text("\n".join(rows))
    random = np.random.default_rng(5)
    rows = ["id,t_s,X,Y,Z,sx,sy,sz,dx_um,dy_um,dz_um"]
    sides = random.choice([-1, 1], (40, 3))
    for k, side in enumerate(sides):
        x, y, z = random.uniform(-250, -50, 3)
        rows.append(f"{k},{8.0 * k},{x},{y},{z},{side[0]},{side[1]},{side[2]},{k % 2},0,0")
    (tmp_path / "tip.csv").write_text("\n".join(rows))
    job = read_job(job_path)
    drift, tip = read_instruments(job)
    warmth = Circumstances(drift.states, job).warmth_of_spindle(600.0, 1.0)[::3]
    time = 60.0 * np.arange(60)
    heated = 1 - np.exp(-np.minimum(time, 1800) / 600)
    np.testing.assert_allclose(
        warmth, heated * np.exp(-np.maximum(time - 1800, 0) / 600), atol=1e-9
    )
    np.testing.assert_array_equal(Circumstances(tip.states, job).play_side[::3], sides)
    assert tip.nuisance.shape == (120, 6)


@pytest.mark.parametrize(
    ("more", "text", "message"),
    [
        (LASER.replace("laser.csv", "no.csv"), "", "not found"),
        (LASER, "run,position_mm\n1,2\n", "column 'approach' is missing"),
        (LASER, "run,position_mm,approach,t_s,deviation_um\n1,x,1,0,0\n", "position_mm is 'x'"),
        (LASER, "run,position_mm,approach,t_s,deviation_um\n", "no rows"),
        (LASER.replace('"laser"', '"lasr"', 1), "", "kind = ballbar, calliper, diagonal"),
        (LASER.replace("u_um = 0.3", "u_um = -1"), "", "u_um"),
        (LASER + "colour = 3\n", "", "colour"),
    ],
)
def test_bad_instrument_files_are_refused(tmp_path, more, text, message):
    job_path = write_job(tmp_path, more=more)
    (tmp_path / "laser.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        read_instruments(read_job(job_path))


def measured(tmp_path, change):
    """Measure the small part after changing its measured points (in place)."""
    job = read_job(write_job(tmp_path))
    _, points, _ = pocket_points()
    moved = points.copy()
    moved = change(moved) if change else moved
    write_points(tmp_path / "points.csv", moved)
    return measure_part(prepare(job), tmp_path / "points.csv")[0]


def test_perfect_part_has_no_residual(tmp_path):
    part = measured(tmp_path, None)
    np.testing.assert_allclose(part.measured_mm, part.predicted_mm, atol=2e-5)
    assert part.on_part and part.nuisance.shape[1] == 6
    assert [note.kind for note in part.notes] == [Kind.CONTROL]  # which language was assumed


def test_chip_under_the_probe_is_left_out_and_said(tmp_path):
    def chip(points):
        _, _, normals = pocket_points()
        points[50] += 0.08 * normals[50]
        return points

    part = measured(tmp_path, chip)
    assert "51" not in part.id
    assert any("chip" in str(note) and "51" in str(note) for note in part.notes)


def test_metres_and_other_parts_are_refused(tmp_path):
    with pytest.raises(InputError, match="metres"):
        measured(tmp_path, lambda p: p * 1e-3)
    with pytest.raises(InputError, match="from the nominal"):
        measured(tmp_path, lambda p: p[::-1] + 3.0)


def test_uncertainty_in_mm_is_refused(tmp_path):
    job = read_job(write_job(tmp_path))
    file = tmp_path / "points.csv"
    head, *rows = file.read_text().splitlines()
    rows = [row.rsplit(",", 1)[0] + ",0.0005" for row in rows]
    file.write_text("\n".join([head, *rows]))
    with pytest.raises(InputError, match=r"u_um is 0.0005 um.*is the column in mm"):
        measure_part(prepare(job), file)


def test_points_that_the_program_does_not_make_are_refused(tmp_path):
    job = read_job(write_job(tmp_path))
    file = tmp_path / "points.csv"
    head, *rows = file.read_text().splitlines()
    cells = [row.split(",") for row in rows]
    inches = [
        [*c[:2], *(repr(float(v) / 25.4) for v in c[2:5]), *c[5:8],
         *(repr(float(v) / 25.4) for v in c[8:11]), *c[11:]]
        for c in cells
    ]  # fmt: skip
    file.write_text("\n".join([head, *(",".join(c) for c in inches)]))
    with pytest.raises(InputError, match=r"the program cuts \d+ of"):
        measure_part(prepare(job), file)


def test_a_part_far_from_the_predicted_one_is_refused(tmp_path):
    """Readings scattered by half a millimetre come from another part."""
    random = np.random.default_rng(3)

    def scattered(points):
        _, _, normals = pocket_points()
        return points + 0.45 * random.choice([-1.0, 1.0], (len(points), 1)) * normals

    with pytest.raises(InputError, match=r"from the predicted one \(median, aligned\)"):
        measured(tmp_path, scattered)


def test_repeated_rows_count_once(tmp_path):
    job = read_job(write_job(tmp_path))
    file = tmp_path / "points.csv"
    lines = file.read_text().splitlines()
    file.write_text("\n".join([*lines, *lines[1:6]]) + "\n")
    part, _ = measure_part(prepare(job), file)
    assert len(part) == len(lines) - 1
    assert any("repeat" in str(note) for note in part.notes)


def test_points_that_no_move_cut_are_left_out_and_said(tmp_path):
    job = read_job(write_job(tmp_path))
    file = tmp_path / "points.csv"
    file.write_text(file.read_text() + "extra,top,55,20,0,0,0,1,55,20,0,0.5\n")
    part, _ = measure_part(prepare(job), file)
    assert "extra" not in part.id
    assert any("no move cut" in str(note) and "extra" in str(note) for note in part.notes)


def test_unknown_uncertainty_is_taken_from_neighbours(tmp_path):
    job = read_job(write_job(tmp_path))
    random = np.random.default_rng(2)
    _, points, normals = pocket_points()
    noisy = points + 2e-3 * random.standard_normal((len(points), 1)) * normals
    write_points(tmp_path / "points.csv", noisy)
    file = tmp_path / "points.csv"
    file.write_text("\n".join(x.rsplit(",", 1)[0] for x in file.read_text().splitlines()))
    part, _ = measure_part(prepare(job), file)
    np.testing.assert_allclose(part.u_mm, 2e-3, rtol=0.4)
