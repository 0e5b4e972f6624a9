"""Short moves of a ball-end raster without CAD: compensated without their solid."""

import math

import numpy as np
import pytest

from tests.small_job import write_job
from vmach.compensation import compensate
from vmach.compensation.aim.surface import check_surface, read_surface
from vmach.job import read_job

ROWS, COLUMNS = 12, 30
BLANK = ([-16.0, -7.0, -20.0], [16.0, 7.0, -1.0])


def floor_mm(x, y):
    return -3 + 1.5 * math.sin(x / 12) * math.cos(y / 15)


def write_raster(folder):
    """A job whose X axis is 100 um/m too long, without CAD."""
    job = write_job(folder, {"EXX": (lambda x: 0.1 * x, (0, 0, -250))})
    lines = ["G21 G17 G90 G94", "T1 M6", "S8000 M3", "G54 G43 H1", "G0 X-15 Y-6 Z20", "F3000"]
    for row, y in enumerate(np.linspace(-6, 6, ROWS)):
        xs = np.linspace(-15, 15, COLUMNS)
        for x in xs if row % 2 == 0 else xs[::-1]:
            lines.append(f"G1 X{x:.4f} Y{y:.4f} Z{floor_mm(x, y):.4f}")
    (folder / "part.nc").write_text("\n".join([*lines, "G0 Z20", "M30"]) + "\n")
    text = job.read_text().replace(
        'shape = "flat"\ndiameter_mm = 10', 'shape = "ball"\ndiameter_mm = 8'
    )
    text = text.replace("[-30, -25, -20]", str(BLANK[0])).replace("[60, 25, 0]", str(BLANK[1]))
    job.write_text("".join(x for x in text.splitlines(True) if not x.startswith("measured")))
    return read_job(job)


def test_points_lie_on_the_balls_and_in_none(tmp_path):
    job = write_raster(tmp_path)
    surface = read_surface(job, with_aim=True)
    corners = np.array([
        [float(word[1:]) for word in line.split()[1:]]
        for line in (tmp_path / "part.nc").read_text().splitlines()
        if line.startswith("G1 ")
    ])  # fmt: skip
    for points in (surface.points.point_mm, surface.aim.point_mm):
        start, way = corners[:-1] + np.array([0, 0, 4.0]), np.diff(corners, axis=0)
        offset = points[:, None] - start
        share = np.einsum("psi,si->ps", offset, way) / np.einsum("si,si->s", way, way)
        gap = offset - np.clip(share, 0, 1)[:, :, None] * way
        np.testing.assert_allclose(np.linalg.norm(gap, axis=2).min(axis=1), 4.0, atol=1e-8)
    assert len(surface.points) > 60
    assert len(surface.aim) > len(surface.points)
    distance = np.linalg.norm(surface.aim.point_mm[:, None] - surface.points.point_mm, axis=2)
    assert distance.min() > 1e-3


def test_what_is_left_follows_from_the_scale_of_the_axis(tmp_path):
    job = write_raster(tmp_path)
    surface = read_surface(job, with_aim=True)
    found = compensate(job, round_points=surface.aim)
    checked = check_surface(job, found.text, surface)
    nose_x = job.work_offsets_mm["G54"][0] + surface.points.point_mm[checked.row, 0]
    normal = surface.points.normal[checked.row]
    # the tool's tip is beside the point by the radius along the normal
    expected = 1e-4 * (nose_x + 4.0 * normal[:, 0]) * normal[:, 0]
    off = np.abs(checked.before_mm - expected)
    assert np.quantile(off, 0.9) < 2e-6
    assert off.max() < 5e-4  # beside a cusp, where 20 um sideways bring another move
    assert np.abs(checked.after_mm).max() < 0.9e-3
    assert checked.ratio > 3.0


@pytest.mark.parametrize("aim", [False, True])
def test_no_solid_is_cut(tmp_path, monkeypatch, aim):
    import stock.solid

    def refuse(*_, **__):
        raise AssertionError("the solid was asked for")

    monkeypatch.setattr(stock.solid, "cut_part", refuse)
    monkeypatch.setattr("stock.cut_part", refuse)
    assert len(read_surface(write_raster(tmp_path), with_aim=aim).points)


def test_what_the_tables_leave_open_stands_beside_what_the_model_leaves(tmp_path):
    """The figures of `predict` for the written program, and nothing of the model's residual."""
    from vmach.compensation.figures import as_json, as_text
    from vmach.run.pipeline import predict_points
    from vmach.run.results import prediction_columns

    job = write_raster(tmp_path)
    surface = read_surface(job)
    found = compensate(job)
    checked = check_surface(job, found.text, surface)
    (tmp_path / "moved.nc").write_bytes(found.text)
    rows = np.hstack([surface.points.point_mm, surface.points.normal]).tolist()
    lines = [f"{k},floor," + ",".join(map(repr, row)) for k, row in enumerate(rows)]
    (tmp_path / "p.csv").write_text("id,feature,x,y,z,i,j,k\n" + "\n".join(lines) + "\n")
    points, prediction = predict_points(
        job.path, tmp_path / "p.csv", program_path=tmp_path / "moved.nc"
    )
    u_um = prediction_columns(points, prediction)["u_um"].values[checked.row]
    np.testing.assert_allclose(1e3 * checked.u_mm, u_um, rtol=1e-6)
    part = as_json(found, checked)["surface"]
    assert part["u_mean_um"] == pytest.approx(u_um.mean())
    assert part["u_largest_um"] == pytest.approx(u_um.max())
    after_um = 1e3 * checked.after_mm
    assert part["expected_rms_um"] == pytest.approx(np.sqrt(np.mean(after_um**2 + u_um**2)))
    text = "\n".join(as_text(found, checked))
    assert f"standard uncertainty largest {u_um.max():.3f} um" in text
    assert "in the model" in text
    assert f"RMS {part['expected_rms_um']:.3f} um" in text
