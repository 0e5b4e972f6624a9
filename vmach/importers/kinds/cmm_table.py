"""Reports of coordinate measuring machines as plain tables: nominal and measured coordinates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vmach.importers.importer import Imported, Importer
from vmach.importers.loose_table import LENGTH, NUMBER, Column, LooseTable
from vmach.importers.measured_points import (
    Holes,
    Points,
    holes_file,
    normals_on_part,
    points_file,
    sized_holes,
)
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile

__all__ = ["CmmTable"]

_NOMINAL = {
    a: Column(f"{a}", (a, f"nom {a}", f"nominal {a}", f"{a} nom", f"{a} nominal", f"soll {a}",
                       f"{a} soll", f"{a}n", f"nom{a}"), LENGTH, "mm")
    for a in "xyz"
}  # fmt: skip
_MEASURED = {
    a: Column(f"m{a}", (f"m{a}", f"meas {a}", f"measured {a}", f"{a} meas", f"{a} measured",
                        f"actual {a}", f"{a} actual", f"ist {a}", f"{a} ist", f"act {a}",
                        f"{a} act", f"{a}m", f"act{a}", f"meas{a}"), LENGTH, "mm")
    for a in "xyz"
}  # fmt: skip
_NORMAL = tuple(
    Column(
        n,
        (n, f"nominal {n}", f"nom {n}", f"n{a}", f"normal {a}", f"{n} nom"),
        NUMBER,
        is_needed=False,
    )
    for n, a in zip("ijk", "xyz", strict=True)
)
_NAME = Column("id", ("id", "name", "point", "nr", "no", "label", "number", "punkt", "hole"),
               is_needed=False, is_text=True)  # fmt: skip
_FEATURE = Column("feature", ("feature", "element", "face", "merkmal", "surface"),
                  is_needed=False, is_text=True)  # fmt: skip
_DIAMETERS = (
    Column("d", ("d", "nom d", "nominal d", "nominal diameter", "d nom", "diameter nominal",
                 "nom diameter"), LENGTH, "mm"),
    Column("md", ("md", "meas d", "measured d", "measured diameter", "d meas", "actual diameter",
                  "diameter measured", "diameter actual", "meas diameter"), LENGTH, "mm"),
)  # fmt: skip


class CmmTable(Importer):
    """Points with nominal place, normal and measured place; or holes with their diameters."""

    name = "cmm_table"
    title = "CMM report as a table"
    reads = "CSV or text: x y z, mx my mz, i j k (else from the CAD); or of holes x y, mx my, d, md"
    rank = 28
    keys = {"u_um": "standard uncertainty of a measured hole", "unit": "of the coordinates"}

    def recognises(self, source: SourceFile) -> bool:
        return _points(source, Questions()) is not None or _holes(source, Questions()) is not None

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        table = _points(source, questions)
        if table is not None:
            return points_file(_as_points(table, questions), source)
        table = _holes(source, questions)
        if table is None:
            raise source.error(
                "no heading with nominal and measured coordinates",
                accepted="x y z mx my mz and i j k or --job, or of holes x y mx my, and d md where "
                "diameters were measured",
                hint="--column mx='Measured X' and the like name other headings",
            )
        number = np.arange(1, len(table.lines) + 1).astype(str)
        centre, found = (np.column_stack([table.complete(f"{m}{a}") for a in "xy"])
                         for m in ("", "m"))  # fmt: skip
        sizes = (table.numbers.get("d"), table.numbers.get("md"))
        holes, told = sized_holes(Holes(table.text.get("id", number), centre, found, *sizes))
        return holes_file(holes, source, questions, told)


def _points(source: SourceFile, questions: Questions) -> LooseTable | None:
    places = (*_MEASURED.values(), *_NOMINAL.values())
    return _find(source, questions, (*places, *_NORMAL, _NAME, _FEATURE))


def _holes(source: SourceFile, questions: Questions) -> LooseTable | None:
    across = [columns[a] for columns in (_MEASURED, _NOMINAL) for a in "xy"]
    sized = _find(source, questions, (*across, *_DIAMETERS, _NAME))
    if sized is not None or _find(source, questions, (*across, _MEASURED["z"])) is not None:
        return sized  # with a measured height it is of points
    maybe = tuple(replace(column, is_needed=False) for column in _DIAMETERS)
    return _find(source, questions, (*across, *maybe, _NAME))


def _find(
    source: SourceFile, questions: Questions, columns: tuple[Column, ...]
) -> LooseTable | None:
    """The table with these columns; lengths without a unit are in the one that is told, else mm."""
    unit = questions.unit()
    own = tuple(replace(c, unit=unit) if unit and c.units is LENGTH else c for c in columns)
    return LooseTable.find(source, own, given=questions.columns)


def _as_points(table: LooseTable, questions: Questions) -> Points:
    nominal, measured = (
        np.column_stack([table.complete(f"{m}{a}") for a in "xyz"]) for m in ("", "m")
    )
    number = np.arange(1, len(table.lines) + 1).astype(str)
    feature = table.text.get("feature", np.full(len(number), ""))
    name = table.text.get("id", number)
    if set("ijk") <= table.numbers.keys():
        normal = _normals(table)
    else:
        normal = normals_on_part(nominal, table.source, questions, table.lines)
    return Points(name, feature, nominal, normal, measured)


def _normals(table: LooseTable) -> np.ndarray:
    """Unit vectors, (P, 3)."""
    normal = np.column_stack([table.complete(n) for n in "ijk"])
    length = np.linalg.norm(normal, axis=1)
    if (length < 0.5).any():
        line = int(table.lines[np.argmax(length < 0.5)])
        raise table.source.error("the normal is no direction", line=line, accepted="i, j, k")
    return normal / length[:, None]
