"""DMIS output: features as nominal ``F(label)=FEAT/...`` and as measured ``FA(label)=FEAT/...``.

Source: ISO 22093 (DMIS 5): FEAT/POINT,CART,x,y,z,i,j,k and FEAT/CIRCLE,INNER,CART,x,y,z,i,j,k,diam.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from vmach.files.text_file import decimal_number
from vmach.importers.importer import Imported, Importer
from vmach.importers.measured_points import (
    Holes,
    Points,
    holes_file,
    length_factor,
    points_file,
)
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile

__all__ = ["DmisOutput"]

_FEATURE = re.compile(r"^\s*(FA?)\(([^)]*)\)\s*=\s*FEAT/(POINT|CIRCLE|CYLNDR)\s*,(.*)$", re.I)
_UNITS = re.compile(r"^\s*UNITS/\s*(\w+)", re.I)
_MM = {"MM": 1.0, "CM": 10.0, "M": 1e3, "INCH": 25.4}
#: numbers that each kind has: place and direction, a diameter, and a cylinder perhaps its length
_COUNT = {"POINT": (6, 6), "CIRCLE": (7, 7), "CYLNDR": (7, 8)}


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
    keys = {
        "u_um": "standard uncertainty of a measured hole",
        "unit": "of lengths, where no UNITS stands above them",
    }

    def recognises(self, source: SourceFile) -> bool:
        if not source.is_text or source.path.is_dir():
            return False
        return any(_FEATURE.match(line) or line.startswith("DMISMN/") for line in source.lines)

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        nominal, actual = _features(source, questions)
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
        ``POINT`` with x, y, z, i, j, k; any other kind with a diameter behind them, in mm, NaN
        where none was measured.
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
    upright, unsized = _with_sizes(upright)
    told += unsized
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
        sizes = (nominal[:, 6], actual[:, 6]) if np.isfinite(actual[:, 6]).all() else (None, None)
        own = Holes([f[0] for f in upright], nominal[:, :2], actual[:, :2], *sizes)
        found.append(holes_file(own, source, questions))
    if not found:
        raise source.error("no point and no upright hole", line=1, accepted="points or holes")
    return Imported.joined(found, told)


def _with_sizes(
    holes: list[tuple[str, str, np.ndarray, np.ndarray]],
) -> tuple[list[tuple[str, str, np.ndarray, np.ndarray]], tuple[str, ...]]:
    """Holes whose diameter was measured, or all of them where none was; and what is said of it."""
    sized = [f for f in holes if np.isfinite(f[3][6])]
    if not sized and holes:
        return holes, ("no diameter was measured: the holes have places alone",)
    count = len(holes) - len(sized)
    said = f"{count} circles or cylinders without a measured diameter are left out"
    return sized, (said,) if count else ()


def _features(
    source: SourceFile, questions: Questions
) -> tuple[dict[str, _Feature], dict[str, _Feature]]:
    """Nominal and measured features by their labels."""
    found: dict[str, dict[str, _Feature]] = {"F": {}, "FA": {}}
    factor = None
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
        values = _cartesian(match[4], kind, source, number)
        if label in found[which]:
            raise source.error(f"{which}({label}) is there twice", line=number, accepted="once")
        if factor is None:  # UNITS may stand below, or in the program that the output belongs to
            factor = length_factor(source, questions, None)
        values[:3] *= factor
        values[6:] *= factor
        found[which][label] = _Feature(kind, values, number)
    return found["F"], found["FA"]


def _cartesian(text: str, kind: str, source: SourceFile, number: int) -> np.ndarray:
    """Place, direction and diameter of a feature as its line has them, in the file's unit.

    One number too many is a decimal comma, which would shift all that stand behind it.
    """
    words = [word.strip().upper() for word in text.split(",")]
    if "POL" in words:
        raise source.error("the feature is polar", line=number, accepted="CART")
    values = np.array([decimal_number(word) for word in words if not word.isalpha()])
    least, most = _COUNT[kind]
    is_wrong = not least <= len(values) <= most or not np.isfinite(values).all()
    if is_wrong or np.max(abs(values)) > 1e6:
        raise source.error(
            f"{kind} with '{text.strip()[:60]}'",
            line=number,
            accepted=f"{least} numbers with decimal points" + (", and a length" * (most > least)),
        )
    return values[:least]


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
