"""Compensation tables of controls, as ``vmach tables`` writes them, back to error tables."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from vmach.controller_tables.table_format import LARGEST, HeldErrors, TableFormat
from vmach.controller_tables.table_formats import FORMATS
from vmach.errors import InputError
from vmach.importers.component_table import error_section, runs_text
from vmach.importers.convention import Convention
from vmach.importers.importer import Imported, Importer, Section
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile
from vmach.machine.chain import LINEAR_AXES, Chain
from vmach.machine.component_errors import COMPONENT_NAMES, component_of
from vmach.machine.tables.runs import Runs

__all__ = ["ControllerTables"]

#: largest squareness that is believed, rad
_LARGEST_RAD = 0.1


class ControllerTables(Importer):
    """A folder of tables, or the file in it that tells which control they are for."""

    name = "controller_tables"
    title = "Compensation tables of a control"
    reads = "folders with " + ", ".join(f"{f.sign} ({f.name})" for f in FORMATS.values() if f.sign)
    rank = 5
    keys = {"cec_entries": "of SINUMERIK's CEC tables: correction, or error"}

    def recognises(self, source: SourceFile) -> bool:
        return any(True for _ in _formats_in(source))

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        known = next(_formats_in(source), None)
        if known is None:
            raise source.error("no tables of a control are here", accepted=self.reads)
        one, folder = known
        options = {}
        if "cec" in one.name:
            options["cec_entries"] = questions.choice(
                "cec_entries", "what CEC entries are", ("correction", "error"), default="correction"
            )
        held = _errors_of(one, folder, options)
        convention = Convention.of(questions.machine_file)
        _check_chain(held, convention, source)
        files: dict[str, str] = {}
        sections: list[Section] = []
        for name, (position, forward, backward) in held.tables.items():
            factor = convention.factor(name) * (1e6 if component_of(name)[2] else 1e3)
            if max(np.max(abs(forward)), np.max(abs(backward))) > LARGEST:
                raise source.error(f"{name} is above {LARGEST:g} mm", accepted="tables in mm")
            file = f"errors/{name}.csv"
            files[file] = runs_text(Runs(position, factor * forward, factor * backward), name)
            sections += error_section(name, file, _stated_at_nose(questions, held))
        if held.squareness_rad:
            values = {n: convention.in_angle_unit(v) for n, v in held.squareness_rad.items()}
            sections.append(Section("machine", "squareness", values))
        said = [f"{folder}: {one.title}: {', '.join((*held.tables, *held.squareness_rad))}"]
        said += held.told
        if any((forward != backward).any() for _, forward, backward in held.tables.values()):
            said.append('reversal acts with directions = "separate" in [tables]')
        if held.order and questions.machine_file is None:
            said.append(f'these tables are for chain = "{_chain_text(held)}"')
        return Imported(files, tuple(sections), tuple(said))


def _formats_in(source: SourceFile) -> Iterator[tuple[TableFormat, Path]]:
    folder = source.path if source.path.is_dir() else source.path.parent
    for one in FORMATS.values():
        is_sign = source.path.is_dir() or source.path.name == one.sign
        if one.sign and is_sign and (folder / one.sign).is_file():
            yield one, folder


def _errors_of(one: TableFormat, folder: Path, options: dict[str, str]) -> HeldErrors:
    """The errors; whatever a broken file does to a reader becomes one message."""
    assert one.errors is not None
    try:
        held = one.errors(folder, options)
    except InputError:
        raise
    except (ValueError, KeyError, IndexError, TypeError, ZeroDivisionError, OverflowError) as error:
        raise InputError(
            f"no table of {one.name}: {_out_of_place(error)}",
            file=folder / one.sign,
            line=1,
            accepted=f"files as 'vmach tables --format {one.name}' writes them",
        ) from None
    _check(held, folder / one.sign, one)
    return held


def _out_of_place(error: Exception) -> str:
    """What a reader stumbled over, in words for people."""
    quoted = re.search(r"'([^']*)'$", str(error))
    if isinstance(error, KeyError):
        return f"{error} is missing"
    if isinstance(error, ValueError) and quoted:
        return f"'{quoted[1]}' stands where a number was expected"
    return "a line is missing, or is not of the form that was expected"


def _check(held: HeldErrors, file: Path, one: TableFormat) -> None:
    """Refuse what no control has: other names, positions out of order, values that are none."""
    wrong = None
    if not held.tables and not held.squareness_rad:
        wrong = "holds no table"
    elif held.order and sorted(held.order) != sorted(LINEAR_AXES):
        wrong = f"has axes '{held.order}'"
    for name, columns in held.tables.items():
        if name not in COMPONENT_NAMES:
            wrong = f"'{name}' is no error of a linear axis"
        elif not all(np.isfinite(column).all() for column in columns):
            wrong = f"{name} holds a value that is no number"
        elif len(columns[0]) < 2 or (np.diff(columns[0]) <= 0).any():
            wrong = f"{name} has {len(columns[0])} positions, or two that do not increase"
    for name, value in held.squareness_rad.items():
        if not re.fullmatch("E[ABC]0[XYZ]", name) or not isinstance(value, int | float):
            wrong = f"squareness '{name}' = {value!r}"
        elif not abs(value) < _LARGEST_RAD:
            wrong = f"squareness {name} is {value:g} rad"
    if wrong:
        raise InputError(wrong, file=file, line=1, accepted=one.title)


def _chain_text(held: HeldErrors) -> str:
    return f"t (C) {' '.join(reversed(held.order))} b w"


def _check_chain(held: HeldErrors, convention: Convention, source: SourceFile) -> None:
    """Refuse tables with angles for another chain: their arms would be others."""
    if held.order and Chain.parse(_chain_text(held)) != Chain.parse(convention.chain):
        if convention == Convention():
            return
        raise source.error(
            f'the tables are for a chain "{_chain_text(held)}", the machine file has '
            f'"{convention.chain}"',
            accepted="a machine file with that chain",
            hint="a control's tables have all axes on the side of the tool",
        )


def _stated_at_nose(questions: Questions, held: HeldErrors) -> Questions:
    """Errors of a chain hold at the spindle nose with every axis at home."""
    if not held.order:
        return questions
    return Questions({**questions.given, "measured_at": "0 0 0"}, columns=questions.columns)
