"""Files of measured points that cannot be those of the part are refused with what is wrong."""

import numpy as np
import pytest

from tests.small_job import pocket_points, write_job
from vmach.base.note import Kind, Level
from vmach.errors import InputError
from vmach.instruments import measure_part
from vmach.job import read_job
from vmach.path.preparation import prepare

ZERO = np.array([-200.0, -150.0, -200.0])  #: G54 of the small job


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    return prepare(read_job(write_job(tmp_path_factory.mktemp("job"))))


def file_of(folder, points, normals, measured, *, u_um=0.5):
    names = pocket_points()[0]
    rows = np.hstack([points, normals, measured])
    lines = ["id,feature,x,y,z,i,j,k,mx,my,mz,u_um"]
    lines += [
        f"{k},{names[k]},{','.join(map(repr, row.tolist()))},{u_um}" for k, row in enumerate(rows)
    ]
    path = folder / "measured.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize(
    ("change", "hint"),
    [
        (lambda p, n: (p, -n), "i, j, k were turned round"),
        (lambda p, n: (p * 1e-3, n), "look like metres"),
        (lambda p, n: (p / 25.4, n), "look like inches"),
        (lambda p, n: (p * 0.1, n), "look like centimetres"),
        (lambda p, n: (p * 1e3, n), "look like um"),
        (lambda p, n: (p + ZERO, n), "machine coordinates: take off the zero of the part, G54"),
        (lambda p, n: (p * [-1, 1, 1] + [30, 0, 0], n * [-1, 1, 1]), "mirrored in x"),
        (lambda p, n: (p - [0, 0, 300], n), "in workpiece coordinates"),
    ],
)
def test_points_that_the_program_does_not_cut(job, tmp_path, change, hint):
    _, points, normals = pocket_points()
    points, normals = change(points, normals)
    path = file_of(tmp_path, points, normals, points)
    with pytest.raises(InputError, match=rf"measured\.csv: the program cuts \d+ of.*{hint}"):
        measure_part(job, path)


def test_measured_points_in_another_frame(job, tmp_path):
    _, points, normals = pocket_points()
    path = file_of(tmp_path, points, normals, points + ZERO)
    with pytest.raises(InputError, match=r"shifted by \(-200\.000, -150\.000, -200\.000\) mm"):
        measure_part(job, path)
    path = file_of(tmp_path, points, normals, points[:, [1, 0, 2]])
    with pytest.raises(InputError, match="mx, my, mz hold y, x, z"):
        measure_part(job, path)


def test_a_handful_of_points_is_refused_for_their_number(job, tmp_path):
    path = file_of(tmp_path, *(a[:5] for a in pocket_points()[1:]), pocket_points()[1][:5])
    with pytest.raises(InputError, match=r"5 measured points; accepted: 12 or more \(hint: the al"):
        measure_part(job, path)


@pytest.mark.parametrize(("u_um", "unit"), [(0.0005, "mm"), (8000.0, "nm")])
def test_an_uncertainty_that_no_cmm_has(job, tmp_path, u_um, unit):
    _, points, normals = pocket_points()
    path = file_of(tmp_path, points, normals, points, u_um=u_um)
    with pytest.raises(InputError, match=rf"accepted: 0\.02 to 100 um .*in {unit}\?"):
        measure_part(job, path)


def test_a_file_without_readings_is_named(job, tmp_path):
    path = tmp_path / "nominal.csv"
    path.write_text("id,x,y,z,i,j,k\n1,0,0,-8,0,0,1\n")
    with pytest.raises(
        InputError, match=r"nominal\.csv: none of the \d+ points has a measured place"
    ):
        measure_part(job, path)


def test_many_points_that_no_move_cut_raise_doubt(job, tmp_path):
    _, points, normals = pocket_points()
    for count, is_doubtful in ((2, False), (20, True)):
        raised = points.copy()
        raised[:count, 2] += 200.0
        part, _ = measure_part(job, file_of(tmp_path, raised, normals, raised))
        (note,) = (note for note in part.notes if note.kind is not Kind.CONTROL)
        assert f"no move cuts them ({count} of {len(points)})" in note.text
        assert (note.level is Level.QUESTION) == is_doubtful


def test_a_turned_sign_is_noticed(tmp_path):
    """Y strays by 20 um along X: walls that face Y follow it, or do the contrary."""

    def stray_um(x):
        return 20.0 * np.cos(2.0 * np.pi * x / 80.0)

    job = prepare(read_job(write_job(tmp_path, errors={"EYX": (stray_um, None)})))
    _, points, normals = pocket_points()
    dy = 1e-3 * stray_um(points[:, 0] + ZERO[0])
    for sign, is_noticed in ((1.0, False), (-1.0, True)):
        measured = points + (sign * dy * normals[:, 1])[:, None] * normals
        part, _ = measure_part(job, file_of(tmp_path, points, normals, measured))
        assert any("with the other sign" in str(note) for note in part.notes) == is_noticed


@pytest.mark.parametrize(("scatter_um", "is_doubtful"), [(0.5, False), (4.0, True)])
def test_points_that_scatter_more_than_u_um_raise_doubt(job, tmp_path, scatter_um, is_doubtful):
    _, points, normals = pocket_points()
    noise = scatter_um * 1e-3 * np.random.default_rng(1).normal(size=(len(points), 1))
    part, _ = measure_part(job, file_of(tmp_path, points, normals, points + noise * normals))
    assert any("is u_um too small?" in str(note) for note in part.notes) == is_doubtful


@pytest.mark.parametrize(
    ("digits", "u_um", "is_doubtful"), [(2, 0.5, True), (2, 5.0, False), (3, 0.5, False)]
)
def test_coordinates_rounded_beyond_their_uncertainty(job, tmp_path, digits, u_um, is_doubtful):
    """Rounding to a step makes an error of the step over the root of twelve."""
    _, points, normals = pocket_points()
    measured = np.round(points + 2e-3 * normals, digits)
    part, _ = measure_part(job, file_of(tmp_path, points, normals, measured, u_um=u_um))
    assert any("more digits" in str(note) for note in part.notes) == is_doubtful


def without_uncertainty(path):
    lines = [line.rsplit(",", 1)[0] for line in path.read_text().splitlines()]
    path.write_text("\n".join(lines) + "\n")
    return path


def test_readings_that_do_not_scatter_are_as_uncertain_as_the_best_machine(job, tmp_path):
    _, points, normals = pocket_points()
    path = without_uncertainty(file_of(tmp_path, points, normals, points))
    part, _ = measure_part(job, path)
    assert part.u_mm == pytest.approx(0.02e-3)


@pytest.mark.parametrize("digits", [2, 3])
def test_rounded_readings_are_as_uncertain_as_their_rounding(job, tmp_path, digits):
    _, points, normals = pocket_points()
    points = np.round(points, digits)
    path = without_uncertainty(file_of(tmp_path, points, normals, points))
    part, _ = measure_part(job, path)
    assert part.u_mm == pytest.approx(10.0**-digits / np.sqrt(12.0))
