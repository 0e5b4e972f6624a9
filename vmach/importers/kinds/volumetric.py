"""Volumetric tables: the ISG and TwinCAT text, and the ETALON exchange text."""

from __future__ import annotations

import re

from vmach.importers.component_table import error_section, runs_text
from vmach.importers.convention import Convention
from vmach.importers.importer import Imported, Importer, Section
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile
from vmach.machine.component_errors import component_of
from vmach.machine.files.volumetric_file import read_volumetric_file
from vmach.machine.tables.runs import Runs

__all__ = ["Volumetric"]

_HEADER = re.compile(r"^\s*[XYZ][\s;,]+E[XYZABC][XYZ]\b", re.MULTILINE)
_BLOCK = re.compile(r"^\s*\[E?[XYZABC]?[XYZABC0][XYZ]\]\s*$", re.MULTILINE)


class Volumetric(Importer):
    """All errors of a machine in one file, one direction, as tables of its own for each."""

    name = "volumetric"
    title = "Volumetric tables (ISG CSV, ETALON exchange text)"
    reads = "a header such as 'X EXX EYX ...', or blocks [EXX] with Gridpoints; mm and rad"
    rank = 25
    keys = {"measured_at": "where the errors are stated: machine coordinates, mm; usually 0 0 0"}

    def recognises(self, source: SourceFile) -> bool:
        return source.is_text and not source.path.is_dir() and _format_of(source) is not None

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        format_name = _format_of(source) or "isg-csv"
        found = read_volumetric_file(source.path, format_name, text=source.text)
        convention = Convention.of(questions.machine_file)
        if found.tables and "measured_at" not in questions.given:
            questions.given = {**questions.given, "measured_at": _asked_point(questions)}
        files: dict[str, str] = {}
        sections: list[Section] = []
        for name, (position, value) in found.tables.items():
            unit = 1e6 if component_of(name)[2] else 1e3
            values = convention.factor(name) * unit * value
            file = f"errors/{name}.csv"
            files[file] = runs_text(Runs(position, values, values), name)
            sections += error_section(name, file, questions)
        squareness = {n: convention.in_angle_unit(v) for n, v in found.squareness_rad.items()}
        if squareness:
            sections.append(Section("machine", "squareness", squareness))
        said = f"{source.path.name}: {', '.join((*found.tables, *found.squareness_rad))}"
        return Imported(files, tuple(sections), (said,))


def _asked_point(questions: Questions) -> str:
    point = questions.point("measured_at", "where the errors are stated", default=(0, 0, 0))
    return " ".join(f"{v:g}" for v in point)


def _format_of(source: SourceFile) -> str | None:
    if _HEADER.search(source.text):
        return "isg-csv"
    return "etalon" if _BLOCK.search(source.text) else None
