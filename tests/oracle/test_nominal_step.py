"""STEP solids against closed forms and against the figures of FreeCAD's kernel (OCCT)."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from vmach.nominal import read_nominal

FEATURES = Path(__file__).parents[1] / "golden" / "cad" / "features.step"
SAMPLE = Path(__file__).parents[2] / "samples" / "iso10791_7"

#: FreeCAD 0.20: Volume and Area of the solid that make_features.py made
VOLUME_MM3, AREA_MM2 = 45345.982855192284, 9889.103810699065


@pytest.fixture(scope="module")
def part():
    return read_nominal(FEATURES)


@pytest.fixture(scope="module")
def points(part):
    return part.sample(1.0, edge_margin_mm=0.1)


def from_axis(points, at, direction=(0, 0, 1)):
    """Distance of points from an axis."""
    direction = np.array(direction) / np.linalg.norm(direction)
    arm = points - np.array(at, float)
    return np.linalg.norm(arm - np.outer(arm @ direction, direction), axis=1)


def distance_from_surface(name, p):
    """Distance of points from the surface that was drawn, told by the face's name."""
    if "sphere R6" in name:
        return np.linalg.norm(p - [-15, 0, 2], axis=1) - 6
    if "torus R5" in name:
        return np.hypot(from_axis(p, (0, 12, 0)) - 5, p[:, 2]) - 1.5
    if "cylinder R3" in name:
        return from_axis(p, (12, 0, 0)) - 3
    if "cylinder R2.5" in name:
        return from_axis(p, (-50, 8, -12), (1, 0.1, 0)) - 2.5
    if "cylinder R4" in name:
        return from_axis(np.abs(p), (26, 16, 0)) - 4
    if "cone" in name:  # radius 5 at z = -8, 2 at z = 0
        off = from_axis(p, (12, 0, 0)) - (2 - 3 * p[:, 2] / 8)
        return off * np.cos(np.arctan(3 / 8))
    if "torus R2" in name:  # rolling fillet at the corners: centres 2 from the corner's axis
        return np.hypot(from_axis(np.abs(p), (26, 16, 0)) - 2, p[:, 2] + 2) - 2
    return None


def test_samples_lie_on_the_drawn_surfaces(points):
    checked = set()
    for name in np.unique(points.feature):
        off = distance_from_surface(str(name), points.point_mm[points.feature == name])
        if off is not None:
            checked.add(name.split()[2])
            assert np.abs(off).max() < 1e-9, name
    assert checked == {"sphere", "torus", "cylinder", "cone"}


def test_planes_are_flat_and_their_normals_square_to_them(points):
    planes = [n for n in np.unique(points.feature) if n.endswith("plane")]
    assert len(planes) >= 6
    for name in planes:
        mine = points.feature == name
        (normal,) = np.unique(points.normal[mine].round(12), axis=0)
        assert np.ptp(points.point_mm[mine] @ normal) < 1e-9


def test_normals_point_out_of_the_material(part, points):
    for step, inside in ((0.02, False), (-0.02, True)):
        moved = points.point_mm + step * points.normal
        assert (is_inside(part, moved) == inside).all()


def is_inside(part, p):
    """Whether points are in the solid, from how it was drawn."""
    x, y, z = np.abs(p[:, 0]), np.abs(p[:, 1]), p[:, 2]
    corner = np.hypot(np.maximum(x - 26, 0), np.maximum(y - 16, 0))
    inward = np.minimum(np.minimum(30 - x, 20 - y), np.where(corner > 0, 4 - corner, np.inf))
    block = (inward > 0) & (z > -20) & (z < 0)
    edge = np.hypot(np.maximum(2 - inward, 0), np.maximum(z + 2, 0)) > 2
    holes = np.linalg.norm(p - [-15, 0, 2], axis=1) < 6
    holes |= np.hypot(from_axis(p, (0, 12, 0)) - 5, z) < 1.5
    holes |= from_axis(p, (12, 0, 0)) < 3
    holes |= from_axis(p, (-50, 8, -12), (1, 0.1, 0)) < 2.5
    holes |= (from_axis(p, (12, 0, 0)) < 2 - 3 * z / 8) & (z > -8)
    return block & ~edge & ~holes


def test_area_and_volume_of_the_other_kernel(part):
    # the mesh keeps its chord error; areas are those of the mesh
    assert part.mesh.volume_mm3 == pytest.approx(VOLUME_MM3, rel=1e-3)
    assert sum(face.area_mm2 for face in part.faces) == pytest.approx(AREA_MM2, rel=1e-3)
    mesh = trimesh.Trimesh(part.mesh.vertices_mm, part.mesh.triangles)
    assert mesh.is_watertight
    assert part.chord_error_mm == 0.0


def test_spacing_is_kept_and_every_face_covered(part, points):
    assert len(points) == pytest.approx(AREA_MM2, rel=0.1)  # one point a square millimetre
    assert set(points.feature) == {face.name for face in part.faces}
    fine, coarse = (part.sample(s) for s in (0.5, 2.0))
    assert 12 < len(fine) / len(coarse) < 20


def test_sampling_is_the_same_every_time(part):
    one, other = part.sample(1.7), read_nominal(FEATURES).sample(1.7)
    assert np.array_equal(one.point_mm, other.point_mm)
    assert np.array_equal(one.normal, other.normal)


def test_margin_to_the_edges(part):
    points = part.sample(1.0, edge_margin_mm=1.0)
    bore = np.char.startswith(points.feature, "face") & (
        np.abs(from_axis(points.point_mm, (12, 0, 0)) - 3) < 1e-9
    )
    z = points.point_mm[bore, 2]
    assert z.min() > -20 + 1.0 - 1e-9  # the bore's lower edge


def test_step_and_stl_of_the_sample_are_the_same_part():
    step, stl = (read_nominal(SAMPLE / f"part.{ending}") for ending in ("step", "stl"))
    assert step.bounds_mm == pytest.approx(stl.bounds_mm, abs=1e-5)
    assert step.mesh.volume_mm3 == pytest.approx(stl.mesh.volume_mm3, rel=1e-4)


@pytest.mark.parametrize(
    ("unit", "mm"), [("SI_UNIT(.CENTI.,.METRE.)", 10.0), ("SI_UNIT(.MICRO.,.METRE.)", 1e-3)]
)
def test_units_of_length(tmp_path, unit, mm):
    text = (SAMPLE / "part.step").read_text()
    assert "SI_UNIT(.MILLI.,.METRE.)" in text
    path = tmp_path / "scaled.step"
    path.write_text(text.replace("SI_UNIT(.MILLI.,.METRE.)", unit))
    expected = mm * np.asarray(read_nominal(SAMPLE / "part.step").bounds_mm)
    assert read_nominal(path).bounds_mm == pytest.approx(expected, rel=1e-9)
