"""Programs aimed at the part, against shifts worked out by hand."""

import json
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.oracle.test_compensation_programs import BODY, SCALE, job_with, numbers
from tests.oracle.test_compensation_surface import AROUND, STOCK, job_of_walls
from vmach.cli import app
from vmach.compensation import compensate
from vmach.compensation.aim import part_view
from vmach.compensation.aim.part_view import PartView
from vmach.compensation.aim.surface import check_surface, read_surface
from vmach.compensation.model import TipModel
from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.job import read_job
from vmach.machine import RigidDisplacement, Variant
from vmach.path.preparation import prepare

SAMPLES = Path(__file__).parents[2] / "samples"

#: the tool of 10 mm is thinner than that by 20 um
THIN = "[effects.tool_radius.T1]\nradius_um = -10\n"
#: a bore of 9 mm radius without anything left in its middle
BORE = "G0 X40. Y30.\nG1 Z-8. F400\nX44.\nG3 X44. Y30. I-4. J0.\nG1 X40. F800\nG0 Z5.\nM30\n"


@dataclass(frozen=True)
class Tilt:
    """A tool that turns about its tip, which stays where it is."""

    about_y_rad: float
    label: str = "tilt"

    def displacement(self, states):
        tilt = np.tile([0.0, self.about_y_rad, 0.0], (len(states), 1))
        return RigidDisplacement(np.zeros_like(tilt), tilt)

    def at_surface(self, states):
        return np.zeros((len(states), 3))

    def tool_shift(self, states):
        return np.zeros((len(states), 3))

    def uncertainty_patterns(self, states):
        return np.zeros((len(states), 3, 0))


def job_in_stock(folder, body, effects=""):
    job_with(folder, body, effects)
    with (folder / "job.toml").open("a") as file:
        file.write(STOCK)
    job = read_job(folder)
    return job, read_effects(job.effects, file=job.path, job=job)


def aimed(job, effects, **options):
    """The compensated program, and the check on points that it was not aimed at."""
    surface = read_surface(job, with_aim=True)
    found = compensate(job, effects, aim_points=surface.aim, **options)
    return found, check_surface(job, found.text, surface, effects=effects)


def normals(checked):
    return checked.surface.points.normal[checked.row]


def test_tilt_is_centred_on_walls(tmp_path):
    job, _ = job_in_stock(tmp_path, AROUND)
    tilt, depth = 300e-6, 8.0
    found, checked = aimed(job, [Tilt(tilt)], resolution_mm=1e-5)
    # at height z over the tip the cutter is tilt * z too far to the right, to first order
    east = normals(checked)[:, 0] > 0.99
    height = checked.surface.points.point_mm[checked.row, 2] + depth
    np.testing.assert_allclose(checked.before_mm[east], tilt * height[east], atol=1e-6)
    # half of the depth is the middle, found within the spacing of the points
    slack = 0.1 * tilt * depth
    wanted = tilt * (height[east] - 0.5 * depth)
    np.testing.assert_allclose(checked.after_mm[east], wanted, atol=slack)
    wanted = np.array([75.0, 5.0]) - 0.5 * tilt * depth
    np.testing.assert_allclose(numbers(found.text, "X")[-2:], wanted, atol=slack)
    assert found.growth == 1.0
    # the tool is where it was asked
    assert found.unrounded.largest_mm < 1e-5


def test_a_thin_tool_is_led_nearer_to_the_walls(tmp_path):
    job, effects = job_in_stock(tmp_path, AROUND, THIN)
    found, checked = aimed(job, effects)
    words = [line.split()[0] for line in found.text.decode().splitlines()[-6:-2]]
    assert words == ["X74.99", "Y54.99", "X5.01", "Y5.01"]
    assert b"Z-8." in found.text, "the floor is right as it is"
    walls = np.abs(normals(checked)[:, 2]) < 0.01
    np.testing.assert_allclose(checked.before_mm[walls], 10e-3, atol=1e-8)
    assert np.abs(checked.after_mm).max() < 0.2e-3
    # the shift of a corner answers two walls
    assert found.part_aim.largest_shift_mm == pytest.approx(10e-3 * 2**0.5, rel=0.01)


def test_arcs_get_another_radius_and_stay_arcs(tmp_path):
    job, effects = job_in_stock(tmp_path, BORE, THIN)
    found, checked = aimed(job, effects)
    assert np.abs(checked.after_mm).max() < 0.5e-3
    assert (found.arcs, found.arcs_kept) == (1, 1)
    assert numbers(found.text, "X")[-3:] == [35.99, 44.01, 40.0]
    assert numbers(found.text, "I") == [-4.01, 4.01]


def test_a_long_tool_is_lifted(tmp_path):
    job, effects = job_in_stock(tmp_path, AROUND, "[effects.tool_length.T1]\nlength_um = 12\n")
    found, checked = aimed(job, effects)
    assert found.text == (tmp_path / "part.nc").read_bytes().replace(b"Z-8.", b"Z-7.988")
    assert np.abs(checked.after_mm).max() < 1e-6


SLIPPED = "[effects.datum_shift]\nshift_x_um = 9\nshift_y_um = 0\nshift_z_um = 0\ntime_s = 1\n"


@pytest.mark.parametrize(("effects_text", "said"), [(SLIPPED, ["datum_shift"]), (THIN, [])])
def test_what_happened_once_is_answered_with_a_note(tmp_path, effects_text, said):
    job, effects = job_in_stock(tmp_path, AROUND, effects_text)
    found, _ = aimed(job, effects)
    once = [note for note in found.notes if note.kind == "once"]
    assert [note.place for note in once] == said
    assert all(note.size == 1.0 for note in once)
    kept = compensate(job, effects)
    assert not [note for note in kept.notes if note.kind == "once"], "the tip does not answer it"


def test_a_ball_that_is_thin_stays_on_its_slope(tmp_path):
    # passes along Y through the blank, 0.8 mm apart up a slope of 30 degrees, ball of 10 mm
    normal = np.array([-0.5, 0.0, 0.75**0.5])
    rows = []
    for number in range(12):
        x = 0.8 * 0.75**0.5 * number
        tip = np.array([20.0 + x, 0.0, -15.0 + x * 0.5 / 0.75**0.5]) + 5.0 * normal
        tip[2] -= 5.0
        y = (0.0, 60.0) if number % 2 else (60.0, 0.0)
        rows += [f"G1 X{tip[0]:.4f} Y{y[0]:.1f} Z{tip[2]:.4f} F800", f"Y{y[1]:.1f}"]
    job, _ = job_in_stock(tmp_path, "\n".join([*rows, "G0 Z5.", "M30", ""]), THIN)
    text = job.path.read_text().replace('"flat"', '"ball"')
    job.path.write_text(text + "[inspection]\nspacing_mm = 1\n")
    job = read_job(tmp_path)
    effects = read_effects(job.effects, file=job.path, job=job)
    _, checked = aimed(job, effects, resolution_mm=1e-4)
    # the bottoms of the grooves; the first pass cuts a wall on its other side
    x = checked.surface.points.point_mm[checked.row, 0]
    bottom = (normals(checked) @ normal > 0.9995) & (x > 21.5)
    assert bottom.sum() > 50
    # a smaller ball with the same tip; the slope varies by half a step over each groove
    expected = 10e-3 * (1.0 - normals(checked)[bottom, 2])
    np.testing.assert_allclose(checked.before_mm[bottom], expected, atol=1e-5)
    assert checked.before_mm[bottom].min() > 10e-3 * (1.0 - np.cos(np.radians(30.0 - 1.82)))
    assert np.abs(checked.after_mm[bottom]).max() < 1e-3


def test_the_bottom_of_a_drilled_hole_is_lifted(tmp_path):
    body = "G81 X30. Y20. Z-5. R2. F100\nX40. Y30.\nG80\nM30\n"
    job, effects = job_in_stock(tmp_path, body, "[effects.tool_length.T1]\nlength_um = 12\n")
    found, checked = aimed(job, effects)
    assert set(numbers(found.text, "Z")[-4:]) >= {-4.988}
    bottom = normals(checked)[:, 2] > 0.99
    assert bottom.sum() > 10
    assert np.abs(checked.after_mm[bottom]).max() < 1e-6


def test_a_spring_pass_follows_the_pass_that_it_repeats(tmp_path):
    body = AROUND.replace("Y5.\nG0", "Y5.\nX75.\nY55.\nX5.\nY5.\nG0")
    job, effects = job_in_stock(tmp_path, body, THIN)
    found, checked = aimed(job, effects)
    assert np.abs(checked.after_mm).max() < 0.2e-3
    words = [line.split()[0] for line in found.text.decode().splitlines()[-10:-2]]
    assert words == ["X74.99", "Y54.99", "X5.01", "Y5.01"] * 2


@pytest.mark.parametrize("effects", [SCALE, "[effects.cyclic_pitch.X]\namplitude_um = 4\n"
                                     "pitch_mm = 40\nphase_rad = 0.3\n", ""])  # fmt: skip
@pytest.mark.parametrize("body", [AROUND, BORE, BODY])
def test_where_nothing_asks_for_a_shift_there_is_none(tmp_path, body, effects):
    job, effects = job_in_stock(tmp_path, body, effects)
    surface = read_surface(job, with_aim=True)
    found = compensate(job, effects, aim_points=surface.aim)
    assert found.text == compensate(job, effects, round_points=surface.aim).text
    assert found.part_aim.rounds == 0


def test_walls_on_both_sides_of_one_move_stay(tmp_path):
    body = "G0 X20. Y30.\nG1 Z-8. F400\nX60.\nG0 Z5.\nM30\n"
    job, effects = job_in_stock(tmp_path, body, THIN)
    found, checked = aimed(job, effects)
    sides = np.abs(normals(checked)[:, 1]) > 0.9999
    np.testing.assert_allclose(checked.after_mm[sides], 10e-3, atol=1e-4)
    assert found.part_aim.part.largest_mm == pytest.approx(10e-3, rel=0.01)


def test_no_point_that_is_aimed_at_is_inspected(tmp_path):
    job, _ = job_of_walls(tmp_path, SCALE)
    for with_points in (True, False):
        if not with_points:
            job = replace(job, measured=None)
        surface = read_surface(job, with_aim=True)
        gap = surface.aim.point_mm[:, None] - surface.points.point_mm[None, :200]
        assert np.linalg.norm(gap, axis=2).min() > 1e-3
        assert len(surface.aim.point_mm) > 500


def test_shifts_count_against_the_limit(tmp_path):
    job, effects = job_in_stock(tmp_path, AROUND, THIN)
    with pytest.raises(InputError, match=r"corrections up to 14\."):
        aimed(job, effects, limit_mm=0.012)


def test_a_path_shifted_the_wrong_way_is_refused(tmp_path, monkeypatch):
    from vmach.compensation.aim import part_aim

    right = part_aim.centred

    def wrong(shift, demand):
        return right(shift, replace(demand, shift_mm=-demand.shift_mm))

    monkeypatch.setattr(part_aim, "centred", wrong)
    job, effects = job_in_stock(tmp_path, AROUND, THIN)
    found, _ = aimed(job, effects)
    assert found.part_aim.rounds == 0, "it is worse than none"
    monkeypatch.setattr(part_aim, "_BETTER", np.inf)
    monkeypatch.setattr(part_aim, "_WORSE", np.inf)
    with pytest.raises(InputError, match="are left on the part") as caught:
        aimed(job, effects)
    assert caught.value.line in range(10, 16)


def test_command_line(tmp_path):
    job_in_stock(tmp_path, AROUND, THIN)
    out, report = tmp_path / "out.nc", tmp_path / "report.html"
    command = ["compensate", str(tmp_path), "-o", str(out), "--aim", "part"]
    result = CliRunner().invoke(app, [*command, "--json", "--report", str(report)])
    assert result.exception is None, result.exception
    figures = json.loads(result.stdout)
    assert figures["aimed_at"]["tool_largest_um"] == pytest.approx(10.0)
    assert figures["aimed_at"]["part_largest_um"] < 0.2
    assert figures["surface"]["after_largest_um"] < 0.2
    assert [named["surface_um"] for named in figures["uncorrected"]] == [
        figures["aimed_at"]["part_largest_um"]
    ]
    assert "aimed at, part in place" in report.read_text(encoding="utf-8")
    text = re.sub(r"\[stock\].*", "", (tmp_path / "job.toml").read_text(), flags=re.DOTALL)
    (tmp_path / "job.toml").write_text(text)
    result = CliRunner().invoke(app, command)
    assert isinstance(result.exception, InputError)
    assert "no surface to aim at" in str(result.exception)


def test_sample_part_keeps_less_of_the_tilt():
    job = read_job(SAMPLES / "spline_slot" / "centre.toml")
    effects = read_effects(job.effects, file=job.path, job=job)
    surface = read_surface(job, with_aim=True)
    found = compensate(job, effects, variant=Variant.HTM, aim_points=surface.aim)
    aim = found.part_aim
    assert aim.part.largest_mm < 0.85 * aim.tool.largest_mm
    assert aim.part.mean_mm < 0.7 * aim.tool.mean_mm
    assert found.unrounded.largest_mm < 0.11e-3
    assert found.growth < 1.01
    checked = check_surface(job, found.text, surface, effects=effects, variant=Variant.HTM)
    # largest 0.99 um, mean 0.31 um with the tool on its nominal path
    assert np.abs(checked.after_mm).max() < 0.9e-3
    assert np.abs(checked.after_mm).mean() < 0.28e-3


def test_a_surface_of_very_many_points_is_looked_at_in_some(tmp_path, monkeypatch):
    """A facing mill of half a metre makes 25 times the points of an ordinary one from each move."""
    job, _ = job_in_stock(tmp_path, AROUND)
    prepared, aim = prepare(job), read_surface(job, with_aim=True).aim
    every = PartView(prepared, TipModel(Variant.ABBE, ()), aim)
    nodes = len(prepared.path.nodes.move)
    monkeypatch.setattr(part_view, "_POINTS_A_NODE", len(every.made) / nodes / 2.5)
    some = PartView(prepared, TipModel(Variant.ABBE, ()), aim)
    np.testing.assert_array_equal(some.made, every.made[::3])
    np.testing.assert_array_equal(some.perfect_mm, every.perfect_mm[::3])
