"""Plain component tables: one CSV an error, in the terms of ISO 230-1 and ISO/TR 16907.

This form is our own, for controls and programs that none of the other formats serves:

* ``chain.json``: order of the axes from the workpiece to the tool, squareness in rad, the names of
  the tables, and what the signs mean;
* ``EXX.csv`` and the like: ``position_mm, forward_um, backward_um`` (``_urad`` for angles), the
  error approaching in positive and in negative direction; linear between positions. Lines with
  ``#`` are comments. vmach's machine file reads the same tables.

Errors are those of the tool relative to the workpiece, actual minus nominal, right-handed, stated
at the spindle nose with every axis at home (`vmach.controller_tables.rigid_chain`).

Source: ISO 230-1 (errors), ISO/TR 16907 (numerical compensation of geometric errors).
"""

from __future__ import annotations

import json
from collections.abc import Mapping
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

__all__ = ["FORMATS", "read_components", "write_components"]

_MEANING = {
    "schema": 1,
    "sign": "tool relative to workpiece, actual minus nominal, rotations right-handed",
    "origin": "spindle nose with every axis at home",
    "model": "tip = S1 E1 S2 E2 S3 E3 (0, 0, -tool length), axes from the workpiece to the tool",
    "holds": "18 component errors with reversal, squareness, any tool length",
    "does_not_hold": "the tilt of the tool is known but three axes cannot correct it",
}


def write_components(folder: Path, chain: RigidChain) -> list[Path]:
    """Write ``chain.json`` and one CSV for each error."""
    record = {
        "order": chain.order,
        "squareness_rad": chain.squareness_rad,
        "tables": sorted(chain.tables),
        **_MEANING,
    }
    head = folder / "chain.json"
    head.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    written = [head]
    for name, (position, *ways) in sorted(chain.tables.items()):
        unit = "urad" if name[1] in "ABC" else "um"
        factor = 1e6 if unit == "urad" else 1e3
        up, down = (factor * way for way in ways)
        lines = [f"# {name}: {_MEANING['sign']}; at the {_MEANING['origin']}",
                 f"position_mm,forward_{unit},backward_{unit}"]  # fmt: skip
        rows = zip(position, up, down, strict=True)
        lines += [f"{q:.4f},{a:.4f},{b:.4f}" for q, a, b in rows]
        path = folder / f"{name}.csv"
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        written.append(path)
    return written


def read_components(folder: Path) -> RigidChain:
    """Read ``chain.json`` and the tables that it names.

    Raises
    ------
    InputError
        A file that is missing or not of this form.
    """
    head = folder / "chain.json"
    accepted = '{"order": "XYZ", "squareness_rad": {...}, "tables": [...]}'
    try:
        record = json.loads(read_text(head, what="chain"))
        found = RigidChain(record["order"], squareness_rad=dict(record["squareness_rad"]))
        names = list(record["tables"])
    except json.JSONDecodeError as error:
        raise InputError(
            f"no chain: {error.msg}", file=head, line=error.lineno, accepted=accepted
        ) from None
    except (ValueError, RecursionError, KeyError, TypeError) as error:
        raise InputError(
            f"no chain: {type(error).__name__} {error}", file=head, line=1, accepted=accepted
        ) from None
    for name in names:
        found.tables[name] = _table(folder / f"{name}.csv")
    return found


def _table(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    text = read_text(path, what="error table")
    lines = [(k, row) for k, row in enumerate(text.splitlines(), 1) if row and row[0] != "#"]
    header = [cell.strip() for cell in lines[0][1].split(",")] if lines else []
    unit = "urad" if "forward_urad" in header else "um"
    keys = ("position_mm", f"forward_{unit}", f"backward_{unit}")
    accepted = "position_mm, forward_um, backward_um (or _urad), and numbers below"
    if not set(keys) <= set(header):
        said = f"no error table: it begins with {','.join(header)!r}"
        raise InputError(said, file=path, line=1, accepted=accepted)
    rows = []
    for number, line in lines[1:]:
        values = [decimal_number(cell) for cell in line.split(",")]
        if len(values) != len(header) or not np.isfinite(values).all():
            raise InputError(f"row '{line}'", file=path, line=number, accepted=accepted)
        rows.append([values[header.index(key)] for key in keys])
    if not rows:
        raise InputError("no rows below the heading", file=path, line=1, accepted=accepted)
    position, up, down = np.array(rows).T
    scale = 1e-6 if unit == "urad" else 1e-3
    return position, scale * up, scale * down


def _write(
    folder: Path, task: TableTask, knots: tuple[Knots, Knots, Knots], options: Mapping[str, Any]
) -> list[Path]:
    return write_components(folder, fitted_chain(task, knots, by_direction=True))


def errors_of_components(folder: Path, options: Mapping[str, Any]) -> HeldErrors:
    """The tables as they stand: they hold errors."""
    chain = read_components(folder)
    return HeldErrors(chain.tables, chain.squareness_rad, chain.order)


FORMATS = (
    TableFormat(
        name="components",
        rank=50,
        title="component tables in the terms of ISO 230-1 and ISO/TR 16907 (our own form)",
        holds="18 component errors with reversal and squareness, any tool length",
        lacks="tilt",
        most_entries=UNLIMITED_ENTRIES,
        write=_write,
        read=lambda folder, options: read_components(folder),
        errors=errors_of_components,
        sign="chain.json",
    ),
)
