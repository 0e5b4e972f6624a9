"""LinuxCNC screw compensation: one file a joint, its own position only.

Source: LinuxCNC's "INI Configuration", [JOINT_n] COMP_FILE and COMP_FILE_TYPE, and its source,
``src/emc/motion/usrmotintf.cc`` (usrmotLoadComp), ``command.c`` (EMCMOT_SET_JOINT_COMP) and
``control.c`` (compute_screw_comp):

* three numbers a line, at most 256 lines, nominal positions increasing, in machine units;
* type 0: nominal, actual position moving up, actual position moving down; type 1: nominal and
  the two trims, trim = nominal - actual; the trim is added to the joint's commanded position;
* linear between nominals, the first and last trims are held beyond them;
* reading ends at the first line that is no three numbers, so comments can only stand at the end;
* BACKLASH is not used for a joint with a COMP_FILE.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vmach.controller_tables.knots import Knots
from vmach.controller_tables.projection import AxisTable, Term
from vmach.controller_tables.table_format import (
    LARGEST,
    HeldErrors,
    TableFormat,
    error_name,
    projected,
)
from vmach.controller_tables.table_task import TableTask
from vmach.errors import InputError
from vmach.files.text_file import decimal_number, read_text

__all__ = ["FORMATS", "MOST_ENTRIES", "ScrewCompensation", "read_linuxcnc", "write_linuxcnc"]

MOST_ENTRIES = 256
_AXES = "XYZ"
_MILLIMETRES = ("mm", "metric")
_STOPS = "LinuxCNC stops reading at the first line that is not three numbers"
_COMMENT = """# What stands below the numbers is not read by LinuxCNC.
# COMP_FILE_TYPE = {type}: {meaning}; mm, machine coordinates of joint {axis}.
# Holds the joint's own position and its reversal; no straightness, no angle, no other axis.
"""
_MEANING = {
    0: "nominal, actual moving in positive direction, actual moving in negative direction",
    1: "nominal, trim in positive direction, trim in negative direction (trim = nominal - actual)",
}


def write_linuxcnc(folder: Path, tables: Sequence[AxisTable], *, file_type: int) -> list[Path]:
    """Write ``x.comp`` and the like, and ``joints.ini`` with the lines that name them.

    Parameters
    ----------
    folder : Path
    tables : sequence of AxisTable
        Own-axis tables.
    file_type : {0, 1}
        COMP_FILE_TYPE.
    """
    ini = ["# lines for the INI file; joint 0 is X, 1 is Y, 2 is Z (trivkins)"]
    written = []
    for table in tables:
        axis = _AXES[table.term.input_axis]
        path = folder / f"{axis.lower()}.comp"
        base = table.position_mm if file_type == 0 else 0.0
        sign = -1.0 if file_type == 0 else 1.0
        columns = (base + sign * table.forward_mm, base + sign * table.backward_mm)
        rows = zip(table.position_mm, *columns, strict=True)
        lines = [f"{q:.4f} {up:.6f} {down:.6f}\n" for q, up, down in rows]
        end = _COMMENT.format(type=file_type, meaning=_MEANING[file_type], axis=axis)
        path.write_text("".join(lines) + end, encoding="utf-8")
        ini += [f"[JOINT_{table.term.input_axis}]", f"COMP_FILE = {path.name}",
                f"COMP_FILE_TYPE = {file_type}"]  # fmt: skip
        written.append(path)
    (folder / "joints.ini").write_text("\n".join(ini) + "\n", encoding="utf-8")
    return [*written, folder / "joints.ini"]


@dataclass(frozen=True)
class ScrewCompensation:
    """What LinuxCNC keeps of its files: nominal, forward trim, reverse trim by joint, (K, 3) mm.

    `unread` says in sentences which entries it does not keep.
    """

    joints: dict[int, np.ndarray]
    unread: tuple[str, ...] = ()

    def applied_correction(
        self, nose_mm: np.ndarray, direction: np.ndarray, tool_mm: np.ndarray
    ) -> np.ndarray:
        """What is added to the commanded positions, (P, 3) mm; unknown directions take the mean."""
        found = np.zeros_like(nose_mm)
        for joint, entries in self.joints.items():
            at, way = nose_mm[:, joint], direction[:, joint]
            up = np.interp(at, entries[:, 0], entries[:, 1])
            down = np.interp(at, entries[:, 0], entries[:, 2])
            found[:, joint] = np.where(way > 0, up, np.where(way < 0, down, 0.5 * (up + down)))
        return found


def read_linuxcnc(folder: Path) -> ScrewCompensation:
    """Read the files that ``joints.ini`` names, as LinuxCNC does.

    Raises
    ------
    InputError
        Entries that do not increase, more than 256, or none; a line that begins with a number and
        is no entry; a correction above 10 mm; another type than 0 and 1; a joint above 2; a
        machine unit that is not mm.
    """
    path = folder / "joints.ini"
    sections: dict[int, dict[str, str]] = {}
    section: dict[str, str] | None = None
    for number, line in enumerate(read_text(path, what="INI file").splitlines(), 1):
        key, _, value = (part.strip() for part in line.partition("="))
        if key.startswith("["):
            section = _section(key, sections, path, number)
        elif key == "LINEAR_UNITS" and value not in _MILLIMETRES:
            raise InputError(
                f"LINEAR_UNITS = {value}", file=path, line=number, accepted=", ".join(_MILLIMETRES)
            )
        elif section is not None and key in ("COMP_FILE", "COMP_FILE_TYPE"):
            section[key] = value
            if key == "COMP_FILE_TYPE" and value not in ("0", "1"):
                raise InputError(
                    f"COMP_FILE_TYPE is '{value}'", file=path, line=number, accepted="0 or 1"
                )
    named = {joint: own for joint, own in sections.items() if own.get("COMP_FILE")}
    joints = {
        joint: _triplets(folder / own["COMP_FILE"], int(own.get("COMP_FILE_TYPE", "0")))
        for joint, own in named.items()
    }
    unread = [said for own in named.values() for said in _unread(folder / own["COMP_FILE"])]
    return ScrewCompensation(joints, tuple(unread))


def _section(
    head: str, sections: dict[int, dict[str, str]], path: Path, line: int
) -> dict[str, str] | None:
    """Keys of the joint whose section begins here; None for another section."""
    found = re.fullmatch(r"\[JOINT_(\d+)\]", head)
    if found is None:
        return None
    joint = int(found[1])
    if joint >= len(_AXES):
        raise InputError(head, file=path, line=line, accepted="joints 0, 1 and 2: X, Y and Z")
    return sections.setdefault(joint, {})


def _triplets(path: Path, file_type: int) -> np.ndarray:
    rows: list[tuple[float, float, float]] = []
    for number, line in enumerate(read_text(path, what="compensation file").splitlines(), 1):
        words = line.split()[:3]
        if not words or np.isnan(decimal_number(words[0])):
            break
        values = [decimal_number(word) for word in words]
        if len(values) < 3 or not np.isfinite(values).all():
            raise InputError(
                f"'{line.strip()}' is no entry", file=path, line=number,
                accepted="three numbers with decimal points", hint=_STOPS,
            )  # fmt: skip
        nominal, up, down = values
        if rows and nominal <= rows[-1][0]:
            raise InputError(f"nominal {nominal:g} does not increase", file=path, line=number)
        trims = (nominal - up, nominal - down) if file_type == 0 else (up, down)
        if max(map(abs, trims)) > LARGEST:
            raise _other_type(line, file_type, path, number)
        rows.append((nominal, *trims))
    if not 1 <= len(rows) <= MOST_ENTRIES:
        hint = None if rows else _STOPS
        accepted = f"1 .. {MOST_ENTRIES}"
        raise InputError(f"{len(rows)} entries", file=path, line=1, accepted=accepted, hint=hint)
    return np.array(rows)


def _unread(path: Path) -> Iterator[str]:
    """A sentence where entries stand below the line at which LinuxCNC stops reading."""
    lines = read_text(path, what="compensation file").splitlines()
    is_entry = [
        len(words) == 3 and bool(np.isfinite([decimal_number(word) for word in words]).all())
        for words in (line.split()[:3] for line in lines)
    ]
    stop = is_entry.index(False) if False in is_entry else len(lines)
    if below := [number for number, good in enumerate(is_entry, 1) if good and number > stop]:
        count = "1 entry" if len(below) == 1 else f"{len(below)} entries"
        yield f"{path.name}:{below[0]}: {count} below line {stop + 1} left out: {_STOPS}"


def _other_type(line: str, file_type: int, path: Path, number: int) -> InputError:
    """A trim that no screw needs: the numbers are of the other type."""
    other = 1 - file_type
    return InputError(
        f"'{line.strip()}' is a correction above {LARGEST:g} mm with COMP_FILE_TYPE = "
        f"{file_type}",
        file=path, line=number, accepted=f"type {file_type}: {_MEANING[file_type]}",
        hint=f"type {other} is: {_MEANING[other]}",
    )  # fmt: skip


def errors_of_linuxcnc(folder: Path, options: Mapping[str, Any]) -> HeldErrors:
    """The errors that the trims take back: positioning of each joint, with its reversal."""
    read = read_linuxcnc(folder)
    return HeldErrors(
        {error_name(j, j): (own[:, 0], -own[:, 1], -own[:, 2]) for j, own in read.joints.items()},
        told=read.unread,
    )


def _own_axis(task: TableTask) -> list[Term]:
    return [Term(k, k, task.by_direction) for k in range(3)]


def _write(
    folder: Path, task: TableTask, knots: tuple[Knots, Knots, Knots], options: Mapping[str, Any]
) -> list[Path]:
    tables = projected(task, _own_axis(task), knots)[1]
    return write_linuxcnc(folder, tables, file_type=options.get("comp_type", 0))


FORMATS = (
    TableFormat(
        name="linuxcnc",
        rank=10,
        title="LinuxCNC screw compensation (COMP_FILE)",
        holds="positioning of each axis by its own position, with reversal",
        lacks="straightness, squareness, angles, any other axis, tool length, tilt",
        most_entries=MOST_ENTRIES,
        write=_write,
        read=lambda folder, options: read_linuxcnc(folder),
        terms=_own_axis,
        errors=errors_of_linuxcnc,
        sign="joints.ini",
    ),
)
