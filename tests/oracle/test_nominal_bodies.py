"""Files with more than the solid in them, against another kernel's figures (make_bodies.py)."""

from pathlib import Path

import numpy as np
import pytest

from vmach.errors import InputError
from vmach.nominal import read_nominal

CAD = Path(__file__).parents[1] / "golden" / "cad"

#: faces, volume in mm3 and area in mm2 by OCP; closed forms of block, bore and steps say the same
FACTS = {
    "surfaces": (7, 30 * 20 * 10 - np.pi * 4**2 * 10, 2350.79644737231),
    "touching": (13, 3000.0, 1600.0),
}


@pytest.mark.parametrize("name", FACTS)
def test_figures_of_the_solid(name):
    faces, volume, area = FACTS[name]
    part = read_nominal(CAD / f"{name}.step")
    assert len(part.faces) == faces
    assert part.mesh.volume_mm3 == pytest.approx(volume, rel=2e-4)
    assert sum(face.area_mm2 for face in part.faces) == pytest.approx(area, rel=2e-4)


def test_surfaces_beside_the_solid_are_left_aside_and_said():
    part = read_nominal(CAD / "surfaces.step")
    assert part.bounds_mm == pytest.approx(np.array([[0, 0, 0], [30, 20, 10]]))
    assert tuple(map(str, part.notes)) == (
        "left aside beside the solid: 2 surface models, the first #474 in line 559",
    )


def test_a_solid_that_touches_itself_is_said():
    part = read_nominal(CAD / "touching.step")
    assert tuple(map(str, part.notes)) == ("the solid touches itself along 1 edge",)
    points = part.sample(1.0)
    assert len(points.id) == pytest.approx(1600, rel=0.02)


def test_surfaces_without_a_solid_are_still_open(tmp_path):
    text = (CAD / "surfaces.step").read_text().replace("MANIFOLD_SOLID_BREP", "ELLIPSE")
    path = tmp_path / "part.step"
    path.write_text(text.replace("CLOSED_SHELL", "OPEN_SHELL"))
    part = read_nominal(path)  # the ball encloses a volume, whatever its shell is called
    assert part.mesh.volume_mm3 == pytest.approx(4 / 3 * np.pi * 5**3, rel=1e-2)
    path.write_text(text.replace("CLOSED_SHELL", "CIRCLE"))
    with pytest.raises(InputError, match=r"part\.step:\d+: "):
        read_nominal(path)


def test_parts_in_other_files_are_named():
    with pytest.raises(InputError, match=r"lie in other files, base\.stp, cover\.stp"):
        read_nominal(CAD / "elsewhere.step")


def with_lines(tmp_path, name, *lines):
    text = (CAD / f"{name}.step").read_text()
    path = tmp_path / "part.step"
    path.write_text(text.replace("ENDSEC;\nEND", "\n".join([*lines, "ENDSEC;", "END"])))
    return path


def instance(name, kind):
    text = (CAD / f"{name}.step").read_text().replace("\n", "")
    return next(
        part.split("=")[0]
        for part in text.split(";")
        if f"= {kind}(" in part or f"={kind}(" in part
    )


def test_a_solid_listed_twice_is_one(tmp_path):
    solid = instance("nut", "MANIFOLD_SOLID_BREP").strip()
    text = (CAD / "nut.step").read_text().replace("\n", "")
    shape = next(part for part in text.split(";") if "ADVANCED_BREP_SHAPE_REPRESENTATION(" in part)
    context = shape.rsplit("#", 1)[1].rstrip(")")
    path = with_lines(
        tmp_path,
        "nut",
        f"#90001=SHAPE_REPRESENTATION('volume of the solid',({solid}),#{context});",
        f"#90002=REPRESENTATION_MAP({solid},{shape.split('=')[0].strip()});",
        "#90003=MAPPED_ITEM('',#90002,$);",
        f"#90004=(DRAUGHTING_MODEL() REPRESENTATION('view',(#90003),#{context}) "
        "SHAPE_REPRESENTATION());",
    )
    part, once = read_nominal(path), read_nominal(CAD / "nut.step")
    assert len(part.faces) == len(once.faces)
    assert part.mesh.volume_mm3 == once.mesh.volume_mm3


def test_a_face_given_twice_is_refused(tmp_path):
    text = (CAD / "touching.step").read_text()
    first, second = text.split("CLOSED_SHELL('',(")[1].split(")")[0].split(",")[:2]
    path = tmp_path / "part.step"
    path.write_text(text.replace(f"({first},{second}", f"({first},{first},{second}", 1))
    with pytest.raises(InputError, match="same edges"):
        read_nominal(path)
