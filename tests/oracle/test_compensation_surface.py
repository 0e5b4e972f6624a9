"""The surface before and after a compensation, against walls worked out by hand."""

import re

import numpy as np
import pytest

from tests.oracle.test_compensation_programs import SCALE, SCALE_PPM, job_with
from vmach.compensation import compensate
from vmach.compensation.aim.surface import check_surface, read_surface
from vmach.compensation.figures import remarks
from vmach.effects import read_effects
from vmach.job import read_job

RADIUS = 5.0
#: outside of a block 60 x 40, its corner at X10 Y10, tool of 10 mm at Z-8
AROUND = "G0 X0. Y0.\nG1 Z-8. F400\nX5. Y5.\nX75.\nY55.\nX5.\nY5.\nG0 Z5.\nM30\n"
STOCK = "[stock]\nmin_mm = [8, 8, -20]\nmax_mm = [72, 52, 0]\n"


def job_of_walls(folder, effects):
    job, _ = job_with(folder, AROUND, effects)
    walls = {"west": (10.0, -1.0), "east": (70.0, 1.0)}
    rows = [f"{name},{name},{x},30,-4,{n},0,0" for name, (x, n) in walls.items()]
    rows.append("floor,floor,9,30,-8,0,0,1")
    (folder / "points.csv").write_text(
        "id,feature,x,y,z,i,j,k,mx,my,mz\n"
        + "".join(f"{row},{','.join(row.split(',')[2:5])}\n" for row in rows)
    )
    text = (folder / "job.toml").read_text()
    (folder / "job.toml").write_text('measured = "points.csv"\n' + text + STOCK)
    job = read_job(folder)
    return job, read_effects(job.effects, file=job.path, job=job)


def x_of_walls(text):
    """X programmed along the west and the east wall."""
    x = [float(v) for v in re.findall(r"X(-?\d+\.?\d*)", text.decode("latin-1"))]
    return min(v for v in x if v > 1.0), max(x)


def test_walls_move_by_what_is_programmed(tmp_path):
    job, effects = job_of_walls(tmp_path, SCALE)
    found = compensate(job, effects)
    checked = check_surface(job, found.text, read_surface(job), effects=effects)
    at = {name: k for k, name in enumerate(checked.surface.points.id[checked.row].tolist())}
    s = 1e-6 * SCALE_PPM
    # machine X is workpiece X + 100; the wall is a radius beside the tool's axis
    for wall, x, normal in (("west", 5.0, -1.0), ("east", 75.0, 1.0)):
        assert checked.before_mm[at[wall]] == pytest.approx(normal * s * (x + 100.0), abs=1e-8)
    for wall, x, nominal, normal in zip(
        ("west", "east"), x_of_walls(found.text), (5.0, 75.0), (-1.0, 1.0), strict=True
    ):
        expected = normal * ((x + 100.0) * (1.0 + s) - 100.0 - nominal)
        assert checked.after_mm[at[wall]] == pytest.approx(expected, abs=1e-8)
    assert np.abs(checked.after_mm).max() < 0.9e-3
    assert checked.ratio == pytest.approx(
        np.abs(checked.before_mm).mean() / np.abs(checked.after_mm).mean()
    )
    assert checked.lost == 0


def test_what_acts_at_the_edge_is_named_with_its_size(tmp_path):
    job, effects = job_of_walls(tmp_path, SCALE + "[effects.tool_radius.T1]\nradius_um = 7\n")
    found = compensate(job, effects)
    checked = check_surface(job, found.text, read_surface(job), effects=effects)
    (label,) = checked.at_edge_mm
    assert "T1" in label
    walls = np.abs(checked.surface.points.normal[checked.row][:, 0]) == 1.0
    np.testing.assert_allclose(checked.at_edge_mm[label][walls], -7e-3, atol=1e-12)
    assert list(remarks(found, checked))[-1].startswith("--aim part answers")
    # the path is not moved by it: all of it is left on the part
    assert np.abs(checked.after_mm[walls] + 7e-3).max() < 0.9e-3


def test_a_job_without_cad_is_looked_at_on_the_part_it_makes(tmp_path):
    job, effects = job_of_walls(tmp_path, SCALE)
    text = (tmp_path / "job.toml").read_text().removeprefix('measured = "points.csv"\n')
    (tmp_path / "job.toml").write_text(text)
    job = read_job(tmp_path)
    found = compensate(job, effects)
    surface = read_surface(job)
    checked = check_surface(job, found.text, surface, effects=effects)
    normal = surface.points.normal[checked.row]
    east = (normal[:, 0] > 0.999) & (surface.points.point_mm[checked.row, 0] > 60)
    assert east.sum() > 10
    np.testing.assert_allclose(checked.before_mm[east], 1e-6 * SCALE_PPM * 175.0, atol=1e-8)
    assert np.abs(checked.after_mm).max() < 0.9e-3


def test_without_any_surface_there_is_none(tmp_path):
    job, _ = job_with(tmp_path, AROUND, SCALE)
    assert read_surface(job) is None


def test_a_wall_that_was_cut_away_is_judged_by_the_move_that_made_it(tmp_path):
    # two passes 0.02 mm apart, then one through the wall; the scale moves all by 0.018 mm, so
    # that the numbers of the second pass come to stand next to where the first shall be
    body = "G0 X0. Y-20.\nG1 Z-8. F400\nY-5.\nX80.\nY-4.98\nX0.\nY0.\nX80.\nG0 Z5.\nM30\n"
    scale = "[effects.scale.Y]\nscale_ppm = 400\n"
    job_with(tmp_path, body, scale)
    (tmp_path / "points.csv").write_text(
        "id,feature,x,y,z,i,j,k,mx,my,mz\nwall,wall,40,0,-4,0,-1,0,40,0,-4\n"
    )
    text = (tmp_path / "job.toml").read_text()
    stock = "[stock]\nmin_mm = [-10, -10, -20]\nmax_mm = [90, 30, 0]\n"
    (tmp_path / "job.toml").write_text('measured = "points.csv"\n' + text + stock)
    job = read_job(tmp_path)
    effects = read_effects(job.effects, file=job.path, job=job)
    found = compensate(job, effects, resolution_mm=1e-5)
    checked = check_surface(job, found.text, read_surface(job), effects=effects)
    # machine Y of the first pass is 45: it leaves the wall 0.018 mm beyond its place
    np.testing.assert_allclose(np.abs(checked.before_mm), 400e-6 * 45.0, atol=1e-8)
    assert np.abs(checked.after_mm).max() < 2e-5
