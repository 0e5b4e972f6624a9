"""deviations.csv: every inspected point, one row each, two fields for each column of deviations."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from vmach.base.units import mm_from_um, um_from_mm
from vmach.errors import InputError
from vmach.files.atomic import atomic_file
from vmach.files.csv_table import Cells, fixed, whole, words, write_csv
from vmach.files.text_file import read_text
from vmach.report.result import Column, InspectedPoints

__all__ = ["read_deviations_csv", "write_deviations_csv"]

_POINT_COLUMNS = [
    *("id", "feature", "x", "y", "z", "i", "j", "k"),
    *("line", "tool", "move", "time_s", "u_um"),
]
_DEVIATION, _STATUS = "_deviation_um", "_status"


def write_deviations_csv(path: str | Path, points: InspectedPoints) -> None:
    """Write the points in mm, deviations in um; a point that is not cut has an empty deviation.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    with atomic_file(path) as temporary, temporary.open("wb") as file:
        write_csv(file, _columns(points))


def _columns(points: InspectedPoints) -> dict[str, Cells]:
    count, u_mm = len(points), points.u_mm
    places = zip("xyzijk", [*points.point_mm.T, *points.normal.T], strict=True)
    fields = {"id": words(points.id), "feature": words(points.feature)}
    fields |= {name: words([f"{x:.9g}" for x in column.tolist()]) for name, column in places}
    fields |= {name: whole(getattr(points, name)) for name in ("line", "tool", "move")}
    fields["time_s"] = fixed(points.time_s, 3)
    u_um = [""] * count if u_mm is None else [f"{u:.6g}" for u in um_from_mm(u_mm).tolist()]
    fields["u_um"] = words(u_um)
    weight = points.primary.weight
    if weight is not None:
        fields["weight"] = words([f"{x:.6g}" for x in weight.tolist()])
    for column in points.columns:
        deviation_um = um_from_mm(column.deviation_mm)
        fields[column.name + _DEVIATION] = fixed(deviation_um, 6, shown=column.is_cut)
        fields[column.name + _STATUS] = words(column.status)
    return fields


def read_deviations_csv(path: str | Path) -> InspectedPoints:
    """Read what `write_deviations_csv` wrote; labels of the columns are their names.

    Raises
    ------
    InputError
        The file is missing, empty, or lacks a column, or a cell is not a number.
    """
    path = Path(path)
    if not path.exists():
        raise InputError("no such file", file=path, hint="vmach run writes it")
    try:
        rows = list(csv.DictReader(read_text(path, what="table of deviations").splitlines()))
    except csv.Error as error:
        raise InputError(str(error), file=path, accepted="what vmach run wrote") from None
    names = [
        n.removesuffix(_DEVIATION) for n in (rows[0] if rows else ()) if n.endswith(_DEVIATION)
    ]
    missing = [name for name in _POINT_COLUMNS if not rows or name not in rows[0]]
    if missing or not names:
        lacks = ", ".join(missing) or f"NAME{_DEVIATION}"
        raise InputError(
            f"not a table of deviations: it lacks {lacks}",
            file=path,
            accepted="what vmach run wrote",
        )
    table = {name: [row[name] for row in rows] for name in rows[0]}
    try:
        return _points(table, names)
    except (TypeError, ValueError) as error:
        raise InputError(str(error), file=path, accepted="what vmach run wrote") from error


def _points(table: dict[str, list[str]], names: list[str]) -> InspectedPoints:
    numbers = {
        name: np.array([float(cell) if cell else np.nan for cell in column])
        for name, column in table.items()
        if name in (*_POINT_COLUMNS[2:], "weight") or name.endswith(_DEVIATION)
    }
    has_u = np.isfinite(numbers["u_um"]).all()
    return InspectedPoints(
        id=table["id"],
        feature=table["feature"],
        point_mm=np.stack([numbers[name] for name in "xyz"], axis=1),
        normal=np.stack([numbers[name] for name in "ijk"], axis=1),
        line=numbers["line"],
        tool=numbers["tool"],
        move=numbers["move"],
        time_s=numbers["time_s"],
        columns=tuple(
            Column(
                name,
                name,
                mm_from_um(numbers[name + _DEVIATION]),
                table[name + _STATUS],
                weight=numbers.get("weight"),
            )
            for name in names
        ),
        u_mm=mm_from_um(numbers["u_um"]) if has_u else None,
    )
