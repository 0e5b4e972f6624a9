"""Meshes that are closed and yet no solid, parts in another unit, and coordinates astray."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh

from vmach.errors import InputError
from vmach.job import read_job
from vmach.nominal import read_nominal
from vmach.nominal.mesh.mesh_solidity import winding_numbers
from vmach.run.inspection import check_nominal_in_blank

SAMPLES = Path(__file__).parents[2] / "samples"
PLATE = SAMPLES / "freecad_pocket"


def box(size=(10.0, 20.0, 30.0), at=(0.0, 0.0, 0.0)):
    mesh = trimesh.creation.box(size)
    mesh.apply_translation(at)
    return mesh


def turned(mesh):
    mesh = mesh.copy()
    mesh.invert()
    return mesh


def finer(mesh):
    return trimesh.Trimesh(*trimesh.remesh.subdivide(mesh.vertices, mesh.faces))


def flat(mesh):
    mesh.vertices[:, 2] = 0.0
    return mesh


NO_SOLIDS = {
    "every triangle twice": ([box(), box()], "occur more than once"),
    "a surface and its reverse": ([box(), turned(box())], "occur more than once"),
    "twice, in other triangles": ([box(), finer(box())], "times behind it"),
    "reverse in other triangles": ([box(), turned(finer(box()))], "no volume"),
    "flattened": ([flat(finer(box()))], "more than once|no volume"),
    "nested with the same sense": ([box(), box((2, 2, 2))], "2 times behind it and 1 times"),
    "one body inside out": (
        [box(), turned(box((5, 5, 5), (50, 0, 0)))],
        "0 times behind it and -1 times",
    ),
    "coplanar overlap": ([box(), box((10, 20, 30), (0, 5, 0))], "2 times behind"),
    "a wall shared in part": ([box(), box((6, 4, 4), (8, 0, 0))], "lies on itself"),
}


@pytest.mark.parametrize("case", NO_SOLIDS)
def test_a_closed_mesh_that_is_no_solid_is_refused(tmp_path, case):
    meshes, match = NO_SOLIDS[case]
    path = tmp_path / "part.stl"
    trimesh.util.concatenate(meshes).export(path)
    with pytest.raises(InputError, match=match):
        read_nominal(path)


def test_voids_and_separate_bodies_are_solids(tmp_path):
    path = tmp_path / "part.stl"
    bodies = [box(), turned(box((2, 2, 2))), box((3, 3, 3), (40, 0, 0))]
    trimesh.util.concatenate(bodies).export(path)
    assert read_nominal(path).mesh.volume_mm3 == pytest.approx(6000 - 8 + 27, rel=1e-6)


def test_winding_numbers_of_a_sphere_in_a_box():
    ball = trimesh.creation.icosphere(radius=2.0)
    corners = trimesh.util.concatenate([box(), turned(ball)]).triangles
    points = np.array([[0.0, 0, 0], [4.0, 0, 0], [6.0, 0, 0], [0, 9.9, 14.9]])
    assert winding_numbers(points, corners) == pytest.approx([0, 1, 0, 1], abs=1e-9)


def spoil(vertices, count, value):
    vertices[:count] = value
    return vertices


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (lambda v: spoil(v, 1, 1e9), "points of the part lie outside"),
        (lambda v: spoil(v, len(v), 1e30), "points of the part lie outside"),
        (lambda v: spoil(v, len(v), 3.0), "triangles are degenerate"),
    ],
)
def test_coordinates_astray_and_degenerate_triangles(tmp_path, change, match):
    mesh = box()
    corners = change(mesh.triangles.reshape(-1, 3).copy())
    path = tmp_path / "part.stl"
    loose = trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False)
    loose.export(path)
    with pytest.raises(InputError, match=match):
        read_nominal(path)


def test_a_step_part_of_a_thousand_kilometres_is_refused(tmp_path):
    text = (PLATE / "part.step").read_text().replace(".MILLI.,.METRE.", ".KILO.,.METRE.")
    path = tmp_path / "part.step"
    path.write_text(text)
    with pytest.raises(InputError, match="points of the part lie outside"):
        read_nominal(path)


def without_unit(tmp_path):
    text = (PLATE / "part.step").read_text()
    start = text.index("( LENGTH_UNIT()")
    end = text.index(";", start)
    path = tmp_path / "part.step"
    angle = "( PLANE_ANGLE_UNIT() NAMED_UNIT(*) SI_UNIT($,.RADIAN.) )"
    path.write_text(text[:start] + angle + text[end:])
    return path


def test_a_step_file_without_a_unit_of_length_asks_for_it(tmp_path):
    path = without_unit(tmp_path)
    with pytest.raises(InputError, match=r"names no unit of length.*nominal_unit"):
        read_nominal(path)
    right = np.asarray(read_nominal(PLATE / "part.step").bounds_mm)
    assert read_nominal(path, "mm").bounds_mm == pytest.approx(right)
    assert read_nominal(path, "inch").bounds_mm == pytest.approx(25.4 * right)


def test_a_step_solid_that_is_listed_twice_counts_once(tmp_path):
    text = (PLATE / "part.step").read_text()
    start = text.index("ADVANCED_BREP_SHAPE_REPRESENTATION")
    first = text.index("MANIFOLD_SOLID_BREP")
    number = text[text.rindex("#", 0, first) : first].split("=")[0].strip()
    items = text.index(number, start)
    path = tmp_path / "part.step"
    path.write_text(text[:items] + number + "," + text[items:])
    once = read_nominal(PLATE / "part.step").mesh.volume_mm3
    assert read_nominal(path).mesh.volume_mm3 == pytest.approx(once, rel=1e-9)


def test_a_step_solid_in_another_one_is_refused(tmp_path):
    text = (PLATE / "part.step").read_text()
    start = text.index("ADVANCED_BREP_SHAPE_REPRESENTATION")
    first = text.index("MANIFOLD_SOLID_BREP")
    number = text[text.rindex("#", 0, first) : first].split("=")[0].strip()
    items = text.index(number, start)
    solid = text[first : text.index(";", first) + 1]
    text = text[:items] + number + ",#999999" + text[items + len(number) :]
    path = tmp_path / "part.step"
    path.write_text(text.replace("ENDSEC;\nEND-ISO", f"#999999 = {solid}\nENDSEC;\nEND-ISO"))
    with pytest.raises(InputError, match="2 times behind it"):
        read_nominal(path)


def test_a_unit_that_contradicts_the_step_file_is_refused():
    with pytest.raises(InputError, match=r"nominal_unit 25\.4 mm"):
        read_nominal(PLATE / "part.step", "inch")


def plate_job(tmp_path, scale, unit=None):
    """The sample with its STL scaled."""
    shutil.copytree(SAMPLES / "iso10791_7", tmp_path / "iso10791_7")
    folder = shutil.copytree(PLATE, tmp_path / "plate")
    mesh = trimesh.load(PLATE / "part.stl")
    mesh.apply_scale(scale)
    mesh.export(folder / "part.stl")
    text = (folder / "job.toml").read_text().replace("part.step", "part.stl")
    said = "" if unit is None else f'nominal_unit = "{unit}"\n'
    (folder / "job.toml").write_text(text.replace("program =", said + "program =", 1))
    return read_job(folder)


@pytest.mark.parametrize("scale", [1e-3, 1 / 25.4, 0.1])
def test_a_part_in_another_unit_is_asked_for(tmp_path, scale):
    job = plate_job(tmp_path, scale)
    with pytest.raises(InputError, match="nominal_unit"):
        check_nominal_in_blank(job, read_nominal(job.nominal, job.nominal_unit))


@pytest.mark.parametrize("scale", [25.4, 1000.0])
def test_a_part_in_smaller_units_stands_out_of_the_stock(tmp_path, scale):
    job = plate_job(tmp_path, scale)
    with pytest.raises(InputError, match=r"out of the stock|lie outside"):
        check_nominal_in_blank(job, read_nominal(job.nominal, job.nominal_unit))


def test_a_part_whose_unit_is_said_is_read(tmp_path):
    job = plate_job(tmp_path, 1 / 25.4, "inch")
    part = read_nominal(job.nominal, job.nominal_unit)
    check_nominal_in_blank(job, part)
    assert np.ptp(part.bounds_mm, axis=0)[0] == pytest.approx(100, rel=0.3)


def chamfered_plate(tmp_path, leg=1.0):
    """A plate of 60 x 40 x 10 mm with a chamfer along the upper edge at x = 0."""
    plate = trimesh.creation.box(bounds=[[0, 0, 0], [60, 40, 10]])
    wedge = np.array([[-1, -1, 10 - leg - 1], [leg + 1, -1, 11], [-1, -1, 11]], float)
    wedge = trimesh.convex.convex_hull(np.vstack([wedge, wedge + np.array([0, 42, 0])]))
    path = tmp_path / "part.stl"
    trimesh.boolean.difference([plate, wedge], engine="manifold").export(path)
    return path


def test_a_narrow_region_has_rows_near_both_long_edges_and_between(tmp_path):
    part = read_nominal(chamfered_plate(tmp_path))
    points = part.sample(2.0, edge_margin_mm=0.1)
    on = np.abs(points.normal @ [-np.sqrt(0.5), 0, np.sqrt(0.5)] - 1.0) < 1e-6
    down = (10.0 - points.point_mm[on, 2]) * np.sqrt(2.0)  # along the chamfer, 0 to 1.414 mm
    # the rows keep one and a half margins, points between them one
    for edge in (down.min(), np.sqrt(2.0) - down.max()):
        assert 0.1 - 1e-4 < edge < 0.15 + 1e-4
    for row in (down < 0.2, down > 1.2):
        y = np.sort(points.point_mm[on][row, 1])
        assert len(y) >= 15
        assert np.diff(np.r_[0.0, y, 40.0]).max() < 6.0
    assert ((down > 0.3) & (down < 1.1)).sum() >= 5
    # nothing off the face: every point of the chamfer has x + (10 - z) = 1
    assert points.point_mm[on] @ [1, 0, -1] + 9.0 == pytest.approx(0.0, abs=1e-5)


def test_narrow_faces_of_step_have_points_near_both_edges():
    part = read_nominal(Path(__file__).parents[1] / "golden" / "cad" / "features.step")
    with pytest.raises(InputError, match="spacing 1e-300 mm; accepted: 1e-09 mm or more"):
        part.sample(1e-300)
    points = part.sample(8.0, edge_margin_mm=0.1)
    for name in ("face 3 cylinder R2", "face 16 cylinder R2"):
        face = next(face for face in part.faces if face.name == name)
        at = points.point_mm[points.feature == name]
        uv = face.surface.parameters(at)
        across = np.mod(uv[:, 0] - uv[:, 0].min(), 2 * np.pi) * 2.0  # radius 2 mm
        away = np.linalg.norm(at[:, None] - face.trim.segments_mm.mean(axis=1)[None], axis=2)
        assert away.min() >= 0.1
        assert np.unique(np.round(across, 3)).size >= 3
