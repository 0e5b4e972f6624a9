"""QIF results: measured points, circles and cylinders of a part, with their nominals.

A point whose place is that of a measured point that is not compensated is the centre of the probe's
ball, and the surface lies a radius below it.

Source: ISO 23952:2020 (QIF 3.0), schemas Features and Results.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np

from vmach.files.text_file import decimal_number
from vmach.importers.importer import Imported, Importer
from vmach.importers.kinds.dmis import features_imported
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile
from vmach.importers.xml_text import local, xml_root

__all__ = ["QifResults"]

_KINDS = ("Point", "Circle", "Cylinder")


class QifResults(Importer):
    """Features that are nominal and measured; characteristics alone say no places."""

    name = "qif"
    title = "QIF results"
    reads = ".qif: FeatureNominals, FeatureItems and MeasuredFeatures of points and holes"
    rank = 12
    keys = {
        "u_um": "standard uncertainty of a measured hole",
        "result": "which of several measured parts, counted from 1",
    }

    def recognises(self, source: SourceFile) -> bool:
        return source.suffix == ".qif" or (
            source.is_text and not source.path.is_dir() and "<QIFDocument" in source.text[:2000]
        )

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        root = xml_root(source)
        if local(root) != "QIFDocument":
            raise source.error(f"is a {local(root)}", line=1, accepted="a QIFDocument")
        factor = _factor(root, source)
        by_id = {e.get("id"): e for e in root.iter() if e.get("id")}
        balls, centres = _balls(root), 0
        found, seen = [], set[str]()
        for element in _result(root, source, questions).iter():
            kind = local(element).removesuffix("FeatureMeasurement")
            if kind == local(element) or kind not in _KINDS:
                continue
            item = by_id.get(_text(element, "FeatureItemId"))
            if item is None:
                continue
            nominal = by_id.get(_text(item, "FeatureNominalId"))
            if nominal is None:
                continue
            label = _text(item, "FeatureName") or f"{kind} {element.get('id')}"
            label = label if label not in seen else f"{label} {element.get('id')}"
            seen.add(label)
            definition = by_id.get(_text(nominal, "FeatureDefinitionId"))
            own = _numbers(nominal, definition, kind, source)
            actual = _numbers(element, element, kind, source, like=own)
            radius = balls.get(tuple(actual[:3])) if kind == "Point" else None
            if radius is not None:
                actual[:3] -= radius * own[3:6] / max(float(np.linalg.norm(own[3:6])), 1e-9)
                centres += 1
            scale = np.array([factor] * 3 + [1.0] * 3 + [factor] * (len(own) - 6))
            found.append((label, "POINT" if kind == "Point" else kind, scale * own, scale * actual))
        if not found:
            raise source.error(
                "no point, circle or cylinder is both nominal and measured",
                line=1,
                accepted="MeasuredFeatures with FeatureItems and FeatureNominals",
                hint="characteristics alone (diameters, positions) say no places",
            )
        said = f"{centres} points are centres of the probe's ball: its radius is taken off"
        return features_imported(found, source, questions, (said,) if centres else ())


def _result(root: ET.Element, source: SourceFile, questions: Questions) -> ET.Element:
    """The results of one part."""
    results = [e for e in root.iter() if local(e) == "MeasurementResults"]
    if len(results) < 2:
        return root
    number = questions.number("result", f"which of {len(results)} measured parts", unit="1")
    if number not in range(1, len(results) + 1):
        raise source.error(f"result {number:g}", line=1, accepted=f"1 to {len(results)}")
    return results[int(number) - 1]


def _factor(root: ET.Element, source: SourceFile) -> float:
    """Millimetres per unit of length."""
    for unit in root.iter():
        if local(unit) == "LinearUnit":
            factor = next((e.text for e in unit.iter() if local(e) == "Factor"), "1")
            value = 1e3 * decimal_number(factor or "")
            if not 0.0 < value < 1e7:
                raise source.error(f"LinearUnit with the factor '{factor}'", line=1,
                                   accepted="metres per unit")  # fmt: skip
            return value
    return 1.0


def _balls(root: ET.Element) -> dict[tuple[float, ...], float]:
    """Radius of the probe's ball by the single points whose places are those of its centre."""
    found: dict[tuple[float, ...], float] = {}
    for one in root.iter():
        if local(one) == "MeasuredPointSet" and _text(one, "Compensated") in ("false", "0"):
            place = tuple(decimal_number(cell) for cell in _text(one, "Points").split()[:4])
            radius = decimal_number(_text(one, "ProbeRadius"))
            if len(place) == 3 and 0.0 < radius < 1e3:
                found[place] = radius
    return found


def _text(element: ET.Element, name: str) -> str:
    for child in element:
        if local(child) == name:
            return (child.text or "").strip()
    return ""


def _numbers(
    element: ET.Element,
    sized: ET.Element | None,
    kind: str,
    source: SourceFile,
    *,
    like: np.ndarray | None = None,
) -> np.ndarray:
    """Place, direction and, of round features, diameter; what is not measured is as nominal."""
    words = {local(e): (e.text or "").split() for e in element.iter()}
    place = words.get("Location") or words.get("AxisPoint") or []
    direction = words.get("Normal") or words.get("Direction") or []
    size = [] if sized is None or kind == "Point" else _text(sized, "Diameter").split()
    parts = []
    for k, (cells, count) in enumerate(((place, 3), (direction, 3), (size, kind != "Point"))):
        if not cells and like is not None and k:
            parts.append(like[3 * k : 3 * k + count])
            continue
        values = np.array([decimal_number(cell) for cell in cells])
        if len(values) != count or not np.isfinite(values).all() or (abs(values) > 1e6).any():
            raise source.error(
                f"{local(element)} {element.get('id')} has '{' '.join(cells)[:60]}'",
                line=_line_of(source, element),
                accepted=f"{count} numbers as its place, direction or diameter",
            )
        parts.append(values)
    return np.concatenate(parts)


def _line_of(source: SourceFile, element: ET.Element) -> int:
    sign = f'id="{element.get("id")}"'
    return next((k for k, line in enumerate(source.lines, 1) if sign in line), 1)
