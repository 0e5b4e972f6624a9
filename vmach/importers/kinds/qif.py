"""QIF results: measured points, circles and cylinders of a part, with their nominals.

A point whose place is that of a measured point that is not compensated is the centre of the probe's
ball, and the surface lies a radius below it.

Source: ISO 23952:2020 (QIF 3.0), schemas Features, Results and Units (a length without the
attribute ``linearUnit`` is in the primary unit).
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vmach.files.text_file import decimal_number
from vmach.importers.importer import Imported, Importer
from vmach.importers.kinds.dmis import features_imported
from vmach.importers.measured_points import length_factor
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
        "unit": "of lengths, where the file names none",
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
        units = _Units.of(root, source, questions)
        by_id = {e.get("id"): e for e in root.iter() if e.get("id")}
        balls, centres = _balls(root, units), 0
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
            own = _numbers(nominal, definition, kind, units)
            actual = _numbers(element, element, kind, units, like=own)
            radius = balls.get(tuple(actual[:3])) if kind == "Point" else None
            if radius is not None:
                actual[:3] -= radius * own[3:6] / max(float(np.linalg.norm(own[3:6])), 1e-9)
                centres += 1
            found.append((label, "POINT" if kind == "Point" else kind, own, actual))
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


@dataclass(frozen=True)
class _Units:
    """Millimetres per unit of length: of the primary one, and of each that has a name."""

    source: SourceFile
    questions: Questions
    stated: float | None
    named: dict[str, float]

    @classmethod
    def of(cls, root: ET.Element, source: SourceFile, questions: Questions) -> _Units:
        """Units that the file declares."""
        named = {_text(e, "UnitName"): _millimetres(e, source)
                 for e in root.iter() if local(e) == "LinearUnit"}  # fmt: skip
        primary = [e for one in root.iter() if local(one) == "PrimaryUnits"
                   for e in one if local(e) == "LinearUnit"]  # fmt: skip
        stated = _millimetres(primary[0], source) if primary else None
        return cls(source, questions, stated, named)

    @cached_property
    def primary(self) -> float:
        """Of the primary unit, which is asked where the file does not name it."""
        if self.stated is not None:
            return self.stated
        return length_factor(self.source, self.questions, None)

    def length_mm(self, element: ET.Element) -> np.ndarray:
        """Numbers of an element, by the unit that it states, else by the primary one."""
        unit = element.get("linearUnit")
        if unit is not None and unit not in self.named:
            raise self.source.error(
                f"{local(element)} has linearUnit='{unit}'",
                line=next((k for k, t in enumerate(self.source.lines, 1) if unit in t), 1),
                accepted=", ".join(self.named) or "a unit that FileUnits declares",
            )
        values = [decimal_number(cell) for cell in (element.text or "").split()]
        return np.array(values) * (self.primary if unit is None else self.named[unit])


def _millimetres(unit: ET.Element, source: SourceFile) -> float:
    """Millimetres of one ``LinearUnit``; without a factor it is the metre."""
    factor = next((e.text for e in unit.iter() if local(e) == "Factor"), "1")
    value = 1e3 * decimal_number(factor or "")
    if not 0.0 < value < 1e7:
        raise source.error(f"LinearUnit with the factor '{factor}'", line=1,
                           accepted="metres per unit")  # fmt: skip
    return value


def _balls(root: ET.Element, units: _Units) -> dict[tuple[float, ...], float]:
    """Radius of the probe's ball, mm, by the single points that are those of its centre, mm."""
    found: dict[tuple[float, ...], float] = {}
    for one in root.iter():
        if local(one) == "MeasuredPointSet" and _text(one, "Compensated") in ("false", "0"):
            parts = {local(child): units.length_mm(child) for child in one
                     if local(child) in ("Points", "ProbeRadius")}  # fmt: skip
            place, radius = (parts.get(name, np.zeros(0)) for name in ("Points", "ProbeRadius"))
            if len(place) == 3 and len(radius) == 1 and 0.0 < radius[0] < 1e3:
                found[tuple(place)] = float(radius[0])
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
    units: _Units,
    *,
    like: np.ndarray | None = None,
) -> np.ndarray:
    """Place and diameter in mm, direction between them.

    Parameters
    ----------
    element : Element
    sized : Element or None
        What states the diameter.
    kind : str
    units : _Units
    like : (N,) array, optional
        Of a measured feature, its nominal: a direction that was not measured is this one, and a
        diameter that was not measured is NaN.
    """
    parts = {local(e): e for e in element.iter()}
    place = parts.get("Location", parts.get("AxisPoint"))
    direction = parts.get("Normal", parts.get("Direction"))
    found = [_checked(element, place, 3, units)]
    if direction is None and like is not None:
        found.append(like[3:6])
    else:
        found.append(_checked(element, direction, 3, units, is_length=False))
    if kind != "Point":
        size = next((e for e in sized or () if local(e) == "Diameter"), None)
        is_open = size is None and like is not None
        found.append(np.array([np.nan]) if is_open else _checked(element, size, 1, units))
    return np.concatenate(found)


def _checked(
    of: ET.Element, element: ET.Element | None, count: int, units: _Units, *, is_length: bool = True
) -> np.ndarray:
    """So many finite numbers of an element, lengths in mm."""
    cells = [] if element is None else (element.text or "").split()
    values = np.array([decimal_number(cell) for cell in cells])
    if len(values) != count or not np.isfinite(values).all() or (abs(values) > 1e6).any():
        raise units.source.error(
            f"{local(of)} {of.get('id')} has '{' '.join(cells)[:60]}'",
            line=_line_of(units.source, of),
            accepted="a diameter" if count == 1 else "three numbers as its place or direction",
        )
    return values if element is None or not is_length else units.length_mm(element)


def _line_of(source: SourceFile, element: ET.Element) -> int:
    sign = f'id="{element.get("id")}"'
    return next((k for k, line in enumerate(source.lines, 1) if sign in line), 1)
