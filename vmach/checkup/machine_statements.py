"""What a machine file leaves out: measuring points, tables, ends of tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from vmach.base.note import Kind, Level
from vmach.checkup.finding import Finding
from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.files.toml_file import line_of_key
from vmach.machine import Machine, Variant
from vmach.machine.component_errors import component_of
from vmach.path.preparation import Preparation
from vmach.plausibility import admitted_machine, machine_notes
from vmach.prediction import displacement_of
from vmach.prediction.displaced_path import PIECES_AT_ONCE

__all__ = ["machine_statements", "reached_positions"]

#: notes that tell how a curve was chosen are for the report
_SAID = frozenset(Kind) - {Kind.CURVE}


def machine_statements(file: Path) -> Iterator[Finding]:
    """Measuring points that the Abbe-consistent model lacks, and what a machine is taken for.

    Parameters
    ----------
    file : Path
        The machine file; one that cannot be read is refused elsewhere.
    """
    try:
        machine = admitted_machine(file)
    except InputError:
        return
    yield from _unplaced(machine, file)
    if not machine.components:
        return  # said in one line elsewhere
    for note in machine_notes(machine):
        is_unplaced = note.kind is Kind.MISSING and note.subject == " ".join(machine.unplaced)
        if note.level is Level.NOTE and note.kind in _SAID and not is_unplaced:
            yield replace(Finding.of_note(note), file=file)


def _unplaced(machine: Machine, file: Path) -> Iterator[Finding]:
    try:
        machine.measuring_points_mm()
    except InputError as error:
        text = read_text(file, what="machine file")
        line = line_of_key(text, ["errors", machine.unplaced[0], "table"])
        yield replace(Finding.of_error(error), file=file, line=line)


def reached_positions(preparation: Preparation) -> Iterator[Finding]:
    """Tables that end before a position that the program, or a touched zero, reaches."""
    machine, path = preparation.job.machine, preparation.path
    parts = path.parts(PIECES_AT_ONCE)
    ends = [f(part.nodes.nose_mm, axis=0) for part in parts for f in (np.min, np.max)]
    found = []
    for name, component in machine.components.items():
        try:
            component.check_covers(np.array(ends)[:, component_of(name)[1]])
        except InputError as error:
            found.append(Finding.of_error(error))
    yield from found
    if found or machine.unplaced:
        return
    try:
        for part in path.parts(PIECES_AT_ONCE):
            displacement_of(preparation, part.nodes, Variant.ABBE, ())
    except InputError as error:
        yield Finding.of_error(error)
