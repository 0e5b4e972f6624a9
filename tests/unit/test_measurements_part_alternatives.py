"""A part says where on the machine it was cut, and from which side.

Measured points are worked out by hand: the tool stands on the outer side of a wall, so that an
error along the outward normal leaves material.
"""

import numpy as np
import pytest

from tests.small_job import pocket_points, write_job, write_points
from vmach.base.note import Kind
from vmach.instruments import measure_part
from vmach.job import read_job
from vmach.path.preparation import prepare

TOOL_RADIUS_MM = 5.0
LOW, HIGH = -400.0, 400.0


def tip_mm(points, normals):
    """Tip of a flat tool that cuts walls beside it and floors below it."""
    return points + TOOL_RADIUS_MM * normals * [1, 1, 0]


def written(folder, tables, deviation_mm, *, directions="mean"):
    """The small job on a machine with travel from -400 to 400, measured as it deviates."""
    job = write_job(folder)
    machine = folder / "machine.toml"
    text = machine.read_text().replace(
        "[motion]", f'[tables]\ndirections = "{directions}"\n[motion]'
    )
    for low in (-400, -300):
        text = text.replace(f"travel_mm = [{low}, 0]", f"travel_mm = [{LOW}, {HIGH}]")
    (folder / "errors").mkdir()
    for name, (forward, backward) in tables.items():
        rows = [f"{x},{forward(x):.9f},{backward(x):.9f}" for x in np.arange(LOW, HIGH + 1.0, 10.0)]
        table = "\n".join(["position_mm,forward,backward", *rows])
        (folder / "errors" / f"{name}.csv").write_text(table + "\n")
        text += f'[errors.{name}]\ntable = "errors/{name}.csv"\n'
        text += "measured_at_mm = [0, 0, 0]\n" if name[1] in "XYZ" else ""
    machine.write_text(text)
    _, points, normals = pocket_points()
    noise_mm = 0.5e-3 * np.random.default_rng(2).normal(size=len(points))
    write_points(folder / "points.csv", points + (deviation_mm + noise_mm)[:, None] * normals)
    return job


def notes_of(job):
    """What is said of the measurement; which control was assumed is said of the program."""
    job = read_job(job)
    notes = measure_part(prepare(job), job.measured)[0].notes
    return tuple(str(note) for note in notes if note.kind is not Kind.CONTROL)


def wave_um(x):
    return 30.0 * np.sin(np.asarray(x) / 25.0)


def error_along_x(zero_mm):
    """EXX alone at a work offset: the error pushes along the normal."""
    _, points, normals = pocket_points()
    x = tip_mm(points, normals)[:, 0] + zero_mm
    # tables are straight between positions 10 mm apart
    knots = np.arange(LOW, HIGH + 1.0, 10.0)
    return 1e-3 * np.interp(x, knots, wave_um(knots)) * normals[:, 0]


def test_the_sign_of_a_work_offset(tmp_path):
    right, wrong = tmp_path / "right", tmp_path / "wrong"
    for folder, zero in ((right, -200.0), (wrong, 200.0)):
        folder.mkdir()
        job = written(folder, {"EXX": (wave_um, wave_um)}, error_along_x(zero))
        if folder is right:
            assert notes_of(job) == ()
    (note,) = notes_of(job)
    assert note.startswith("points.csv: with G54 at X200 the readings would agree")
    assert note.endswith("is the sign of G54 right in X?")


@pytest.mark.parametrize("turned", [False, True])
def test_exchanged_directions(tmp_path, turned):
    """Lost motion of 24 um in Y, which the tables hold: around the bore its side changes."""
    names, points, normals = pocket_points()
    way = np.zeros(len(points))  # of the tool along Y when it cut each point
    bore = names == "bore"
    way[bore] = np.sign(points[bore, 0] - 40.0) * -1.0  # clockwise
    way[names == "wall +Y"] = 1.0
    way[names == "wall -Y"] = -1.0
    side_um = 12.0 * (-1.0 if turned else 1.0)
    job = written(
        tmp_path,
        {"EYY": (lambda y: -side_um, lambda y: side_um)},
        -12e-3 * way * normals[:, 1],
        directions="separate",
    )
    notes = notes_of(job)
    assert bool(notes) == turned
    if turned:
        assert "points.csv: with forward and backward of Y exchanged" in notes[0]
