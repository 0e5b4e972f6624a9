"""The gate that every command passes: read, refuse what cannot be so, note what is doubtful."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from vmach.base.note import Kind, Level, Note
from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.files.toml_file import line_of_key
from vmach.machine import Machine, read_machine
from vmach.plausibility.places import place_notes
from vmach.plausibility.squareness import squareness_notes
from vmach.plausibility.statements import statement_notes
from vmach.plausibility.table_positions import position_notes
from vmach.plausibility.table_values import value_notes
from vmach.plausibility.tools import Dimensions, tool_notes

__all__ = ["admitted_machine", "check_tools", "doubts", "machine_notes"]

_CHECKS: tuple[Callable[[Machine], Iterator[Note]], ...] = (
    squareness_notes,
    position_notes,
    value_notes,
    place_notes,
    statement_notes,
)
#: where the number of a note stands; else in the table of its subject
_KEY_OF_KIND = {
    Kind.PLACE: "measured_at_mm",
    Kind.DIAMETER: "diameter_mm",
    Kind.LENGTH: "length_mm",
}


def admitted_machine(path: str | Path) -> Machine:
    """Read a machine file, and refuse what no machine can be.

    Raises
    ------
    InputError
        Anything wrong with the files; tables outside the travel, impossible sizes and places.
    """
    machine = read_machine(path)
    _refuse(machine_notes(machine), Path(path), what="machine file", table="errors")
    return machine


def check_tools(tools: Mapping[int, Dimensions], path: Path) -> None:
    """Refuse tools of the job file `path` that no spindle can carry.

    Raises
    ------
    InputError
        With file, line, value and what is accepted.
    """
    _refuse(tool_notes(tools), path, what="job file", table="tools")


def machine_notes(machine: Machine) -> tuple[Note, ...]:
    """All notes on a machine, the worst level first; equal sentences come once."""
    together: dict[tuple[Level, str], Note] = {}
    for note in (note for check in _CHECKS for note in check(machine)):
        key = (note.level, note.sentence)
        if key in together:
            note = replace(together[key], subject=f"{together[key].subject} {note.subject}")
        together[key] = note
    order = list(Level)
    return tuple(sorted(together.values(), key=lambda note: order.index(note.level)))


def doubts(notes: Iterable[Note]) -> tuple[Note, ...]:
    """Those that every command tells: all but what was merely assumed."""
    return tuple(note for note in notes if note.level is not Level.NOTE)


def _refuse(notes: Iterable[Note], path: Path, *, what: str, table: str) -> None:
    for note in notes:
        if note.level is Level.REFUSED:
            of = "squareness" if note.kind is Kind.SQUARENESS else table
            keys = [of, note.subject.split()[-1], _KEY_OF_KIND.get(note.kind, "table")]
            raise InputError(
                f"{note.subject}: {note.sentence}",
                file=path,
                line=line_of_key(read_text(path, what=what), keys),
                accepted=note.accepted,
                hint=note.hint,
                note=note,
            )
