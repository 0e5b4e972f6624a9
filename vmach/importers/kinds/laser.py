"""Runs of a laser interferometer along one axis, as tables of ISO 230-2, to an error table."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vmach.importers.component_table import component_question, unit_of
from vmach.importers.importer import Imported, Importer
from vmach.importers.laser_runs import (
    LASER_KEYS,
    Readings,
    approach_in_order,
    kept_numbers,
    table_imported,
)
from vmach.importers.loose_table import (
    LENGTH,
    SMALL,
    SMALL_ANGLE,
    SMALL_LENGTH,
    Column,
    LooseTable,
)
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile
from vmach.machine.tables.error_table import LARGEST_MM

__all__ = ["LaserRuns"]

#: runs side by side that are looked for
_MOST_RUNS = 20
_POSITION = Column(
    "position",
    ("position", "target", "target position", "nominal", "nominal position", "soll", "sollposition",
     "pos", "position soll", "x", "y", "z", "axis position", "zielposition", "cible"),
    LENGTH,
    "mm",
)  # fmt: skip
_DEVIATION = Column(
    "deviation",
    ("deviation", "error", "abweichung", "fehler", "ecart", "écart", "reading", "dev"),
    SMALL,
)
_ACTUAL = Column(
    "actual",
    ("actual", "measured", "actual position", "measured position", "ist", "istposition", "messwert",
     "laser", "laser reading"),
    LENGTH,
    "mm",
)  # fmt: skip
_APPROACH = Column(
    "approach",
    ("approach", "direction", "dir", "richtung", "anfahrrichtung", "sens"),
    is_needed=False,
    is_text=True,
)
_RUN = Column(
    "run",
    ("run", "lauf", "run number", "run no", "run no.", "lauf nr", "lauf nr.", "laufnummer", "cycle",
     "essai"),
    is_needed=False,
    is_text=True,
)  # fmt: skip
_FORWARD = (
    "+",
    "1",
    "+1",
    "forward",
    "fwd",
    "up",
    "positive",
    "pos",
    "vor",
    "vorwärts",
    "hin",
    "u",
)
_BACKWARD = (
    "-", "−", "-1", "−1", "backward", "bwd", "reverse", "rev", "down", "negative", "neg", "zurück",
    "rückwärts", "rueck", "d",
)  # fmt: skip
_WAYS = {
    "forward": ("forward", "fwd", "up", "+", "vor", "hin", "positive"),
    "backward": ("backward", "bwd", "reverse", "down", "-", "zurück", "rück", "negative"),
}


def _side_by_side(unit: str) -> tuple[Column, ...]:
    """Columns of single runs in either direction, and of their means."""
    columns = [_POSITION]
    for way, words in _WAYS.items():
        named = tuple(w for w in words if len(w) > 1)
        columns.append(Column(way, (*named, *(f"mean {w}" for w in words)), SMALL, unit, False))
        for k in range(1, _MOST_RUNS + 1):
            said = (f"{a} {k}" for a in named)
            after = (f"{run} {k} {w}" for run in ("run", "lauf", "series") for w in words)
            columns.append(Column(f"{way}_{k}", (*said, *after), SMALL, unit, False))
    return tuple(columns)


class LaserRuns(Importer):
    """Positions and deviations, from one or both sides, once or several times.

    Means or runs stand side by side, or single readings below each other. Without a column of
    directions the order of the positions tells from which side the axis came.
    """

    name = "laser"
    title = "Laser runs along one axis (ISO 230-2)"
    reads = "CSV or text with a heading: target position and deviation, or runs side by side"
    rank = 40
    keys = {
        **LASER_KEYS,
        "deviation": "measured-target, or target-measured",
        "unit": "of deviations whose heading names none",
    }

    def recognises(self, source: SourceFile) -> bool:
        return _table(source, Questions.none_open()) is not None

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        table = _table(source, questions)
        if table is None:
            raise source.error(
                "no heading with a target position and a deviation",
                accepted="columns such as 'Position (mm)' and 'Deviation (um)', or 'Run 1 +'",
                hint="--column position=... and --column deviation=... name other headings",
            )
        name = component_question(source, questions)
        _check_dimension(table, name)
        readings = _readings(table, questions)
        told: tuple[str, ...] = ()
        if (numbers := _numbers_of_runs(table)) is not None:
            readings, told = kept_numbers(readings, numbers)
        found = table_imported(readings, name, source, questions)
        return replace(found, told=(*told, *found.told))


def _table(source: SourceFile, questions: Questions) -> LooseTable | None:
    unit, given = questions.unit(), questions.columns
    deviation = Column(_DEVIATION.name, _DEVIATION.words, SMALL, unit)
    for value in (deviation, _ACTUAL):
        columns = (_POSITION, value, _APPROACH, _RUN)
        found = LooseTable.find(source, columns, given=given)
        if found is not None:
            return found
    found = LooseTable.find(source, _side_by_side(unit), given=given)
    wide = found is not None and any(name != "position" for name in found.numbers)
    return found if wide else None


def _check_dimension(table: LooseTable, name: str) -> None:
    """Refuse angles for a displacement, lengths for a rotation, and positions for neither."""
    own = SMALL_LENGTH if unit_of(name) == "um" else SMALL_ANGLE
    for column, unit in table.units.items():
        if column != "position" and unit not in own:
            raise table.source.error(
                f"{name} is a {'displacement' if own is SMALL_LENGTH else 'rotation'}, and the "
                f"column of {column} is in {unit}",
                line=table.header_line,
                accepted=", ".join(own),
                hint="--error says which error the file holds",
            )
    if "actual" in table.numbers and name[1] != name[2]:
        raise table.source.error(
            f"positions that were reached say nothing of {name}",
            line=table.header_line,
            accepted="EXX, EYY or EZZ, or a column of deviations",
        )


def _check_reached(table: LooseTable, position: np.ndarray, value: np.ndarray) -> None:
    """Refuse positions (P,) mm that were missed by more than any axis misses, `value` um."""
    far = np.abs(value) > 1e3 * LARGEST_MM
    if far.any():
        k = int(np.argmax(far))
        raise table.source.error(
            f"{position[k] + 1e-3 * value[k]:g} mm was reached where {position[k]:g} mm was the "
            "target",
            line=int(table.lines[k]),
            accepted=f"positions within {LARGEST_MM:g} mm of their targets",
            hint="--column deviation='HEADING' where the column holds deviations",
        )


def _readings(table: LooseTable, questions: Questions) -> Readings:
    """Every reading by itself, deviations as measured minus target."""
    position = table.complete("position")
    if "actual" in table.numbers:
        questions.used.add("deviation")  # both are there: no question
        value = 1e3 * (table.complete("actual") - position)
        _check_reached(table, position, value)
        return Readings(position, value, _approach(table, position), table.lines)
    wanted = ("measured-target", "target-measured")
    sign = 1.0 if questions.told("deviation", wanted) == wanted[0] else -1.0
    if "deviation" in table.numbers:
        value = sign * table.complete("deviation")
        return Readings(position, value, _approach(table, position), table.lines)
    found = []
    for name, column in table.numbers.items():
        if name != "position":
            way = 1.0 if name.startswith("forward") else -1.0
            rows = np.flatnonzero(np.isfinite(column))
            ways = np.full(len(rows), way)
            found.append((position[rows], sign * column[rows], ways, table.lines[rows]))
    return Readings(*(np.concatenate(part) for part in zip(*found, strict=True)))


def _numbers_of_runs(table: LooseTable) -> list[str] | None:
    """The number of the run of every reading, as the file has it; None where it has none."""
    if "run" in table.text:
        return list(table.text["run"])
    columns = {name: column for name, column in table.numbers.items() if name != "position"}
    numbers = {name: name.partition("_")[2] for name in columns}
    if not columns or not all(numbers.values()):
        return None
    return [
        numbers[name]
        for name, column in columns.items()
        for _ in range(np.count_nonzero(np.isfinite(column)))
    ]


def _approach(table: LooseTable, position: np.ndarray) -> np.ndarray:
    """Signs of the motion into each position, (P,); from the order where no column tells."""
    if "approach" in table.text:
        words = [word.lower() for word in table.text["approach"]]
        for line, word in zip(table.lines, words, strict=True):
            if word not in _FORWARD and word not in _BACKWARD:
                raise table.source.error(
                    f"direction '{word}'",
                    line=int(line),
                    accepted="+, -, 1, -1, forward, backward, up, down",
                )
        return np.array([1.0 if word in _FORWARD else -1.0 for word in words])
    return approach_in_order(position)
