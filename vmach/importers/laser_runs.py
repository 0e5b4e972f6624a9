"""Readings of a laser interferometer along one axis, and the error table that they make."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

import numpy as np

from vmach.importers.component_table import error_section, runs_text
from vmach.importers.convention import Convention
from vmach.importers.importer import Imported
from vmach.importers.questions import Questions
from vmach.importers.self_check import LaserReadings, check_laser
from vmach.importers.source_file import SourceFile
from vmach.machine.component_errors import component_of
from vmach.machine.tables.runs import Runs

__all__ = ["LASER_KEYS", "Readings", "approach_in_order", "table_imported"]

#: what is asked of every kind of laser file
LASER_KEYS: Mapping[str, str] = {
    "error": "which error it is: EXX, EYX, EBX ...",
    "counts": "up where the laser's positions grow as the axis moves in +, else down",
    "zero": "machine position of the axis where the file's position is 0, mm",
    "measured_at": "where the reflector stood, in the frame of the body that the axis carries, mm",
}


#: of a reflector whose place nobody knows any more
_UNKNOWN = "unknown"
#: nearer positions are one target, as error tables have it
_SAME_MM = 1e-3
#: so many readings of exactly 0, and no other, were not measured; chosen: two may happen
_NOT_MEASURED = 3


@dataclass(frozen=True)
class Readings:
    """Single readings in the order of the file.

    Attributes
    ----------
    position, value : (P,) array
        mm; um or urad, measured minus target.
    approach : (P,) array
        +1 or -1: the sign of the motion into the position.
    line : (P,) int array
        Of the file, 1-based.
    """

    position: np.ndarray
    value: np.ndarray
    approach: np.ndarray
    line: np.ndarray


def table_imported(
    readings: Readings, name: str, source: SourceFile, questions: Questions
) -> Imported:
    """The table of a component error, its section, and what the laser would read on it.

    Parameters
    ----------
    readings : Readings
    name : str
        The component error, such as ``EXX``.
    source : SourceFile
    questions : Questions
        Which way the laser counts, and where its zero is.

    Raises
    ------
    InputError
        Fewer than two positions, or an end that one of the two directions does not reach.
    """
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
    own = _with_reflector(name, questions)
    readings, left_out = _without_zeros(readings)
    runs, is_down = _runs(readings, source), counts == "down"
    convention = Convention.of(questions.machine_file)
    file = f"errors/{name}.csv"
    files = {file: runs_text(runs.scaled(convention.factor(name)), name)}
    taken = questions.taken(("counts", "zero", "deviation"))
    comment = f"mend: nobody has said {taken}" if taken else ""
    sections = error_section(name, file, own, zero_mm=zero, is_down=is_down, comment=comment)
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
    return Imported(files, sections, (said, *left_out, check, *_missing_place(name, own)))


def _without_zeros(readings: Readings) -> tuple[Readings, tuple[str, ...]]:
    """Readings without a direction that was filled with zeros, and a line that says so.

    Files of runs in one direction have such runs between the measured ones.
    """
    for way, name in ((1.0, "forward"), (-1.0, "backward")):
        mine = readings.approach == way
        count, other = np.count_nonzero(mine), readings.value[~mine]
        if count >= _NOT_MEASURED and not readings.value[mine].any() and other.any():
            kept = Readings(*(getattr(readings, f.name)[~mine] for f in fields(readings)))
            return kept, (f"all {count} readings {name} are 0: taken as not measured",)
    return readings, ()


def _with_reflector(name: str, questions: Questions) -> Questions:
    """The answers with the place of the reflector, asked of whoever is there; angles have none."""
    if component_of(name)[2] or questions.ask is None or "measured_at" in questions.given:
        return questions
    text = questions.text(
        "measured_at",
        "where did the reflector stand, in the frame of the body that the axis carries?",
        accepted=f"three numbers in mm: '-300 -200 -250', or {_UNKNOWN}",
        default=_UNKNOWN,
    )
    if text == _UNKNOWN:
        return questions
    return replace(questions, given={**questions.given, "measured_at": text})


def _missing_place(name: str, questions: Questions) -> tuple[str, ...]:
    """A line for a displacement whose arm is not known."""
    if component_of(name)[2] or "measured_at" in questions.given:
        return ()
    return (
        f"{name}: measured_at_mm, where the reflector stood, is not said; vmach run needs it once "
        f"an angle of {name[2]} has a table (--set measured_at='x y z')",
    )


def _targets(position: np.ndarray) -> np.ndarray:
    """Positions (P,), those that are the same but for the last digits of a display made equal."""
    order = np.argsort(position)
    group = np.concatenate([[0], np.cumsum(np.diff(position[order]) >= _SAME_MM)])
    middle = np.bincount(group, position[order]) / np.bincount(group)
    same = np.empty(len(position))
    same[order] = np.round(middle, 4)[group]
    return same


def approach_in_order(position: np.ndarray) -> np.ndarray:
    """Signs of the motion into each position, (P,), from the order of the positions."""
    moved = np.sign(np.diff(_targets(position)))
    sides = np.empty(len(position))
    sides[0] = moved[moved != 0][0] if moved.any() else 1.0
    for k, way in enumerate(moved, 1):
        # the same position again: the axis went beyond it and came back
        sides[k] = way if way else -sides[k - 1]
    return sides


def _runs(readings: Readings, source: SourceFile) -> Runs:
    """The n-th reading of a position from one side belongs to the n-th run."""
    target, place = np.unique(_targets(readings.position), return_inverse=True)
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
