"""QIF 3.0: characteristics, datums, a plan to measure them, and their values.

Source: ISO 23952:2020 (QIF 3.0), schemas QIFDocument, Characteristics, QIFPlan and QIFResults.
"""

from __future__ import annotations

import uuid
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

from vmach.features.result import FeatureResult
from vmach.features.verdict import Verdict
from vmach.report.exchange.formats import reported
from vmach.report.exchange.qif_plan import add_plan
from vmach.report.result import RunRecord

__all__ = ["content"]

_SPACE = "http://qifstandards.org/xsd/qif3"
#: identifiers are derived from what was run, so that a file is the same on every run
_NAMESPACE = uuid.UUID("6b1f0d0e-3a51-4e63-9d0e-6f1c2b1f7a30")

_NAMES = {
    "straightness": "Straightness",
    "flatness": "Flatness",
    "roundness": "Circularity",
    "cylindricity": "Cylindricity",
    "profile of line": "LineProfile",
    "profile": "SurfaceProfile",
    "parallelism": "Parallelism",
    "perpendicularity": "Perpendicularity",
    "angularity": "Angularity",
    "position": "Position",
    "coaxiality": "Coaxiality",
    "symmetry": "Symmetry",
    "circular runout": "CircularRunout",
    "total runout": "TotalRunout",
    "distance": "DistanceBetween",
}
_PRECEDENCE = ("PRIMARY", "SECONDARY", "TERTIARY")
_STATUS = {Verdict.CONFORMS: "PASS", Verdict.FAILS: "FAIL", Verdict.OPEN: "INDETERMINATE"}
#: of these the schema wants a material condition, and the shape of the zone
_ORIENTED = ("parallelism", "perpendicularity", "angularity")


@dataclass
class _Numbers:
    """Identifiers of a document, counted from 1."""

    last: int = 0
    letters: dict[str, int] = field(default_factory=dict)
    frames: dict[tuple[str, ...], int] = field(default_factory=dict)

    def new(self) -> int:
        self.last += 1
        return self.last


def content(run: RunRecord, **more: object) -> bytes:
    """The document as UTF-8 text."""
    numbers = _Numbers()
    shown = [result for result in run.features if reported(result) is not None]
    root = ET.Element("QIFDocument", {"xmlns": _SPACE, "versionQIF": "3.0.0"})
    _text(root, "QPId", uuid.uuid5(_NAMESPACE, f"{run.title} {run.started_at}"))
    if run.started_at:
        _text(ET.SubElement(root, "Version"), "TimeCreated", run.started_at)
    application = ET.SubElement(ET.SubElement(root, "Header"), "Application")
    _text(application, "Name", "vmach")
    _text(application, "Organization", "vmach")
    standard = _standard(root, numbers)
    _units(root)
    _datums(root, shown, numbers)
    product = ET.SubElement(ET.SubElement(root, "Product"), "PartSet", {"n": "1"})
    ET.SubElement(product, "Part", {"id": str(numbers.new()), "label": run.part or run.title})
    items = _characteristics(root, shown, numbers, standard)
    add_plan(root, run, shown, items, numbers)
    _results(root, run, shown, items, numbers)
    root.set("idMax", str(numbers.last))
    ET.indent(root)
    return ET.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def _text(parent: ET.Element, name: str, text: object) -> ET.Element:
    made = ET.SubElement(parent, name)
    made.text = str(text)
    return made


def _units(root: ET.Element) -> None:
    unit = ET.SubElement(ET.SubElement(ET.SubElement(root, "FileUnits"), "PrimaryUnits"),
                         "LinearUnit")  # fmt: skip
    _text(unit, "SIUnitName", "meter")
    _text(unit, "UnitName", "mm")
    _text(ET.SubElement(unit, "UnitConversion"), "Factor", "0.001")


def _datums(root: ET.Element, shown: list[FeatureResult], numbers: _Numbers) -> None:
    """Datums by their letters, and every frame that a requirement names."""
    frames = list(dict.fromkeys(result.datums for result in shown if result.datums))
    letters = list(dict.fromkeys(x for frame in frames for d in frame for x in d.split("-")))
    if not letters:
        return
    table = ET.SubElement(root, "DatumDefinitions", {"n": str(len(letters))})
    known = numbers.letters
    for letter in letters:
        known[letter] = numbers.new()
        _text(ET.SubElement(table, "DatumDefinition", {"id": str(known[letter])}), "DatumLabel",
              letter)  # fmt: skip
    table = ET.SubElement(root, "DatumReferenceFrames", {"n": str(len(frames))})
    for frame in frames:
        numbers.frames[frame] = numbers.new()
        made = ET.SubElement(table, "DatumReferenceFrame", {"id": str(numbers.frames[frame])})
        datums = ET.SubElement(made, "Datums", {"n": str(len(frame))})
        for label, precedence in zip(frame, _PRECEDENCE, strict=False):
            _datum(ET.SubElement(datums, "Datum"), label, known, precedence)


def _datum(datum: ET.Element, label: str, known: dict[str, int], precedence: str) -> None:
    """One datum of a frame; a common one consists of several."""
    letters = label.split("-")
    if len(letters) > 1:
        compound = ET.SubElement(datum, "CompoundDatum", {"n": str(len(letters))})
        for number, letter in enumerate(letters):
            part = ET.SubElement(compound, "Datum")
            _simple_datum(part, known[letter])
            _text(part, "SequenceNumber", number + 1)
    else:
        _simple_datum(datum, known[label])
    _text(ET.SubElement(datum, "Precedence"), "PrecedenceEnum", precedence)


def _simple_datum(holder: ET.Element, number: int) -> None:
    simple = ET.SubElement(holder, "SimpleDatum")
    _text(simple, "DatumDefinitionId", number)
    _text(simple, "MaterialModifier", "NONE")
    _text(simple, "ReferencedComponent", "ACTUAL")


def _name(result: FeatureResult) -> str:
    """Name of the characteristic in the schema."""
    if result.characteristic != "size":
        return _NAMES[result.characteristic]
    text = result.callout.lstrip()
    if text.startswith(("SØ", "Sø")):
        return "SphericalDiameter"
    if text.startswith(("R", "SR")):
        return "Radius"
    return "Width" if result.kind == "width" else "Diameter"


def _standard(root: ET.Element, numbers: _Numbers) -> int:
    """The standard that the tolerances follow."""
    table = ET.SubElement(root, "StandardsDefinitions", {"n": "1"})
    number = numbers.new()
    made = ET.SubElement(table, "Standard", {"id": str(number)})
    _text(ET.SubElement(made, "Organization"), "StandardsOrganizationEnum", "ISO")
    _text(made, "Designator", "1101")
    _text(made, "Year", "2017")
    return number


def _characteristics(
    root: ET.Element, shown: list[FeatureResult], numbers: _Numbers, standard: int
) -> list[int]:
    """Definitions, nominals and items; the identifier of the item of every result."""
    holder = ET.SubElement(root, "Characteristics")
    _text(holder, "FormalStandardId", standard)
    count = {"n": str(len(shown))}
    tables = [ET.SubElement(holder, f"Characteristic{kind}", count)
              for kind in ("Definitions", "Nominals", "Items")]  # fmt: skip
    items = []
    for result in shown:
        name = _name(result)
        made = []
        for table, kind in zip(tables, ("Definition", "Nominal", "Item"), strict=True):
            number = {"id": str(numbers.new())}
            made.append(ET.SubElement(table, f"{name}Characteristic{kind}", number))
        _define(made[0], result, numbers)
        _text(made[1], "CharacteristicDefinitionId", made[0].get("id"))
        _nominal(made[1], result)
        _text(made[2], "Name", f"{result.feature}: {result.title}")
        _text(made[2], "CharacteristicNominalId", made[1].get("id"))
        items.append(int(made[2].get("id")))
    return items


def _define(made: ET.Element, result: FeatureResult, numbers: _Numbers) -> None:
    name = result.characteristic
    if name in ("size", "distance"):
        tolerance = ET.SubElement(made, "Tolerance")
        _text(tolerance, "MaxValue", _length(result.upper_mm))
        _text(tolerance, "MinValue", _length(result.lower_mm))
        _text(tolerance, "DefinedAsLimit", "true")
        return
    _text(made, "ToleranceValue", _length(result.upper_mm))
    if result.datums:
        _text(made, "DatumReferenceFrameId", numbers.frames[result.datums])
    if name in (*_ORIENTED, "position"):
        _text(made, "MaterialCondition", "REGARDLESS")
    shape = _zone_shape(result)
    if shape:
        ET.SubElement(ET.SubElement(made, "ZoneShape"), shape)


def _zone_shape(result: FeatureResult) -> str:
    """What the schema calls the zone; empty where it wants none."""
    name = result.characteristic
    if name in _ORIENTED:
        return "DiametricalZone" if result.unit else "PlanarZone"
    if name in ("position", "straightness", "coaxiality"):
        if result.unit.startswith("S"):
            return "SphericalZone"
        is_round = result.unit or name == "coaxiality"
        return "DiametricalZone" if is_round else "NonDiametricalZone"
    return ""


def _nominal(made: ET.Element, result: FeatureResult) -> None:
    if result.characteristic in ("size", "distance"):
        _text(made, "TargetValue", _length(result.nominal_mm))
    if result.characteristic == "distance":
        _text(made, "AnalysisMode", "THREEDIMENSIONAL")
    if result.characteristic == "profile of line":
        _text(made, "Vector", "0 0 1")


def _results(
    root: ET.Element,
    run: RunRecord,
    shown: list[FeatureResult],
    items: list[int],
    numbers: _Numbers,
) -> None:
    results = ET.SubElement(root, "Results")
    table = ET.SubElement(results, "MeasurementResultsSet", {"n": "1"})
    made = ET.SubElement(table, "MeasurementResults", {"id": str(numbers.new())})
    _text(made, "ThisResultsInstanceQPId", uuid.uuid5(_NAMESPACE, f"results {run.title}"))
    measured = ET.SubElement(made, "MeasuredCharacteristics")
    table = ET.SubElement(measured, "CharacteristicMeasurements", {"n": str(len(shown))})
    for result, item in zip(shown, items, strict=True):
        value = reported(result)
        one = ET.SubElement(table, f"{_name(result)}CharacteristicMeasurement",
                            {"id": str(numbers.new())})  # fmt: skip
        status = ET.SubElement(one, "Status")
        _text(status, "CharacteristicStatusEnum", _STATUS[value.verdict])
        _text(one, "CharacteristicItemId", item)
        number = _text(one, "Value", _length(value.value_mm))
        if value.u_mm is not None:
            number.set("combinedUncertainty", _length(value.u_mm))
    told = ET.SubElement(made, "InspectionStatus")
    _text(told, "InspectionStatusEnum", _status_of_part({reported(r).verdict for r in shown}))


def _status_of_part(verdicts: set[Verdict]) -> str:
    """Of all requirements together: a part passes where all of them conform."""
    if Verdict.FAILS in verdicts:
        return "FAIL"
    return "UNKNOWN" if Verdict.OPEN in verdicts else "PASS"


def _length(length_mm: float) -> str:
    """Twelve digits: more than any measurement has, and a double comes back within 1e-9 mm."""
    return f"{length_mm:.9f}"
