"""Nominal CAD that cannot be used: one message that names the file and what is wrong."""

import re
from pathlib import Path

import numpy as np
import pytest
import trimesh

from vmach.base.note import Kind
from vmach.errors import InputError
from vmach.nominal import read_nominal

FEATURES = Path(__file__).parents[1] / "golden" / "cad" / "features.step"


def spoilt(tmp_path, name, data):
    path = tmp_path / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_truncated_step(tmp_path, share):
    data = FEATURES.read_bytes()
    with pytest.raises(InputError, match=r"part\.step"):
        read_nominal(spoilt(tmp_path, "part.step", data[: int(share * len(data))]))


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("empty.step", ""),
        ("text.step", "this is no STEP file\n"),
        ("nosolid.step", "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"),
        ("empty.stl", ""),
        ("text.stl", "this is no STL file\n"),
        ("cut.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
        ("part.obj", "v 0 0 0\n"),
    ],
)
def test_files_without_a_solid(tmp_path, name, data):
    with pytest.raises(InputError, match=name.replace(".", r"\.")):
        read_nominal(spoilt(tmp_path, name, data))


def test_every_damaged_line_of_a_step_file_is_survived(tmp_path):
    lines = FEATURES.read_text().splitlines(keepends=True)
    rng = np.random.default_rng(7)
    for row in rng.choice(np.arange(20, len(lines) - 3), 25, replace=False):
        damaged = "".join(
            [*lines[:row], lines[row].replace("(", "(#999999,", 1), *lines[row + 1 :]]
        )
        try:
            read_nominal(spoilt(tmp_path, "part.step", damaged))
        except InputError as error:
            assert "part.step" in str(error)


def export(mesh, tmp_path):
    path = tmp_path / "part.stl"
    mesh.export(path)
    return path


def test_open_mesh(tmp_path):
    box = trimesh.creation.box((10, 20, 30))
    box.update_faces(np.arange(len(box.faces)) > 0)
    with pytest.raises(InputError, match="the mesh is open: 3 of"):
        read_nominal(export(box, tmp_path))


def test_twisted_mesh(tmp_path):
    box = trimesh.creation.box((10, 20, 30))
    box.faces[0] = box.faces[0][::-1]
    with pytest.raises(InputError, match="disagree on what is outside"):
        read_nominal(export(box, tmp_path))


def test_mesh_that_cuts_through_itself(tmp_path):
    one = trimesh.creation.box((10, 10, 10))
    other = trimesh.creation.box((10, 10, 10))
    other.apply_translation((3, 4, 5))
    with pytest.raises(InputError, match="cuts through itself"):
        read_nominal(export(trimesh.util.concatenate([one, other]), tmp_path))


def test_mesh_inside_out_is_turned_and_said(tmp_path):
    box = trimesh.creation.box((10, 20, 30))
    box.invert()
    part = read_nominal(export(box, tmp_path))
    assert part.mesh.volume_mm3 == pytest.approx(6000)
    assert any(note.kind is Kind.INSIDE_OUT for note in part.notes)


def test_box_has_six_flat_regions_and_no_chord_error(tmp_path):
    part = read_nominal(export(trimesh.creation.box((10, 20, 30)), tmp_path))
    assert [face.kind for face in part.faces] == ["plane"] * 6
    assert part.chord_error_mm == 0.0
    points = part.sample(1.0, edge_margin_mm=0.5)
    inner = np.sort(np.abs(points.point_mm) - [5, 10, 15], axis=1)
    assert inner[:, 2] == pytest.approx(0, abs=1e-5)  # on a face, to 32 bits
    assert inner[:, 1].max() <= -0.5 + 1e-6  # away from the edges


@pytest.mark.parametrize("sections", [24, 64, 200])
def test_chord_error_of_a_facetted_cylinder(tmp_path, sections):
    part = read_nominal(export(trimesh.creation.cylinder(20, 30, sections=sections), tmp_path))
    sagitta = 20 * (1 - np.cos(np.pi / sections))
    assert part.chord_error_mm == pytest.approx(sagitta, rel=0.1)


def test_too_many_points(tmp_path):
    part = read_nominal(export(trimesh.creation.box((1000, 1000, 1000)), tmp_path))
    with pytest.raises(InputError, match="accepted: at most"):
        part.sample(0.01)


def test_a_face_that_its_edges_do_not_bound_is_refused(tmp_path):
    """One closed edge runs the other way: the faces on it would go on for ever."""
    text = FEATURES.with_name("revolved.step").read_text()
    assert "EDGE_CURVE('',#22,#22,#24,.T.)" in text
    turned = text.replace("EDGE_CURVE('',#22,#22,#24,.T.)", "EDGE_CURVE('',#22,#22,#24,.F.)")
    with pytest.raises(InputError, match=r"face \d+: its edges do not bound it on its surface"):
        read_nominal(spoilt(tmp_path, "part.step", turned))


def test_a_point_with_a_reference_for_a_number_is_refused(tmp_path):
    text = FEATURES.with_name("loft.step").read_text()
    point = "(20.,-1.101815365161E-14,0.)"
    assert point in text
    part = spoilt(tmp_path, "part.step", text.replace(point, "(20.,-1.101815365161E-14,#114)", 1))
    with pytest.raises(InputError, match="a CARTESIAN_POINT with three numbers"):
        read_nominal(part)


def test_a_radius_with_a_reference_for_a_number_is_refused(tmp_path):
    text = FEATURES.with_name("nut.step").read_text()
    circle = "CIRCLE('',#375,6.)"
    assert circle in text
    part = spoilt(tmp_path, "part.step", text.replace(circle, "CIRCLE('',#375,#6)", 1))
    with pytest.raises(InputError, match="#6, in the place of a number"):
        read_nominal(part)


KNOTS = "(4,1,1,4),(0.,5.830951894845,13.893209643144,\n    22.437213388461)"
ROW = "(#35,#36,#37,#38,#39,#40,#41)"


@pytest.mark.parametrize(
    ("name", "right", "wrong", "said"),
    [
        ("revolved", "(4,1,1,4)", "(4,1,1000000000,4)", "1000000009 knots in place of 10"),
        ("revolved", "(4,1,1,4)", f"(4,1,{10**40},4)", "entity #32 cannot be parsed"),
        ("revolved", "(4,1,1,4)", "(4,1,-1,4)", "multiplicities that are not 4 whole numbers"),
        ("revolved", "22.437213388461", "1.E999", "knots from 0 to inf, which do not increase"),
        ("revolved", KNOTS, "(1,4,4,1),(0.,1.,2.,3.)", "it jumps at 1"),
        ("revolved", "'',3,(#33", "'',3.,(#33", "degree 3.0"),
        ("revolved", "'',3,(#33", "'',900000000,(#33", "6 control points of degree 900000000"),
        ("revolved", "(10.,0.,0.)", f"(1{'0' * 400},0.,0.)", "cannot be parsed"),
        ("nurbs_torus", "8.377580409573),.U", "1.E999),.U", "to inf, which do not increase"),
        ("nurbs_torus", ROW, "(#35,#36)", "rows of control points that are not equally long"),
        ("nurbs_torus", "CURVE((1.,0.5,1.,0.5", "CURVE((1.,0.5", "5 weights for 7 control points"),
        ("nurbs_torus", "CURVE((1.,0.5", "CURVE((1.,-0.5", "weights from -0.5 on"),
    ],
)
def test_splines_that_cannot_be(tmp_path, name, right, wrong, said):
    text = FEATURES.with_name(f"{name}.step").read_text()
    assert right in text
    with pytest.raises(InputError) as refused:
        read_nominal(spoilt(tmp_path, "part.step", text.replace(right, wrong)))
    assert said in str(refused.value) and "part.step:" in str(refused.value)


INCH = """#9001=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#9002);
#9002=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
ENDSEC;
END-ISO"""
MILLIMETRE = "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )"


@pytest.mark.parametrize("factor", ["0.", "-25.4", "1.E999", "'x'", "#9002"])
def test_a_unit_that_is_no_multiple_is_refused(tmp_path, factor):
    text = FEATURES.with_name("nut.step").read_text()
    inch = "(CONVERSION_BASED_UNIT('INCH',#9001)LENGTH_UNIT()NAMED_UNIT(*))"
    text = text.replace(MILLIMETRE, inch).replace("ENDSEC;\nEND-ISO", INCH.format(factor))
    with pytest.raises(InputError, match=r"part\.step:\d+: #9001 .*(number|times)"):
        read_nominal(spoilt(tmp_path, "part.step", text))


def test_a_unit_of_something_else_is_refused(tmp_path):
    text = FEATURES.with_name("nut.step").read_text()
    wrong = text.replace(MILLIMETRE, MILLIMETRE.replace("METRE", "SECOND"))
    with pytest.raises(InputError, match="the unit SECOND; accepted: METRE"):
        read_nominal(spoilt(tmp_path, "part.step", wrong))


@pytest.mark.parametrize(
    ("kind", "radius", "said"),
    [
        ("TOROIDAL", "0.1", "its edges lie up to 1.9 mm off its torus"),
        ("CYLINDRICAL", "5.", "off its cylinder R5"),
        ("CYLINDRICAL", "1.E-300", "off its cylinder R1e-300"),
        ("CYLINDRICAL", "1.E308", "a length of 1e+308 mm"),
    ],
)
def test_edges_that_lie_off_their_face_are_refused(tmp_path, kind, radius, said):
    """A radius that is wrong gave a wrong face without a word."""
    wrong = re.sub(
        rf"({kind}_SURFACE\('',#\d+,)[\d.]+", rf"\g<1>{radius}", FEATURES.read_text(), count=1
    )
    with pytest.raises(InputError) as refused:
        read_nominal(spoilt(tmp_path, "part.step", wrong))
    assert said in str(refused.value)


def test_edges_a_little_off_their_face_are_said(tmp_path):
    wrong = FEATURES.read_text().replace("#543,3.)", "#543,3.01)")
    (note,) = [
        n for n in read_nominal(spoilt(tmp_path, "p.step", wrong)).notes if n.kind is Kind.GAP
    ]
    assert "edges of the CAD miss their faces by up to 10 um" in str(note)


def test_a_byte_order_mark_is_passed_over(tmp_path):
    marked = spoilt(tmp_path, "part.step", b"\xef\xbb\xbf" + FEATURES.read_bytes())
    assert len(read_nominal(marked).faces) == 26
