"""Files of a drawing's results: read back equal, complete, and the same on every run."""

from __future__ import annotations

import csv
import io
import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import pytest
from PIL import Image

from tests.feature_part import DATUMS, FEATURES, measures, part
from vmach.errors import InputError
from vmach.features.drawing.callout import read_callout
from vmach.features.evaluation import Requirement
from vmach.features.result import FeatureResult, Value
from vmach.features.verdict import Verdict, verdict
from vmach.report import RunRecord, check_ending
from vmach.report.exchange import dmis, qdas, qif, sheet, table

ASKED = [
    ("bore 1", "20 H7"), ("bore 1", "R10 ±0.1"), ("ball", "SØ12 ±0.1"), ("length", "100 ±0.1"),
    ("bore 1", "distance 60 ±0.1 to bore 2"), ("top", "flatness 0.1"), ("top", "straightness 0.1"),
    ("bore 1", "straightness Ø0.1"), ("bore 1", "roundness 0.1"), ("bore 1", "cylindricity 0.1"),
    ("left", "perpendicularity 0.1 A C"), ("bore 1", "perpendicularity Ø0.1 A"),
    ("right", "parallelism 0.1 B"), ("slant", "angularity 0.1 A"),
    ("bore 1", "position Ø0.1 A B C"), ("ball", "position SØ0.1 A B C"),
    ("bore 1", "position 0.1 A B C along X"), ("pin", "coaxiality Ø0.1 E"),
    ("length", "symmetry 0.1 D"), ("top", "profile 0.1 B C"), ("bores", "position Ø0.1 A B-C"),
    ("bore 1", "profile of line 0.1 A B C"), ("pin", "circular runout 0.1 E"),
    ("pin", "total runout 0.1 E"),
]  # fmt: skip


def results() -> tuple[FeatureResult, ...]:
    """Every characteristic on a part with some deviations."""
    made = part(bore_1=0.013, left=lambda p: 1e-3 * p[:, 2], pin=-0.06, top=0.02)
    found = []
    for name, text in ASKED:
        callout = read_callout(text)
        requirement = Requirement(name, callout)
        for measure in measures(made, name, text):
            lower, upper = requirement.limits_mm
            value = measure.value_mm + 1.23456789e-4  # digits that rounding would lose
            found.append(FeatureResult(
                feature=name, callout=text, characteristic=callout.characteristic,
                label=measure.label, datums=callout.datums,
                nominal_mm=callout.nominal_mm if callout.is_size else 0.0,
                lower_mm=lower if callout.is_size else None, upper_mm=upper,
                values={"abbe": Value(value, 5e-4, verdict(value, 5e-4, lower, upper))},
                primary="abbe", unit=callout.zone, kind=FEATURES[name].kind,
            ))  # fmt: skip
    return tuple(found)


RUN = RunRecord("a block", "vmach features", "abbe", 0.01, started_at="2026-01-02T03:04:05+00:00",
                features=results(), part="block $5", serial="SN 7", revision="B",
                facts={"machine": "test"}, warnings=("a note",))  # fmt: skip
FIRST = "{http://qifstandards.org/xsd/qif3}"


def test_qif_reads_back_equal():
    root = ET.fromstring(qif.content(RUN))
    items = {
        e.get("id"): e for e in root.find(f"{FIRST}Characteristics/{FIRST}CharacteristicItems")
    }
    found = next(root.iter(f"{FIRST}CharacteristicMeasurements"))
    assert len(found) == len(RUN.features) == int(found.get("n"))
    status = {"conforms": "PASS", "does not conform": "FAIL", "cannot be told": "INDETERMINATE"}
    for one, result in zip(found, RUN.features, strict=True):
        value = one.find(f"{FIRST}Value")
        assert float(value.text) == pytest.approx(result.predicted.value_mm, abs=1e-9)
        assert float(value.get("combinedUncertainty")) == pytest.approx(5e-4)
        told = one.find(f"{FIRST}Status/{FIRST}CharacteristicStatusEnum").text
        assert told == status[str(result.predicted.verdict)]
        item = items[one.find(f"{FIRST}CharacteristicItemId").text]
        assert item.find(f"{FIRST}Name").text == f"{result.feature}: {result.title}"


@pytest.mark.parametrize(
    ("verdicts", "said"),
    [
        (("conforms", "conforms"), "PASS"),
        (("conforms", "cannot be told"), "UNKNOWN"),
        (("cannot be told", "does not conform"), "FAIL"),
    ],
)
def test_a_part_passes_qif_where_all_of_it_conforms(verdicts, said):
    """What cannot be told proves no conformance (ISO 14253-1)."""
    features = tuple(
        replace(one, values={"abbe": replace(one.values["abbe"], verdict=Verdict(verdict))})
        for one, verdict in zip(RUN.features, verdicts, strict=False)
    )
    root = ET.fromstring(qif.content(replace(RUN, features=features)))
    assert next(root.iter(f"{FIRST}InspectionStatusEnum")).text == said


def test_every_reference_of_qif_leads_somewhere():
    root = ET.fromstring(qif.content(RUN))
    known = [e.get("id") for e in root.iter() if e.get("id")]
    assert len(known) == len(set(known)) == int(root.get("idMax"))
    used = {e.text for e in root.iter() if e.tag.endswith("Id") and e.tag != f"{FIRST}QPId"}
    assert {u for u in used if u.isdigit()} <= set(known)
    counted = [e for e in root.iter() if e.get("n")]
    assert all(int(e.get("n")) == len(e) - (e.tag == f"{FIRST}Results") for e in counted)
    letters = {e.text for e in root.iter(f"{FIRST}DatumLabel")}
    assert letters == set("ABCDE") & set(DATUMS)


def test_dmis_has_a_nominal_and_an_actual_line_for_each():
    lines = dmis.content(RUN).decode("ascii").split("\r\n")
    nominal = [line for line in lines if line.startswith("T(")]
    actual = [line for line in lines if line.startswith("TA(")]
    assert len(nominal) == len(actual) == len(RUN.features)
    for line, result in zip(actual, RUN.features, strict=True):
        label, word, number, told = re.fullmatch(
            r"TA\((\w+)\)=TOL/(\w+),(\S+),(\w+)", line
        ).groups()
        base = result.nominal_mm if result.lower_mm is not None else 0.0
        assert base + float(number) == pytest.approx(result.predicted.value_mm, abs=1e-6)
        assert any(n.startswith(f"T({label})=TOL/{word},") for n in nominal)
        assert told in ("INTOL", "OUTOL", "UNKNOWN")
    assert lines[-2] == "ENDFIL"
    # a distance has its nominal value too, as public programs for such machines have it
    far = next(r for r in RUN.features if r.characteristic == "distance")
    line = next(line for line in nominal if "TOL/DISTB" in line)
    words = line.split("/")[1].split(",")
    assert words[:2] == ["DISTB", "NOMINL"]
    low, high = (far.nominal_mm + float(word) for word in words[3:5])
    assert (float(words[2]), low, high) == pytest.approx(
        (far.nominal_mm, far.lower_mm, far.upper_mm)
    )


def test_qdas_fields_belong_to_their_characteristics():
    text = qdas.content(RUN).decode("latin-1")
    fields = dict(re.findall(r"^(K\d{4}(?:/\d+)?) (.*?)\r$", text, re.MULTILINE))
    assert int(fields["K0100"]) == len(RUN.features)
    assert fields["K1001"] == "block $5" and fields["K1004"] == "B"
    for number, result in enumerate(RUN.features, 1):
        value = result.predicted.value_mm
        assert float(fields[f"K0001/{number}"]) == pytest.approx(value, abs=1e-6)
        assert float(fields[f"K2111/{number}"]) == pytest.approx(result.upper_mm, abs=1e-6)
        assert fields[f"K0004/{number}"] == "02.01.2026/03:04:05"
        assert fields[f"K0014/{number}"] == "SN 7"
        assert (f"K2120/{number}" in fields) == (result.lower_mm is None)


def test_csv_has_a_row_for_each():
    rows = list(csv.DictReader(io.StringIO(table.content(RUN).decode())))
    assert [row["requirement"] for row in rows] == [r.callout for r in RUN.features]


def test_the_printed_report_has_up_to_three_pages(tmp_path):
    picture = tmp_path / "map.png"
    Image.new("RGB", (80, 60), "white").save(picture)
    for factor, pages in ((1, 2), (3, 3), (9, 3)):
        many = RunRecord(**{**vars(RUN), "features": RUN.features * factor})
        data = sheet.content(many, picture=picture, logo=picture)
        assert data.startswith(b"%PDF-")
        assert len(re.findall(rb"/Type /Page\b", data)) == pages


@pytest.mark.parametrize("module", [qif, dmis, qdas, table, sheet])
def test_a_file_is_the_same_on_every_run(module):
    assert module.content(RUN) == module.content(RUN)


def test_other_endings_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"the ending '.xls'; accepted: .qif \(QIF 3.0"):
        check_ending(tmp_path / "a.xls")


def test_the_plan_measures_datums_first_and_every_characteristic_once():
    """Doubtful features come before those that conform; each step says what is expected."""
    root = ET.fromstring(qif.content(RUN))
    plan = root.find(f"{FIRST}Plan")
    steps = plan.findall(f"{FIRST}OrderedPlanRoot/{FIRST}Steps/{FIRST}NumberedPlanElement")
    assert [int(s.find(f"{FIRST}SequenceNumber").text) for s in steps] == [
        *range(1, len(steps) + 1)
    ]
    assert steps[0].find(f"{FIRST}MeasureSpecifiedMeasurands") is not None
    items = {
        e.get("id"): e.find(f"{FIRST}Name").text
        for e in root.find(f"{FIRST}Characteristics/{FIRST}CharacteristicItems")
    }
    told = {e.get("id"): e[0].text for e in plan.find(f"{FIRST}WorkInstructions")}
    measured, worst = [], []
    rank = {"does not conform": 0, "cannot be told": 1, "conforms": 2}
    for step in steps[1:]:
        action = step.find(f"{FIRST}MeasureEvaluateSpecified")
        names = [items[i.text] for i in action.find(f"{FIRST}CharacteristicItemIds")]
        measured += names
        (instruction,) = (told[i.text] for i in action.find(f"{FIRST}WorkInstructionIds"))
        assert all(name.split(": ", 1)[1] in instruction for name in names)
        worst.append(min(rank[v] for v in rank if f"mm, {v}" in instruction))
    assert sorted(measured) == sorted(f"{r.feature}: {r.title}" for r in RUN.features)
    assert worst == sorted(worst)
