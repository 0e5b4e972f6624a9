"""Surface points: where a part is inspected, and what was measured there."""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vmach.base.note import Kind, Note, in_file
from vmach.base.units import mm_from_um
from vmach.errors import InputError
from vmach.files.text_file import (
    DECIMAL_COMMA_HINT,
    column_hint,
    decimal_number,
    numbered_csv_rows,
    read_text,
)
from vmach.nominal.mesh.unique_rows import unique_rows

__all__ = ["COORDINATE_UNITS", "WHEN", "SurfacePoints", "read_points_csv", "when_measured"]

#: how far the length of a normal in a file may be from 1
UNIT_TOLERANCE = 1e-3

#: beyond this, mm or um, a number in a file is a slip
_LARGEST = 1e6
#: smallest standard uncertainty, um: below an atom's thousandth part a reading is a slip, and
#: would outweigh all others beyond the digits of a double
FINEST_U_UM = 1e-6
#: of a clock, s: those that count from 1970 are near 2e9
_LATEST = 1e11

#: units that coordinates may be in by mistake: how long a millimetre is in them
COORDINATE_UNITS = {"metres": 1e-3, "inches": 1 / 25.4, "centimetres": 0.1, "um": 1e3}

_NOMINAL = ("x", "y", "z", "i", "j", "k")
_MEASURED = ("mx", "my", "mz")
#: when a point was measured: the clock of the device in s, or its number in the order
WHEN = ("measured_s", "order")
_KNOWN = ("id", "feature", *_NOMINAL, *_MEASURED, "u_um", "clamping", *WHEN)


@dataclass(frozen=True)
class SurfacePoints:
    """P points of the nominal surface, in workpiece coordinates. Arrays are read-only.

    Attributes
    ----------
    id : (P,) str
        Name of each point, as the file or the sampling gave it.
    feature : (P,) str
        Which face or feature of the part the point lies on; may be empty.
    point_mm : (P, 3) float64
        The nominal point.
    normal : (P, 3) float64
        Outward unit normal of the nominal surface, away from the material.
    measured_mm : (P, 3) float64, optional
        Where a CMM found the surface.
    u_mm : (P,) float64, optional
        Standard uncertainty of the measured deviation.
    notes : tuple of Note
        What the reader noticed and survived, one sentence each.
    weight : (P,) float64, optional
        How much a point counts in means and shares; 1 for all without it. Points along the edges
        of narrow faces share the weight of one.
    clamping : (P,) str, optional
        In which clamping on the measuring machine each point was measured.
    measured_at : (P,) float64, optional
        When: seconds on the clock of the measuring machine, or numbers in the order of measuring.
    line : (P,) int, optional
        Of the file that each point was read from.
    """

    id: np.ndarray
    feature: np.ndarray
    point_mm: np.ndarray
    normal: np.ndarray
    measured_mm: np.ndarray | None = None
    u_mm: np.ndarray | None = None
    notes: tuple[Note, ...] = ()
    weight: np.ndarray | None = None
    clamping: np.ndarray | None = None
    measured_at: np.ndarray | None = None
    line: np.ndarray | None = None

    def __post_init__(self) -> None:
        count = len(self.point_mm)
        shapes = {
            "point_mm": (count, 3),
            "normal": (count, 3),
            "measured_mm": (count, 3),
            "u_mm": (count,),
            "weight": (count,),
            "measured_at": (count,),
        }
        for name, shape in shapes.items():
            value = getattr(self, name)
            if value is not None:
                self._freeze(name, np.ascontiguousarray(value, dtype=np.float64), shape)
        for name in ("id", "feature", "clamping"):
            if getattr(self, name) is not None:
                self._freeze(name, np.asarray(getattr(self, name), dtype=str), (count,))
        if self.line is not None:
            self._freeze("line", np.asarray(self.line, dtype=np.int64), (count,))
        off = np.abs(np.linalg.norm(self.normal, axis=1) - 1.0)
        if count and off.max() > 1e-9:
            worst = self.normal[int(off.argmax())]
            raise ValueError(f"SurfacePoints.normal holds {worst}, which is no unit vector")
        object.__setattr__(self, "notes", tuple(self.notes))

    def _freeze(self, name: str, array: np.ndarray, shape: tuple[int, ...]) -> None:
        if array.shape != shape:
            raise ValueError(f"SurfacePoints.{name} has shape {array.shape}; expected {shape}")
        if array.dtype == np.float64 and not np.isfinite(array).all():
            raise ValueError(f"SurfacePoints.{name} holds values that are not finite")
        array = array.copy() if array.flags.writeable else array
        array.setflags(write=False)
        object.__setattr__(self, name, array)

    def __len__(self) -> int:
        return len(self.point_mm)

    @property
    def measured_deviation_mm(self) -> np.ndarray:
        """Measured deviation (m - p).n, (P,) mm, positive where material is left."""
        if self.measured_mm is None:
            raise InputError(
                "these surface points were not measured",
                accepted="a points file with the columns mx, my, mz",
            )
        return np.einsum("ij,ij->i", self.measured_mm - self.point_mm, self.normal)


def read_points_csv(path: str | Path) -> SurfacePoints:
    """Read surface points from ``id, feature, x, y, z, i, j, k[, mx, my, mz][, u_um]``.

    Lengths in mm, normals unit vectors (length within 1e-3 of 1, then normalised), uncertainty
    in um; a column `clamping` names clampings on the measuring machine, `measured_s` holds its
    clock, or `order` the order of measuring. The order of the columns is free; empty lines and
    lines that begin with ``#`` are skipped. Points that occur twice, names that occur twice and
    unknown columns are kept or ignored and said in `notes`.

    Raises
    ------
    InputError
        The file cannot be read, a column is missing, or a value is not a finite number. A normal
        is no unit vector, or an uncertainty is not positive. Both a clock and an order are there.
    """
    path = Path(path)
    columns, rows, lines = _read_rows(path)
    table = _Table(path, columns, rows, lines)
    normal = table.vectors(_NOMINAL[3:])
    length = np.linalg.norm(normal, axis=1)
    table.check(
        np.abs(length - 1.0) <= UNIT_TOLERANCE,
        lambda row: f"the normal i, j, k has length {length[row]:.6g}",
        accepted="a unit vector, length 1 within 0.001",
    )
    measured_mm = table.vectors(_MEASURED) if table.has_all(_MEASURED) else None
    points = SurfacePoints(
        id=table.text("id"),
        feature=table.text("feature"),
        point_mm=table.vectors(_NOMINAL[:3]),
        normal=normal / length[:, None],
        measured_mm=measured_mm,
        u_mm=_read_uncertainty(table),
        clamping=table.text("clamping") if table.has_all(("clamping",)) else None,
        measured_at=when_measured(
            {name: table.vectors((name,))[:, 0] for name in WHEN if table.has_all((name,))}, path
        ),
        line=lines,
    )
    notes = in_file(_notes_on(points, [n for n in columns if n not in _KNOWN]), path)
    return replace(points, notes=notes)


def _read_uncertainty(table: _Table) -> np.ndarray | None:
    if not table.has_all(("u_um",)):
        return None
    u_um = table.vectors(("u_um",))[:, 0]
    table.check(
        u_um >= FINEST_U_UM,
        lambda row: f"the standard uncertainty u_um is {u_um[row]:g}",
        accepted=f"{FINEST_U_UM:g} um or more",
    )
    return mm_from_um(u_um)


def when_measured(numbers: Mapping[str, np.ndarray], path: Path) -> np.ndarray | None:
    """The column that says when readings were taken, (P,); None where none does.

    Raises
    ------
    InputError
        Both a clock and an order are there.
    """
    found = [numbers[name] for name in WHEN if name in numbers]
    if len(found) > 1:
        raise InputError(
            f"both {' and '.join(WHEN)} say when the readings were taken",
            file=path,
            line=1,
            accepted="one of these columns",
        )
    return found[0] if found else None


def _read_rows(path: Path) -> tuple[list[str], list[list[str]], np.ndarray]:
    """Names of the columns, the rows' cells and the line that each row ends on."""
    numbered = [
        (line, row)
        for line, row in _numbered_rows(path)
        if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
    ]
    if len(numbered) < 2:
        raise InputError(
            "no points in the file", file=path, accepted=f"a heading {', '.join(_KNOWN)} and rows"
        )
    header = [cell.strip().lower() for cell in numbered[0][1]]
    missing = [name for name in ("id", *_NOMINAL) if name not in header]
    missing += [n for n in _MEASURED if n not in header and set(_MEASURED) & set(header)]
    if missing:
        raise InputError(
            f"column {', '.join(missing)} is missing",
            file=path,
            line=numbered[0][0],
            accepted=", ".join(_KNOWN),
            hint=column_hint(header),
        )
    repeated = [name for name, times in Counter(header).items() if times > 1 and name in _KNOWN]
    if repeated:
        raise InputError(
            f"column {', '.join(repeated)} occurs twice", file=path, line=numbered[0][0]
        )
    lines = np.array([line for line, _ in numbered[1:]])
    return header, [row for _, row in numbered[1:]], lines


def _numbered_rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Every row with the line that it ends on; a quote without its partner begins on another."""
    return numbered_csv_rows(io.StringIO(read_text(path, what="points file")), path, strict=True)


class _Table:
    """Cells of one points file, turned into numbers with the line at fault in every error."""

    def __init__(
        self, path: Path, columns: list[str], rows: list[list[str]], lines: np.ndarray
    ) -> None:
        self._path, self._lines = path, lines
        for row, line in zip(rows, lines, strict=True):
            if len(row) != len(columns):
                raise InputError(
                    f"{len(row)} values in the row",
                    file=path,
                    line=int(line),
                    accepted=f"{len(columns)} values, one for each column of the heading",
                    hint=DECIMAL_COMMA_HINT if len(row) > len(columns) else None,
                )
        self._cells = dict(zip(columns, zip(*rows, strict=True), strict=True))

    def has_all(self, names: tuple[str, ...]) -> bool:
        return all(name in self._cells for name in names)

    def text(self, name: str) -> np.ndarray:
        """Cells of a column without blanks at their ends, (P,) str; empty where it is missing."""
        cells = self._cells.get(name, ("",) * len(self._lines))
        return np.array([cell.strip() for cell in cells], dtype=str)

    def vectors(self, names: tuple[str, ...]) -> np.ndarray:
        """Numbers of some columns, (P, K)."""
        return np.column_stack([self._numbers(name) for name in names])

    def check(self, good: np.ndarray, what, *, accepted: str) -> None:
        """Raise for the first row that is not good, (P,) bool; `what` words it from its index."""
        if not good.all():
            row = int(np.argmin(good))
            raise InputError(
                what(row), file=self._path, line=int(self._lines[row]), accepted=accepted
            )

    def _numbers(self, name: str) -> np.ndarray:
        cells = self._cells[name]
        everything = "".join(cells)
        try:
            if "_" in everything or not everything.isascii():
                raise ValueError("digits that Python alone takes for a number")
            values = np.array(cells, dtype=np.float64)
        except ValueError:
            values = np.array([decimal_number(cell) for cell in cells])
        largest = _LATEST if name in WHEN else _LARGEST
        what = "seconds of its clock, no time of day: " if name == WHEN[0] else ""
        self.check(
            np.abs(values) <= largest,
            lambda row: f"{name} is {cells[row].strip()!r}",
            accepted=f"{what}a finite number, {largest:g} at most",
        )
        return values


def _notes_on(points: SurfacePoints, unknown: list[str]) -> list[Note]:
    """What is odd about the points of a file, and its columns without use."""
    assert points.line is not None
    notes = [
        Note.plain(Kind.COLUMN, f"column {name!r} is not used", place=name) for name in unknown
    ]
    repeated = [name for name, times in Counter(points.id.tolist()).items() if times > 1]
    if repeated:
        said = f"id {repeated[0]!r} occurs more than once"
        if len(repeated) > 1:
            said += f", and so {len(repeated) - 1} more"
        again_at = int(points.line[np.flatnonzero(points.id == repeated[0])[1]])
        size = len(repeated)
        notes.append(Note.plain(Kind.NAME, said, size, "1", place=repeated[0], line=again_at))
    distinct, _, _ = unique_rows(np.hstack([points.point_mm, points.normal]))
    if again := len(points) - len(distinct):
        said = f"{again} points repeat an earlier point; all are kept"
        notes.append(Note.plain(Kind.REPEAT, said, again, "1"))
    if points.measured_mm is not None:
        notes.extend(_notes_on_units(points))
    return notes


def _notes_on_units(points: SurfacePoints) -> list[Note]:
    """Say it when the measured points look scaled against the nominal ones."""
    size = np.linalg.norm(np.ptp(points.point_mm, axis=0))
    measured = np.linalg.norm(np.ptp(points.measured_mm, axis=0))
    for unit, factor in COORDINATE_UNITS.items():
        if size > 0.0 and abs(measured / (size * factor) - 1.0) < 0.05:
            said = f"the measured points look like {unit}, the nominal ones like mm"
            return [Note.question(Kind.UNIT, said, float(measured / size), "1", place="mx my mz")]
    far = float(np.median(np.linalg.norm(points.measured_mm - points.point_mm, axis=1)))
    if far > 1.0:
        said = f"the measured points are {far:.3g} mm from the nominal ones (median)"
        return [Note.question(Kind.FAR, said, far, "mm")]
    return []
