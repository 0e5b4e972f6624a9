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


#: a block of 40 x 30 x 8 mm with its zero in a corner: its top, then all round
CORNER_PROGRAM = """\
G21 G17 G90 G94 G40
T1 M6
S6000 M3
G54 G43 H1
G0 X-10 Y0 Z5
G1 Z0 F900
X40 Y0
Y8
X0
Y16
X40
Y24
X0
Y30
X40
G0 Z5
G0 X-15 Y-5
G1 Z-9 F300
X45 F900
Y35
X-5
Y-15
G0 Z5
M30
"""


def corner_job(folder):
    path = write_job(folder)
    (folder / "part.nc").write_text(CORNER_PROGRAM)
    stock = "min_mm = [-1, -1, -20]\nmax_mm = [41, 31, 1]"
    text = path.read_text().replace("min_mm = [-30, -25, -20]\nmax_mm = [60, 25, 0]", stock)
    path.write_text(text)
    return prepare(read_job(path))


def corner_points():
    """Points and normals (69, 3): on the top, the two walls through the zero, two others."""
    rows = [((x, y, 0), (0, 0, 1)) for x in np.linspace(2, 38, 9) for y in (3, 14, 27)]
    for t in np.linspace(0.1, 0.9, 12):
        rows += [((0, 30 * t, -4), (-1, 0, 0)), ((40 * t, 0, -4), (0, -1, 0))]
    for t in np.linspace(0.1, 0.9, 9):
        rows += [((40, 30 * t, -4), (1, 0, 0)), ((40 * t, 30, -4), (0, 1, 0))]
    points, normals = zip(*rows, strict=True)
    return np.array(points, float), np.array(normals, float)


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


@pytest.mark.parametrize("along_normals", [False, True])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_another_zero_along_one_axis_is_refused(job, tmp_path, axis, along_normals):
    """Most points face another way, and agree with their nominal places."""
    _, points, normals = pocket_points()
    shift = 5.0 * np.eye(3)[axis]
    moved = points + ((normals @ shift)[:, None] * normals if along_normals else shift)
    path = file_of(tmp_path, points, normals, moved)
    told = ", ".join(f"{value:.3f}" for value in shift)
    with pytest.raises(InputError, match=rf"are 5 mm from .* shifted by \({told}\) mm"):
        measure_part(job, path)


def test_a_zero_that_is_a_little_off_changes_no_reading(job, tmp_path):
    """The pose is free: beside it readings of the shifted part are those of the part."""
    _, points, normals = pocket_points()
    noise = 5e-4 * np.random.default_rng(1).normal(size=(len(points), 1))
    left = []
    for shift in ([0.0, 0.0, 0.0], [0.3, -0.2, 0.1]):
        measured = points + noise * normals + shift
        part, _ = measure_part(job, file_of(tmp_path, points, normals, measured))
        assert len(part) == len(points)
        assert any("its pose on the measuring machine" in str(n) for n in part.notes) == any(shift)
        free = np.linalg.lstsq(part.nuisance, part.measured_mm, rcond=None)[0]
        left.append(part.measured_mm - part.nuisance @ free)
    assert left[1] == pytest.approx(left[0], abs=1e-7)


def test_few_points_astray_are_left_out_and_many_are_refused(job, tmp_path):
    _, points, normals = pocket_points()
    astray = points.copy()
    astray[::25] += 3.0 * normals[::25]
    part, _ = measure_part(job, file_of(tmp_path, points, normals, astray))
    assert len(part) == len(points) - len(points[::25])
    astray[::10] += (-1.0) ** np.arange(7)[:, None] * normals[::10]
    with pytest.raises(InputError, match=r"measured\.csv:2: .* further from the nominal surface"):
        measure_part(job, file_of(tmp_path, points, normals, astray))


def test_many_readings_apart_from_their_neighbours_stay(job, tmp_path):
    _, points, normals = pocket_points()
    apart = points.copy()
    apart[::8] += 0.2 * normals[::8]
    part, _ = measure_part(job, file_of(tmp_path, points, normals, apart))
    assert len(part) == len(points)
    assert any("too many for chips" in str(note) for note in part.notes)


@pytest.mark.parametrize(
    ("unit", "length"), [("inches", 1 / 25.4), ("centimetres", 0.1), ("metres", 1e-3)]
)
def test_another_unit_is_noticed_with_the_zero_in_a_corner(tmp_path, unit, length):
    """Faces through the zero stay where they are, so that the program cuts most of the points."""
    job = corner_job(tmp_path)
    points, normals = corner_points()
    path = file_of(tmp_path, points, normals, points)
    assert len(measure_part(job, path)[0]) == len(points)
    path = file_of(tmp_path, length * points, normals, length * points)
    said = rf"measured\.csv:\d+: the points span .* look like {unit}"
    with pytest.raises(InputError, match=said):
        measure_part(job, path)


def test_a_small_spot_of_a_face_raises_a_question_only(tmp_path):
    """Its points lie on the face in every unit."""
    job = corner_job(tmp_path)
    points, normals = corner_points()
    top = normals[:, 2] == 1.0
    path = file_of(tmp_path, 0.03 * points[top], normals[top], 0.03 * points[top])
    part, _ = measure_part(job, path)
    (note,) = (note for note in part.notes if note.kind is Kind.UNIT)
    assert note.level is Level.QUESTION and "in inches too" in note.sentence


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


def test_measured_points_far_beside_the_nominal_ones_are_asked_about(job, tmp_path):
    """Two places of a floor exchanged: their deviations say nothing of it."""
    _, points, normals = pocket_points()
    rows = np.flatnonzero(normals[:, 2] == 1.0)[[0, -1]]
    measured = points.copy()
    measured[rows] = points[rows[::-1]]
    part, _ = measure_part(job, file_of(tmp_path, points, normals, measured))
    (asked,) = (note for note in part.notes if note.kind is Kind.FAR)
    assert asked.level is Level.QUESTION and asked.size == pytest.approx(24.0 * np.hypot(1, 0.5))
    assert asked.sentence.startswith(f"2 of {len(points)} measured points lie more than 1 mm")
    part, _ = measure_part(job, file_of(tmp_path, points, normals, points))
    assert not any(note.kind is Kind.FAR for note in part.notes)
