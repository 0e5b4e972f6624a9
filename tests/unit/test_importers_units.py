"""Files whose numbers another unit, a decimal comma or a missing part would change in silence."""

from __future__ import annotations

import pytest

from tests.import_samples import ETALON, ISG, PLY, SAMPLES, write_plate_job
from vmach.errors import InputError
from vmach.importers import Questions, import_files


def imported(folder, name, text, **given):
    (folder / name).write_text(text, encoding="utf-8")
    (one,) = import_files([folder / name], Questions(given, job_file=write_plate_job(folder)))
    return one


def rows(text):
    return [line.split(",") for line in text.splitlines()]


QIF_TEXT = {sample.kind: sample for sample in SAMPLES}["qif"].text
DMIS_TEXT = {sample.kind: sample for sample in SAMPLES}["dmis"].text
MM = (
    '</PrimaryUnits><OtherUnits n="1"><LinearUnit><UnitName>mm</UnitName><UnitConversion>'
    "<Factor>0.001</Factor></UnitConversion></LinearUnit></OtherUnits>"
)


def test_a_length_of_qif_states_its_own_unit(tmp_path):
    """ISO 23952: linearUnit goes before the primary unit, here the inch."""
    text = QIF_TEXT.replace("</PrimaryUnits>", MM)
    text = text.replace(">1.0 2.0 0.001<", ' linearUnit="mm">25.4 50.8 0.0254<')
    text = text.replace(">0.501<", ' linearUnit="mm">12.7254<')
    found, plain = imported(tmp_path, "a.qif", text), imported(tmp_path, "a.qif", QIF_TEXT)
    assert found.files == plain.files
    with pytest.raises(InputError, match=r"a.qif:26: Location has linearUnit='ft'; accepted: inch"):
        imported(tmp_path, "a.qif", QIF_TEXT.replace(">1.0 2", ' linearUnit="ft">1.0 2'))


def test_the_unit_that_a_report_lacks_is_asked(tmp_path):
    begin, end = QIF_TEXT.index("<FileUnits>"), QIF_TEXT.index("<Features>")
    for name, text in (
        ("a.qif", QIF_TEXT[:begin] + QIF_TEXT[end:]),
        ("a.dmo", DMIS_TEXT.replace("UNITS/MM,ANGDEC\n", "")),
        ("b.dmo", DMIS_TEXT.replace("UNITS/MM,ANGDEC\n", "") + "UNITS/MM,ANGDEC\n"),
    ):
        with pytest.raises(InputError, match="does not say: unit of the coordinates"):
            imported(tmp_path, name, text)
        stem = name.split(".")[0]
        mm, inch = (imported(tmp_path, name, text, unit=u).files for u in ("mm", "inch"))
        sizes = [float(rows(f[f"{stem}_holes.csv"])[1][6]) for f in (mm, inch)]
        assert sizes[1] == pytest.approx(25.4 * sizes[0])


def test_a_diameter_that_was_not_measured_is_no_reading(tmp_path):
    text = QIF_TEXT.replace("<Diameter>0.501</Diameter>", "")
    found = imported(tmp_path, "a.qif", text)
    assert rows(found.files["a_holes.csv"])[0] == ["id", "x", "y", "mx", "my"]
    assert "no diameter was measured" in " ".join(found.told)
    begin, end = QIF_TEXT.index("  <CircleFeatureMeasurement"), QIF_TEXT.index(" </MeasuredFeat")
    other = QIF_TEXT[begin:end].replace('id="9"', 'id="19"')
    found = imported(tmp_path, "a.qif", text.replace(" </MeasuredFeat", other + " </MeasuredFeat"))
    assert [row[0] for row in rows(found.files["a_holes.csv"])] == ["id", "BORE 19"]
    assert "1 circles or cylinders without a measured diameter" in " ".join(found.told)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("0.001,0.002", "0,001,0.002", r"a.dmo:4: POINT with 'CART,0,001.*accepted: 6 numbers"),
        ("FEAT/CIRCLE,INNER,CART,10,", "FEAT/CIRCLE,INNER,Pol,10,", "a.dmo:5: .* polar"),
        ("0,0,1,8.0", "0,0,1,8.0,3.0", "a.dmo:5: CIRCLE with .* accepted: 7 numbers"),
    ],
)
def test_a_line_of_dmis_with_other_numbers_is_refused(old, new, said, tmp_path):
    assert old in DMIS_TEXT
    with pytest.raises(InputError, match=said):
        imported(tmp_path, "a.dmo", DMIS_TEXT.replace(old, new))


def test_a_cloud_that_breaks_off_is_refused(tmp_path):
    with pytest.raises(InputError, match="says 4 vertices and has 3"):
        imported(tmp_path, "a.ply", PLY.replace("6 -3 0\n", ""))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_volumetric_files_in_any_encoding(encoding, tmp_path):
    names = ["errors/EXX.csv", "errors/EYX.csv", "errors/EYY.csv"]
    (tmp_path / "a.csv").write_text("// gemessen für Ö\n" + ISG, encoding=encoding)
    (found,) = import_files([tmp_path / "a.csv"], Questions())
    assert [*found.files] == names


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("0.0000341", "34.1", r"a.txt:13: C0Y holds 34.1 rad; .* at most 0.1 rad"),
        ("0.003", "3.0", r"a.txt:2: EXX holds 3 mm; .* at most 1 mm"),
        ("0.00002", "20", r"a.txt:8: EBX holds 20 rad; .* at most 0.01 rad"),
    ],
)
def test_volumetric_files_in_another_unit_are_refused(old, new, said, tmp_path):
    assert old in ETALON
    with pytest.raises(InputError, match=said):
        imported(tmp_path, "a.txt", ETALON.replace(old, new))
