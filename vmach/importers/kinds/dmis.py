"""DMIS output: features as nominal ``F(label)=FEAT/...`` and as measured ``FA(label)=FEAT/...``.

Source: ISO 22093 (DMIS 5): FEAT/POINT,CART,x,y,z,i,j,k and FEAT/CIRCLE,INNER,CART,x,y,z,i,j,k,diam.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from vmach.files.text_file import decimal_number
from vmach.importers.importer import Imported, Importer
from vmach.importers.measured_points import Holes, Points, holes_file, points_file
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile

__all__ = ["DmisOutput"]

_FEATURE = re.compile(r"^\s*(FA?)\(([^)]*)\)\s*=\s*FEAT/(POINT|CIRCLE|CYLNDR)\s*,(.*)$", re.I)
_UNITS = re.compile(r"^\s*UNITS/\s*(\w+)", re.I)
_MM = {"MM": 1.0, "CM": 10.0, "M": 1e3, "INCH": 25.4}
#: numbers that each kind has at least: place and direction, and a diameter
_COUNT = {"POINT": 6, "CIRCLE": 7, "CYLNDR": 7}


@dataclass(frozen=True)
class _Feature:
    """A feature of the file, numbers in mm."""

    kind: str
    numbers: np.ndarray
    line: int


class DmisOutput(Importer):
    """Points to measured points, circles and cylinders to holes."""

    name = "dmis"
    title = "DMIS output of a coordinate measuring machine"
    reads = ".dmo, .dmi, .out: F( )=FEAT and FA( )=FEAT of points, circles and cylinders"
    rank = 22
    keys = {"u_um": "standard uncertainty of a measured hole"}

    def recognises(self, source: SourceFile) -> bool:
        if not source.is_text or source.path.is_dir():
            return False
        return any(_FEATURE.match(line) or line.startswith("DMISMN/") for line in source.lines)

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        nominal, actual = _features(source)
        both = [label for label in actual if label in nominal]
        lost = [label for label in actual if label not in nominal]
        if not both:
            raise source.error(
                f"{len(nominal)} nominal and {len(actual)} measured features, none of them both",
                line=1,
                accepted="F(label)=FEAT/POINT,CART,... with FA(label)=FEAT/POINT,CART,...",
                hint="tolerances alone (TA) say no places; export the features as well",
            )
        for label in both:
            if nominal[label].kind != actual[label].kind:
                raise source.error(
                    f"{label} is a {actual[label].kind}, its nominal a {nominal[label].kind}",
                    line=actual[label].line,
                    accepted="the same kind of feature",
                )
        told = (f"{len(lost)} measured features have no nominal one",) if lost else ()
        return features_imported(
            [(label, nominal[label].kind, nominal[label].numbers, actual[label].numbers)
             for label in both],
            source, questions, told,
        )  # fmt: skip


def features_imported(
    features: list[tuple[str, str, np.ndarray, np.ndarray]],
    source: SourceFile,
    questions: Questions,
    told: tuple[str, ...] = (),
) -> Imported:
    """Measured features as the project's own files.

    Parameters
    ----------
    features : list of (label, kind, nominal, actual)
        ``POINT`` with x, y, z, i, j, k; any other kind with a diameter behind them, in mm.
    source : SourceFile
    questions : Questions
    told : tuple of str
    """
    points = [f for f in features if f[1] == "POINT"]
    holes = [f for f in features if f[1] != "POINT"]
    upright = [f for f in holes if abs(f[2][5]) > 0.999]
    if len(upright) < len(holes):
        count = len(holes) - len(upright)
        told += (f"{count} circles or cylinders that do not stand upright are left out",)
    found = []
    if points:
        labels = [label for label, *_ in points]
        nominal, actual = (np.array([f[k] for f in points]) for k in (2, 3))
        length = np.linalg.norm(nominal[:, 3:6], axis=1)
        if (length < 0.5).any():
            label = labels[int(np.argmax(length < 0.5))]
            raise source.error(f"{label} has no normal", line=1, accepted="i, j, k of its nominal")
        normal = nominal[:, 3:6] / length[:, None]
        measured = Points(labels, labels, nominal[:, :3], normal, actual[:, :3])
        found.append(points_file(measured, source))
    if upright:
        nominal, actual = (np.array([f[k] for f in upright]) for k in (2, 3))
        own = Holes([f[0] for f in upright], nominal[:, :2], actual[:, :2], nominal[:, 6],
                    actual[:, 6])  # fmt: skip
        found.append(holes_file(own, source, questions))
    if not found:
        raise source.error("no point and no upright hole", line=1, accepted="points or holes")
    return Imported.joined(found, told)


def _features(source: SourceFile) -> tuple[dict[str, _Feature], dict[str, _Feature]]:
    """Nominal and measured features by their labels."""
    found: dict[str, dict[str, _Feature]] = {"F": {}, "FA": {}}
    factor = 1.0
    for number, line in _joined(source):
        unit = _UNITS.match(line)
        if unit:
            if unit[1].upper() not in _MM:
                accepted = ", ".join(_MM)
                raise source.error(f"UNITS/{unit[1]}", line=number, accepted=accepted)
            factor = _MM[unit[1].upper()]
        match = _FEATURE.match(line)
        if match is None:
            continue
        which, label, kind = match[1].upper(), match[2].strip(), match[3].upper()
        words = [word.strip() for word in match[4].split(",")]
        if "POL" in words:
            raise source.error(f"{label} is polar", line=number, accepted="CART")
        cells = [word for word in words if not word.isalpha()]
        values = np.array([decimal_number(word) for word in cells[: _COUNT[kind]]])
        if len(values) < _COUNT[kind] or not np.isfinite(values).all() or np.max(abs(values)) > 1e6:
            raise source.error(
                f"'{line.strip()[:60]}'", line=number, accepted=f"{_COUNT[kind]} numbers of {kind}"
            )
        if label in found[which]:
            raise source.error(f"{which}({label}) is there twice", line=number, accepted="once")
        values[:3] *= factor
        values[6:] *= factor
        found[which][label] = _Feature(kind, values, number)
    return found["F"], found["FA"]


def _joined(source: SourceFile) -> list[tuple[int, str]]:
    """Lines, with those that end with ``$`` joined to the next one."""
    found, begun, start = [], "", 0
    for number, line in enumerate(source.lines, 1):
        start = start or number
        if line.rstrip().endswith("$") and not line.lstrip().startswith("$$"):
            begun += line.rstrip()[:-1]
            continue
        found.append((start, begun + line))
        begun, start = "", 0
    return [*found, (start, begun)] if begun else found
