"""PC-DMIS text reports: dimensions of locations, each a heading and a line for every axis.

The columns stand in the order that the report's heading names (Hexagon, PC-DMIS Help, "Dimension
Output Format": the order is the user's). Public programs that write and read such reports show the
lines ``DIM LOC1= LOCATION OF CIRCLE CIR1 UNITS=MM``, ``AX NOMINAL +TOL -TOL MEAS DEV OUTTOL`` and
``X 10.000 0.010 0.010 10.002 0.002 0.000``. The place below the heading tells empty cells. DEV has
to be MEAS minus NOMINAL, or what it is farther from zero, as some reports count; else a line is
refused.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from vmach.files.text_file import decimal_number
from vmach.importers.importer import Imported, Importer
from vmach.importers.measured_points import (
    Holes,
    Points,
    holes_file,
    length_factor,
    normals_on_part,
    points_file,
    sized_holes,
)
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile

__all__ = ["PcdmisReport"]

_DIMENSION = re.compile(r"^\s*DIM(?:ENSION)?\s+\S+?\s*=\s*(.*)$", re.I)
_LOCATION = re.compile(r"^(?:TRUE\s+)?(?:LOCATION|POSITION)\s+OF\s+(.*?)\s*(?:,|\bUNITS\b|$)", re.I)
_UNITS = re.compile(r"\bUNITS\s*=\s*(\w+)", re.I)
_UNIT_NAMES: Mapping[str, str] = {"MM": "mm", "IN": "inch", "INCH": "inch"}
_HEADING = re.compile(r"^\s*AX\b.*\bNOM", re.I)
#: what stands for a coordinate or a diameter; other lines of a dimension hold forms and tolerances
_AXES: Mapping[str, str] = {"X": "x", "Y": "y", "Z": "z", "D": "d", "DF": "d"}
#: what a report calls features that are holes, also where it has no diameter of them
_ROUND = ("CIRCLE", "CYLINDER")
_NOMINAL, _MEASURED, _DEVIATION = "NOMINAL", "MEAS", "DEV"


@dataclass(frozen=True)
class _Value:
    """One line of a dimension, in the unit of the file."""

    nominal: float
    measured: float


@dataclass
class _Feature:
    """What the report says of a feature, by x, y, z and d; and whether it calls it round."""

    line: int
    is_round: bool
    values: dict[str, _Value] = field(default_factory=dict)


class PcdmisReport(Importer):
    """Circles and cylinders become holes, points without a diameter measured points."""

    name = "pcdmis"
    title = "PC-DMIS text report"
    reads = "dimensions LOCATION and POSITION: lines X, Y, Z, D below AX NOMINAL MEAS DEV"
    rank = 24
    keys = {"u_um": "standard uncertainty of a measured hole", "unit": "mm or inch"}

    def recognises(self, source: SourceFile) -> bool:
        return source.is_text and any(_DIMENSION.match(line) for line in source.lines)

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        features, unit = _features(source)
        holes = {n: f for n, f in features.items() if _is_hole(f)}
        points = {n: f for n, f in features.items()
                  if {"x", "y", "z"} <= f.values.keys() and n not in holes}  # fmt: skip
        if not holes and not points:
            raise source.error(
                f"{len(features)} locations, none of them with X, Y and D, or X, Y and Z",
                accepted="dimensions LOCATION or POSITION with these lines",
                hint="diameters and forms alone have no place on the part",
            )
        factor = length_factor(source, questions, unit)
        found = []
        if points:
            found.append(_points_imported(points, factor, source, questions))
        if holes:
            found.append(_holes_imported(holes, factor, source, questions))
        lost = len(features) - len(holes) - len(points)
        told = (f"{lost} locations without enough coordinates are left out",) if lost else ()
        return Imported.joined(found, told)


def _is_hole(feature: _Feature) -> bool:
    """Whether it has a place across, and a diameter or the name of something round."""
    has = feature.values.keys()
    return {"x", "y"} <= has and ("d" in has or feature.is_round)


def _columns(features: Mapping[str, _Feature], axes: str, factor: float) -> tuple[np.ndarray, ...]:
    """Nominal and measured values of some axes, each (F, A), mm."""
    rows = [[f.values[a] for a in axes] for f in features.values()]
    return tuple(
        factor * np.array([[getattr(v, which) for v in row] for row in rows])
        for which in ("nominal", "measured")
    )


def _points_imported(
    features: Mapping[str, _Feature], factor: float, source: SourceFile, questions: Questions
) -> Imported:
    nominal, measured = _columns(features, "xyz", factor)
    lines = np.array([f.line for f in features.values()])
    normal = normals_on_part(nominal, source, questions, lines)
    names = [*features]
    return points_file(Points(names, names, nominal, normal, measured), source)


def _holes_imported(
    features: Mapping[str, _Feature], factor: float, source: SourceFile, questions: Questions
) -> Imported:
    nominal, measured = _columns(features, "xy", factor)
    sizes = [
        factor * np.array([getattr(f.values.get("d"), which, np.nan) for f in features.values()])
        for which in ("nominal", "measured")
    ]
    holes, told = sized_holes(Holes([*features], nominal, measured, *sizes))
    said = ("circles and cylinders are taken as upright", *told)
    return holes_file(holes, source, questions, said)


def _features(source: SourceFile) -> tuple[dict[str, _Feature], str | None]:
    """Located features by their names, and the unit of all of them."""
    found: dict[str, _Feature] = {}
    units: dict[str, int] = {}
    own: _Feature | None = None
    columns: list[re.Match[str]] = []
    for number, line in enumerate(source.lines, 1):
        dimension = _DIMENSION.match(line)
        if dimension is not None:
            location = _LOCATION.match(dimension[1])
            own, columns = None, []
            if location is not None and location[1]:
                *kind, name = location[1].split()
                is_round = bool(kind) and kind[0].upper() in _ROUND
                own = found.setdefault(name, _Feature(number, is_round))
                unit = _UNITS.search(line)
                units.setdefault(unit[1].upper() if unit else "", number)
        elif _HEADING.match(line):
            columns = [*re.finditer(r"\S+", line)][1:]
        elif own is not None and columns:
            words = line.split()
            axis = _AXES.get(words[0].upper()) if words else None
            if axis is not None and axis not in own.values:
                own.values[axis] = _value(line, number, columns, source)
    return found, _one_unit(units, source)


def _one_unit(units: Mapping[str, int], source: SourceFile) -> str | None:
    """``mm`` or ``inch``; None where the report does not say."""
    said = {unit: line for unit, line in units.items() if unit}
    for unit, line in said.items():
        if unit not in _UNIT_NAMES or len(said) > 1:
            raise source.error(
                f"UNITS={', '.join(said)}", line=line, accepted="MM or IN, one of them throughout"
            )
    return _UNIT_NAMES[next(iter(said))] if said else None


def _value(line: str, number: int, columns: list[re.Match[str]], source: SourceFile) -> _Value:
    """Nominal and measured value of a line, each cell in its column."""
    cells = [m for m in re.finditer(r"\S+", line) if re.search(r"\w", m[0])][1:]
    names = [column[0].upper() for column in columns]
    if len(cells) == len(columns):
        by_name = dict(zip(names, cells, strict=True))
    else:
        by_name = {}
        for cell in cells:
            near = min(range(len(columns)), key=lambda k: abs(columns[k].end() - cell.end()))
            by_name[names[near]] = cell
    text = {name: cell[0].replace(",", ".") for name, cell in by_name.items()}
    value = {name: decimal_number(cell) for name, cell in text.items()}
    wanted = [name for name in (_NOMINAL, _MEASURED) if not abs(value.get(name, np.nan)) < 1e6]
    if wanted or len(by_name) < len(cells):
        raise source.error(
            f"'{line.strip()[:70]}'",
            line=number,
            accepted=f"numbers in the columns {', '.join(names)}",
        )
    found = _Value(value[_NOMINAL], value[_MEASURED])
    if _DEVIATION in value:
        # each of the three is rounded to half of its last digit
        rounded = sum(0.5 * _last_digit(text[n]) for n in (_NOMINAL, _MEASURED, _DEVIATION))
        apart = found.measured - found.nominal
        outward = abs(found.measured) - abs(found.nominal)
        if not min(abs(v - value[_DEVIATION]) for v in (apart, outward)) <= 1.001 * rounded:
            raise source.error(
                f"MEAS minus NOMINAL is {apart:.6g}, DEV is {text[_DEVIATION]}",
                line=number,
                accepted="columns in the order of their heading",
            )
    return found


def _last_digit(text: str) -> float:
    """The place value of the last digit: 0.001 of ``1.234``."""
    return 10.0 ** -len(text.partition(".")[2])
