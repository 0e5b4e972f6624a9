"""ISG kernel and Beckhoff TwinCAT CNC (TF5280): volumetric compensation.

Source: Beckhoff/ISG "Volumetric compensation" (FCT-C26): sections on the ISG CSV format, units of
measure (offsets mm, angles rad, axis values mm), interpolation mode GRID (linear), tool length
(parameters N0X N0Y N0Z), and the compensation parameters P-VOLC-00001 and following.

* a header names argument and errors, ``X EXX EYX EZX EAX EBX ECX``; ``//`` begins a comment, ``#``
  a new header; squareness in a block without argument, ``C0Y``;
* ``chain`` names the axes in their order. Here all stand on the tool side (``workpiece_axes 0``),
  in the order from the workpiece to the tool, with every error that of the tool relative to the
  workpiece: the sign of an axis that carries the workpiece then needs no agreement;
* only the position of the tip is compensated, not the tilt; one direction.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from vmach.controller_tables.fitted_chain import fitted_chain
from vmach.controller_tables.knots import Knots
from vmach.controller_tables.rigid_chain import RigidChain
from vmach.controller_tables.table_format import UNLIMITED_ENTRIES, HeldErrors, TableFormat
from vmach.controller_tables.table_task import TableTask
from vmach.errors import InputError
from vmach.files.text_file import decimal_number, read_text

__all__ = ["FORMATS", "read_isg", "write_isg"]

_HEAD = """// ISG CSV, volumetric compensation; axis values and errors in mm, angles in rad
// errors: tool relative to workpiece, actual minus nominal, right-handed, stated at the
// spindle nose with every axis at home
// holds: all 18 component errors, squareness, any tool length
// does not hold: reversal (the mean of both directions stands here), the tilt of the tool
"""
_LIST = """# compensation list; check axis numbers, paths and, with one move, the sign (negate)
x                  1
y                  2
z                  3
chain              {order}
workpiece_axes     0
interpolation      GRID
file[0]            volcomp.csv
file_format[0]     ISG_CSV
file[1]            volcomp_tool.csv
file_format[1]     ISG_CSV
"""
_TOOL = """// direction from the spindle nose to the tool tip: tool length counts
N0X N0Y N0Z
0 0 -1
"""
_MM_DIGITS, _RAD_DIGITS = 7, 10


def write_isg(folder: Path, chain: RigidChain) -> list[Path]:
    """Write ``volcomp.csv``, ``volcomp_tool.csv`` and the list ``volcomp.lis``."""
    blocks = [block for axis in "XYZ" if (block := _axis_block(chain, axis))]
    if chain.squareness_rad:
        names, values = zip(*chain.squareness_rad.items(), strict=True)
        cells = " ".join(f"{value:.{_RAD_DIGITS}f}" for value in values)
        blocks.append(f"{' '.join(name[1:] for name in names)}\n{cells}\n")
    texts = {
        "volcomp.csv": _HEAD + "#\n".join(blocks),
        "volcomp_tool.csv": _TOOL,
        "volcomp.lis": _LIST.format(order=chain.order),
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    return [folder / name for name in texts]


def _axis_block(chain: RigidChain, axis: str) -> str:
    names = [name for kind in "XYZABC" if (name := f"E{kind}{axis}") in chain.tables]
    if not names:
        return ""
    columns = []
    for name in names:
        _, up, down = chain.tables[name]
        digits = _RAD_DIGITS if name[1] in "ABC" else _MM_DIGITS
        columns.append([f"{value:.{digits}f}" for value in 0.5 * (up + down)])
    position = [f"{q:.4f}" for q in chain.tables[names[0]][0]]
    rows = zip(position, *columns, strict=True)
    return "\n".join(" ".join(row) for row in [[axis, *names], *rows]) + "\n"


def read_isg(folder: Path) -> RigidChain:
    """Read the list and the parameter files that it names.

    Raises
    ------
    InputError
        A cell that is no number, a row of another width than its header, an axis on the side of
        the workpiece, a tool direction that is not along -Z.
    """
    settings = dict(_settings(folder / "volcomp.lis"))
    if settings.get("workpiece_axes", "0") != "0":
        axes = settings["workpiece_axes"]
        raise InputError(
            f"workpiece_axes = {axes}", file=folder / "volcomp.lis", line=1, accepted="0"
        )
    found = RigidChain(settings["chain"])
    for key, name in settings.items():
        if not key.startswith("file["):
            continue
        for header, values in _blocks(folder / name):
            _store(found, header, values, folder / name)
    return found


def _settings(path: Path) -> Iterator[tuple[str, str]]:
    for line in read_text(path, what="compensation list").splitlines():
        words = line.split("#")[0].split()
        if len(words) == 2:
            yield words[0], words[1]


def _blocks(path: Path) -> Iterator[tuple[list[str], np.ndarray]]:
    header: list[str] = []
    rows: list[list[float]] = []
    for number, line in enumerate(read_text(path, what="parameter file").splitlines(), 1):
        content, is_end, _ = line.split("//")[0].partition("#")
        words = content.split()
        if words and not header:
            header = words
        elif words:
            rows.append(_row(words, header, path, number))
        if is_end and header:
            yield header, _block(header, rows, path, number)
            header, rows = [], []
    if header:
        yield header, _block(header, rows, path, number)


def _row(words: list[str], header: list[str], path: Path, line: int) -> list[float]:
    values = [decimal_number(word) for word in words]
    if len(values) != len(header) or not np.isfinite(values).all():
        raise InputError(
            f"row '{' '.join(words)}' below '{' '.join(header)}'", file=path, line=line,
            accepted=f"rows of {len(header)} numbers",
        )  # fmt: skip
    return values


def _block(header: list[str], rows: list[list[float]], path: Path, line: int) -> np.ndarray:
    if not rows:
        raise InputError(f"block '{' '.join(header)}' has no rows", file=path, line=line,
                         accepted=f"rows of {len(header)} numbers")  # fmt: skip
    return np.array(rows)


def _store(chain: RigidChain, header: list[str], values: np.ndarray, path: Path) -> None:
    if header[0] == "N0X":
        if not np.array_equal(values, [[0.0, 0.0, -1.0]]):
            raise InputError(f"tool direction {values[0]}", file=path, line=1, accepted="0 0 -1")
    elif header[0] in "XYZ":
        for name, column in zip(header[1:], values.T[1:], strict=True):
            chain.tables[name] = (values[:, 0], column, column)
    else:
        for name, value in zip(header, values[0], strict=True):
            chain.squareness_rad[f"E{name}"] = float(value)


def _write(
    folder: Path, task: TableTask, knots: tuple[Knots, Knots, Knots], options: Mapping[str, Any]
) -> list[Path]:
    return write_isg(folder, fitted_chain(task, knots, by_direction=False))


def errors_of_isg(folder: Path, options: Mapping[str, Any]) -> HeldErrors:
    """The tables as they stand: they hold errors."""
    chain = read_isg(folder)
    return HeldErrors(chain.tables, chain.squareness_rad, chain.order)


FORMATS = (
    TableFormat(
        name="isg",
        rank=40,
        title="ISG and Beckhoff TwinCAT volumetric compensation (ISG CSV)",
        holds="18 component errors and squareness, any tool length",
        lacks="reversal, tilt",
        most_entries=UNLIMITED_ENTRIES,
        write=_write,
        read=lambda folder, options: read_isg(folder),
        errors=errors_of_isg,
        sign="volcomp.lis",
    ),
)
