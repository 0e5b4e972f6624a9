"""Tolerances in a STEP file: entities written here by the standard's schema, read and evaluated.

The parts of the NIST PMI validation project (CTC 1 to 5, FTC 6 to 11) read too; their files are
not part of this project.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from vmach.errors import InputError
from vmach.nominal import read_nominal
from vmach.nominal.step.exchange_file import StepFile
from vmach.nominal.step.pmi import read_pmi
from vmach.run.pmi_drawing import pmi_drawing

PART = Path(__file__).parents[2] / "samples" / "iso10791_7" / "part.step"

#: numbers of faces in the sample's file
TOP, BORE, CIRCLE, SIDE, BLIND = 867, 691, 1103, 490, (1501, 1556, 1611, 1774)

#: as CAD systems write it: one simple and three complex tolerances, sizes with all kinds of limits
TOLD = f"""
#9001=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#9002=(CONVERSION_BASED_UNIT('inch',#9003)LENGTH_UNIT()NAMED_UNIT(*));
#9003=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#9001);
#9010=SHAPE_ASPECT('top face','',#4,.T.);
#9011=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#9010,#10,#{TOP});
#9012=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.02),#9001);
#9013=FLATNESS_TOLERANCE('Flatness.1','',#9012,#9010);
#9020=DATUM_FEATURE('datum feature A','',#4,.T.);
#9021=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#9020,#10,#{TOP});
#9022=DATUM('',$,#4,.F.,'A');
#9023=SHAPE_ASPECT_RELATIONSHIP('','',#9020,#9022);
#9030=DATUM_FEATURE('','',#4,.T.);
#9031=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#9030,#10,#{BORE});
#9032=DATUM('',$,#4,.F.,'B');
#9033=SHAPE_ASPECT_RELATIONSHIP('','',#9030,#9032);
#9040=DATUM_REFERENCE_COMPARTMENT('',$,#4,.F.,#9022,$);
#9041=DATUM_REFERENCE_COMPARTMENT('',$,#4,.F.,#9032,$);
#9042=DATUM_SYSTEM('',$,#4,.F.,(#9040,#9041));
#9050=COMPOSITE_SHAPE_ASPECT('four bores','',#4,.F.);
#9051=SHAPE_ASPECT('bore','',#4,.T.);
#9052=SHAPE_ASPECT('bore','',#4,.T.);
#9053=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#9051,#10,(#{BLIND[0]},#{BLIND[1]}));
#9054=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#9052,#10,(#{BLIND[2]},#{BLIND[3]}));
#9055=SHAPE_ASPECT_RELATIONSHIP('','',#9050,#9051);
#9056=SHAPE_ASPECT_RELATIONSHIP('','',#9050,#9052);
#9057=(LENGTH_MEASURE_WITH_UNIT()MEASURE_REPRESENTATION_ITEM()
MEASURE_WITH_UNIT(LENGTH_MEASURE(0.002),#9002)REPRESENTATION_ITEM(''));
#9058=(GEOMETRIC_TOLERANCE('Position.1','',#9057,#9050)
GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE((#9042))POSITION_TOLERANCE());
#9059=TOLERANCE_ZONE('','',#4,.F.,(#9058),#9060);
#9060=TOLERANCE_ZONE_FORM('cylindrical or circular');
#9061=(GEOMETRIC_TOLERANCE('Position.2','',#9012,#9051)
GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE((#9042))
GEOMETRIC_TOLERANCE_WITH_MODIFIERS((.MAXIMUM_MATERIAL_REQUIREMENT.))POSITION_TOLERANCE());
#9070=SHAPE_ASPECT('boss','',#4,.T.);
#9071=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#9070,#10,#{CIRCLE});
#9072=DIMENSIONAL_SIZE(#9070,'diameter');
#9073=(LENGTH_MEASURE_WITH_UNIT()MEASURE_REPRESENTATION_ITEM()
MEASURE_WITH_UNIT(POSITIVE_LENGTH_MEASURE(100.),#9001)REPRESENTATION_ITEM('nominal value'));
#9074=SHAPE_DIMENSION_REPRESENTATION('',(#9073),#42);
#9075=DIMENSIONAL_CHARACTERISTIC_REPRESENTATION(#9072,#9074);
#9076=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(-0.02),#9001);
#9077=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.01),#9001);
#9078=TOLERANCE_VALUE(#9076,#9077);
#9079=PLUS_MINUS_TOLERANCE(#9078,#9072);
#9080=DIMENSIONAL_SIZE(#9030,'diameter');
#9081=(LENGTH_MEASURE_WITH_UNIT()MEASURE_REPRESENTATION_ITEM()
MEASURE_WITH_UNIT(POSITIVE_LENGTH_MEASURE(30.),#9001)REPRESENTATION_ITEM('nominal value'));
#9082=SHAPE_DIMENSION_REPRESENTATION('',(#9081),#42);
#9083=DIMENSIONAL_CHARACTERISTIC_REPRESENTATION(#9080,#9082);
#9084=LIMITS_AND_FITS('H','','7','');
#9085=PLUS_MINUS_TOLERANCE(#9084,#9080);
"""


def write(folder: Path, told: str = TOLD) -> Path:
    """The sample's CAD with tolerances."""
    text = PART.read_text()
    at = text.rindex("ENDSEC;")
    path = folder / "part.step"
    path.write_text(text[:at] + told + text[at:])
    return path


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    return read_nominal(write(tmp_path_factory.mktemp("pmi")))


def test_every_tolerance_is_read_with_zone_datums_modifiers_and_faces(told):
    found = {one.name: one for one in told.pmi.tolerances}
    flat, position, second = found["Flatness.1"], found["Position.1"], found["Position.2"]
    assert (flat.characteristic, flat.value_mm, flat.faces) == ("flatness", 0.02, (TOP,))
    assert position.value_mm == pytest.approx(0.0508)  # 2 thou
    assert (position.zone, position.datums, position.faces) == ("Ø", ("A", "B"), BLIND)
    assert second.modifiers == ("MAXIMUM_MATERIAL_REQUIREMENT",)
    assert second.faces == BLIND[:2]


def test_datums_and_sizes_are_read(told):
    assert {d.letter: d.faces for d in told.pmi.datums} == {"A": (TOP,), "B": (BORE,)}
    boss, bore = told.pmi.dimensions
    assert (boss.nominal, boss.lower, boss.upper) == pytest.approx((100.0, 99.98, 100.01))
    assert (bore.nominal, bore.fit) == (30.0, "H7")


def test_the_cad_speaks_the_drawing_s_language(told):
    drawing = pmi_drawing(told, ())
    asked = {(r.feature, r.callout.text): r for r in drawing.requirements}
    assert ("top face", "flatness 0.02") in asked
    assert ("face 18 cylinder R50", "100 +0.01 -0.02") in asked or (
        "boss", "100 +0.01 -0.02") in asked  # fmt: skip
    refused = [r.refused for r in drawing.requirements if r.refused]
    assert refused == ["maximum material requirement: not evaluated"]
    assert drawing.features[drawing.datums["A"]] == ("face 13 plane",)


def test_one_letter_twice_is_the_datum_of_its_faces(tmp_path):
    """ISO 5459 writes A-A for the common datum of several faces with the letter A."""
    single = "DATUM_REFERENCE_COMPARTMENT('',$,#4,.F.,#9022,$);"
    assert single in TOLD
    common = (
        "DATUM_REFERENCE_COMPARTMENT('',$,#4,.F.,COMMON_DATUM_LIST((#9043,#9044)),$);\n"
        "#9043=DATUM_REFERENCE_ELEMENT('',$,#4,.F.,#9022,$);\n"
        "#9044=DATUM_REFERENCE_ELEMENT('',$,#4,.F.,#9022,$);"
    )
    part = read_nominal(write(tmp_path, TOLD.replace(single, common)))
    assert {one.datums for one in part.pmi.tolerances} == {(), ("A-A", "B")}
    (asked,) = (r for r in pmi_drawing(part, ()).requirements if "position" in r.callout.text
                and r.callout.zone)  # fmt: skip
    assert (asked.callout.datums, asked.refused) == (("A", "B"), "")


def test_faces_have_the_names_that_the_cad_gives_them(told):
    titles = {face.title for face in told.faces if face.title}
    assert "top face" in titles and "boss" in titles


def test_a_job_evaluates_what_the_cad_asks_for(tmp_path):
    """The same values as the same words in the job give."""
    import shutil

    from vmach.run.pipeline import inspect_part

    sample = PART.parent
    for name in ("machine.toml", "part.nc"):
        shutil.copy(sample / name, tmp_path / name)
    shutil.copytree(sample / "errors", tmp_path / "errors")
    write(tmp_path)
    text = (sample / "job.toml").read_text().split("# --- the drawing")[0]
    more = '\n[inspection]\nspacing_mm = 6\n[tolerances]\n"face 13 plane" = "flatness 0.02"\n'
    (tmp_path / "job.toml").write_text(text + more)
    results = inspect_part(tmp_path / "job.toml").features
    assert len(results) == 1 + 3 + 4  # the job's; three tolerances; two values of each size
    told, own = (r for r in reversed(results) if r.callout == "flatness 0.02")
    assert told.predicted.value_mm == own.predicted.value_mm > 0.0
    assert [r.reason for r in results if r.reason] == [
        "maximum material requirement: not evaluated"
    ]
    assert all(np.isfinite(r.predicted.value_mm) for r in results if not r.reason)


@pytest.mark.parametrize(("old", "new"), [
    ("#9013=FLATNESS_TOLERANCE('Flatness.1','',#9012,#9010)", "#9013=FLATNESS_TOLERANCE('F','')"),
    ("#9042=DATUM_SYSTEM('',$,#4,.F.,(#9040,#9041))", "#9042=DATUM_SYSTEM('',$,#4,.F.,(#9012))"),
    ("LENGTH_MEASURE(0.02),#9001)", "LENGTH_MEASURE('x'),#9001)"),
])  # fmt: skip
def test_damaged_tolerances_are_said_and_left_out(tmp_path, old, new):
    assert old in TOLD
    path = write(tmp_path, TOLD.replace(old, new))
    with pytest.raises(InputError, match="tolerances of the STEP file are damaged"):
        read_pmi(StepFile(path))
    part = read_nominal(path)
    assert not part.pmi and len(part.faces) == 32
    assert [n for n in part.notes if "damaged" in n.text and "left out" in n.text]


def test_a_file_without_tolerances_says_nothing():
    pmi = read_pmi(StepFile(PART))
    assert not pmi and pmi.datums == ()
