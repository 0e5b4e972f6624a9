"""Runs of a laser interferometer along one axis, as tables of ISO 230-2, to an error table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from vmach.importers.component_table import component_question, error_section, runs_text
from vmach.importers.convention import Convention
from vmach.importers.importer import Imported, Importer
from vmach.importers.loose_table import LENGTH, SMALL, Column, LooseTable
from vmach.importers.questions import Questions
from vmach.importers.self_check import LaserReadings, check_laser
from vmach.importers.source_file import SourceFile
from vmach.machine.tables.runs import Runs

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
    "-", "-1", "−1", "backward", "bwd", "reverse", "rev", "down", "negative", "neg", "zurück",
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


@dataclass(frozen=True)
class _Readings:
    """Single readings in the order of the file: positions mm, values um or urad, signs, lines."""

    position: np.ndarray
    value: np.ndarray
    approach: np.ndarray
    line: np.ndarray


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
        "error": "which error it is: EXX, EYX, EBX ...",
        "counts": "up where the laser's positions grow as the axis moves in +, else down",
        "zero": "machine position of the axis where the file's position is 0, mm",
        "deviation": "measured-target, or target-measured",
        "unit": "of deviations whose heading names none",
        "measured_at": "where the reflector stood, machine coordinates, mm",
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
        readings = _readings(table, questions)
        counts = questions.choice(
            "counts",
            "when the axis moves in its + direction, do the positions in the file go up or down?",
            ("up", "down"),
            default="up",
        )
        zero = questions.number(
            "zero",
            "machine position of the axis at position 0 of the file",
            unit="mm",
            default=0.0,
        )
        runs, is_down = _runs(readings, source), counts == "down"
        convention = Convention.of(questions.machine_file)
        file = f"errors/{name}.csv"
        files = {file: runs_text(runs.scaled(convention.factor(name)), name)}
        sections = error_section(name, file, questions, zero_mm=zero, is_down=is_down)
        check = check_laser(
            LaserReadings(name, readings.position, readings.value, readings.approach),
            files,
            sections,
            convention=convention,
            zero_mm=zero,
            is_down=is_down,
        )
        said = f"{source.path.name}: {len(readings.value)} readings at {len(runs.position_mm)} "
        said += f"positions, {len(runs.forward)} runs forward, {len(runs.backward)} backward"
        return Imported(files, sections, (said, check))


def _table(source: SourceFile, questions: Questions) -> LooseTable | None:
    unit, given = questions.unit(), questions.columns
    deviation = Column(_DEVIATION.name, _DEVIATION.words, SMALL, unit)
    for columns in ((_POSITION, deviation, _APPROACH), (_POSITION, _ACTUAL, _APPROACH)):
        found = LooseTable.find(source, columns, given=given)
        if found is not None:
            return found
    found = LooseTable.find(source, _side_by_side(unit), given=given)
    wide = found is not None and any(name != "position" for name in found.numbers)
    return found if wide else None


def _readings(table: LooseTable, questions: Questions) -> _Readings:
    """Every reading by itself, deviations as measured minus target."""
    position = table.complete("position")
    wanted = ("measured-target", "target-measured")
    sense = questions.told("deviation", wanted)
    sign = 1.0 if sense == wanted[0] else -1.0
    if "actual" in table.numbers:
        value = 1e3 * (table.complete("actual") - position)
        return _Readings(position, value, _approach(table, position), table.lines)
    if "deviation" in table.numbers:
        value = sign * table.complete("deviation")
        return _Readings(position, value, _approach(table, position), table.lines)
    found = []
    for name, column in table.numbers.items():
        if name != "position":
            way = 1.0 if name.startswith("forward") else -1.0
            rows = np.flatnonzero(np.isfinite(column))
            ways = np.full(len(rows), way)
            found.append((position[rows], sign * column[rows], ways, table.lines[rows]))
    return _Readings(*(np.concatenate(part) for part in zip(*found, strict=True)))


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
    moved = np.sign(np.diff(position))
    sides = np.empty(len(position))
    sides[0] = moved[moved != 0][0] if moved.any() else 1.0
    for k, way in enumerate(moved, 1):
        # the same position again: the axis went beyond it and came back
        sides[k] = way if way else -sides[k - 1]
    return sides


def _runs(readings: _Readings, source: SourceFile) -> Runs:
    """The n-th reading of a position from one side belongs to the n-th run."""
    target, place = np.unique(np.round(readings.position, 4), return_inverse=True)
    if len(target) < 2:
        raise source.error(f"{len(target)} position", accepted="two or more positions")
    sides: Mapping[float, list[np.ndarray]] = {1.0: [], -1.0: []}
    for way, own in sides.items():
        count = np.zeros(len(target), dtype=int)
        for k in np.flatnonzero(readings.approach == way):
            if count[place[k]] == len(own):
                own.append(np.full(len(target), np.nan))
            own[count[place[k]]][place[k]] = readings.value[k]
            count[place[k]] += 1
    forward, backward = sides[1.0] or sides[-1.0], sides[-1.0] or sides[1.0]
    for name, side in (("forward", forward), ("backward", backward)):
        for end in (0, -1):
            if np.isnan([run[end] for run in side]).all():
                line = int(readings.line[np.argmax(target[place] == target[end])])
                raise source.error(
                    f"no {name} reading at {target[end]:g}, an end of the table",
                    line=line,
                    accepted="both directions at either end, or one direction only",
                )
    return Runs(target, np.array(forward), np.array(backward))
