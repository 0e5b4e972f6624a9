"""Laser runs in Renishaw's own text files (``.rtl``, ``.rta``): targets, runs and deviations.

The maker publishes no specification. What is read is what a public converter of such files to the
tables of controls reads (Paolico, AxisCorection): the sections ``HEADER``, ``TARGET DATA``,
``USER-TEXT``, ``RUNS`` and ``DEVIATIONS``, each headed by its name and two colons. A deviation is a
line of run, target and value: um in ``.rtl``, mrad in ``.rta``. Two public readers of ``.rta``,
independent of each other, multiply by 206.264 and get arcseconds.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace

import numpy as np

from vmach.files.text_file import decimal_number
from vmach.importers.component_table import component_question, unit_of
from vmach.importers.importer import Imported, Importer
from vmach.importers.laser_runs import LASER_KEYS, Readings, approach_in_order, table_imported
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile

__all__ = ["RenishawRtl"]

_HEADER, _TARGETS, _USER, _RUNS, _DEVIATIONS = (
    "HEADER", "TARGET DATA", "USER-TEXT", "RUNS", "DEVIATIONS")  # fmt: skip
_LINEAR, _ANGULAR = "rtl", "rta"
_URAD_PER_MRAD = 1e3
_LARGEST = 1e6  #: mm or um: beyond it a number is none of this instrument's


@dataclass(frozen=True)
class _Line:
    """One line of a section: its number in the file, 1-based."""

    number: int
    text: str


class RenishawRtl(Importer):
    """Bidirectional runs; the order of a run's targets says from which side it came."""

    name = "renishaw_rtl"
    title = "Laser runs in Renishaw's text file"
    reads = ".rtl, .rta: TARGET DATA, RUNS and DEVIATIONS of linear and angular runs"
    rank = 12
    keys = LASER_KEYS

    def recognises(self, source: SourceFile) -> bool:
        return source.is_text and {_TARGETS, _DEVIATIONS} <= _sections(source).keys()

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        sections = _sections(source)
        for name in (_TARGETS, _DEVIATIONS):
            if name not in sections:
                raise source.error(
                    f"no section {name}::", accepted=f"{_TARGETS}::, {_DEVIATIONS}::"
                )
        kinds = {_word(sections, _HEADER, "File type").lower(), source.suffix[1:]}
        is_angular = _ANGULAR in kinds
        axis = _word(sections, _USER, "Axis").upper()
        is_positioning = axis in ("X", "Y", "Z") and _LINEAR in kinds and not is_angular
        said = f"E{axis}{axis}" if is_positioning else None
        component = component_question(source, questions, said=said)
        if (unit_of(component) == "urad") != is_angular:
            raise source.error(
                f"{component}, and the runs are {'angular' if is_angular else 'linear'}",
                accepted="a rotation, as EBX" if is_angular else "a displacement, as EXX or EYX",
            )
        targets = _target_positions(sections[_TARGETS], source)
        readings = _readings(sections, targets, source)
        if is_angular:
            readings = replace(readings, value=_URAD_PER_MRAD * readings.value)
        return table_imported(readings, component, source, questions)


def _sections(source: SourceFile) -> dict[str, list[_Line]]:
    """Lines below each heading ``NAME::``, without empty ones."""
    found: dict[str, list[_Line]] = {}
    own: list[_Line] = []
    for number, text in enumerate(source.lines, 1):
        line = text.strip()
        if line.endswith("::"):
            own = found.setdefault(line[:-2].strip().upper(), [])
        elif line:
            own.append(_Line(number, line))
    return found


def _word(sections: dict[str, list[_Line]], section: str, key: str) -> str:
    """What stands behind ``key:`` in a section; empty without it."""
    for line in sections.get(section, []):
        name, colon, value = line.text.partition(":")
        if colon and name.strip().lower() == key.lower():
            return value.strip()
    return ""


def _numbers(line: _Line, text: str, source: SourceFile, what: str) -> list[float]:
    """Numbers of a line, a decimal comma taken for a point."""
    values = [decimal_number(word.replace(",", ".")) for word in text.split()]
    if not all(abs(value) <= _LARGEST for value in values):
        raise source.error(f"'{line.text[:60]}'", line=line.number, accepted=what)
    return values


def _target_positions(lines: list[_Line], source: SourceFile) -> np.ndarray:
    """Positions below ``Targets``, mm, (T,)."""
    found: list[float] = []
    is_open, counted = False, None
    for line in lines:
        key, colon, rest = line.text.partition(":")
        if not colon and not is_open:
            continue
        if colon:
            is_open = key.strip().lower() == "targets"
            if key.strip().lower() == "target-count":
                counted = line
        if is_open:
            found += _numbers(line, rest if colon else line.text, source, "positions in mm")
    if counted is not None and counted.text.partition(":")[2].strip() != str(len(found)):
        raise source.error(
            f"{counted.text}, and {len(found)} positions stand below it",
            line=counted.number,
            accepted="as many positions as are counted",
        )
    return np.array(found)


def _readings(
    sections: dict[str, list[_Line]], targets: np.ndarray, source: SourceFile
) -> Readings:
    """Every deviation, run by run; numbers of targets may begin at 0 or at 1."""
    rows: dict[int, list[tuple[int, float, int]]] = defaultdict(list)
    for line in sections[_DEVIATIONS]:
        if line.text[0].isalpha():
            continue  # the heading "Run Target Data:"
        values = _numbers(line, line.text, source, "run, target and deviation in um")
        if len(values) != 3 or values[0] % 1 or values[1] % 1:
            raise source.error(
                f"'{line.text[:60]}'",
                line=line.number,
                accepted="run, target and deviation in um",
            )
        rows[int(values[0])].append((int(values[1]), values[2], line.number))
    numbers = [target for run in rows.values() for target, *_ in run]
    first = min(numbers, default=1)
    counted = _word(sections, _RUNS, "Run-count")
    if counted and counted != str(len(rows)):
        raise source.error(
            f"Run-count: {counted}, and {len(rows)} runs have deviations",
            accepted="a file of all the runs that it counts",
        )
    if first not in (0, 1) or max(numbers, default=len(targets) + 1) - first >= len(targets):
        raise source.error(
            f"deviations of the targets {first} to {max(numbers, default=0)}, {len(targets)} "
            f"positions",
            line=sections[_DEVIATIONS][0].number if sections[_DEVIATIONS] else None,
            accepted="a position for each target",
        )
    parts = []
    for run in rows.values():
        place = targets[[target - first for target, *_ in run]]
        parts.append((place, [value for _, value, _ in run], approach_in_order(place),
                      [line for *_, line in run]))  # fmt: skip
    return Readings(*(np.concatenate(part) for part in zip(*parts, strict=True)))
