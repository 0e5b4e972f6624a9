"""Readings of a laser interferometer along one axis, and the error table that they make."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from vmach.importers.component_table import error_section, runs_text
from vmach.importers.convention import Convention
from vmach.importers.importer import Imported
from vmach.importers.questions import Questions
from vmach.importers.self_check import LaserReadings, check_laser
from vmach.importers.source_file import SourceFile
from vmach.machine.component_errors import component_of
from vmach.machine.tables.run_numbers import LARGEST_RUN, NumberedReadings
from vmach.machine.tables.runs import Runs

__all__ = ["LASER_KEYS", "Readings", "approach_in_order", "kept_numbers", "table_imported"]

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
    run : (P,) int array or None
        Number of the run; None where the file has no numbers, or such that tell no runs.
    """

    position: np.ndarray
    value: np.ndarray
    approach: np.ndarray
    line: np.ndarray
    run: np.ndarray | None = None


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
            every = {f.name: getattr(readings, f.name) for f in fields(readings)}
            left = {name: own[~mine] for name, own in every.items() if own is not None}
            kept = replace(readings, **left)
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
    """Readings by the numbers of their runs; else the n-th of a position is that of run n."""
    target, place = np.unique(_targets(readings.position), return_inverse=True)
    if len(target) < 2:
        raise source.error(f"{len(target)} position", accepted="two or more positions")
    sides = {}
    for way in (1.0, -1.0):
        mine = readings.approach == way
        if mine.any():
            run = None if readings.run is None else readings.run[mine]
            own = NumberedReadings(place[mine], readings.value[mine], run, readings.line[mine])
            sides[way] = own.in_rows(len(target))
    forward, backward = sides.get(1.0) or sides[-1.0], sides.get(-1.0) or sides[1.0]
    for name, (side, _) in (("forward", forward), ("backward", backward)):
        for end in (0, -1):
            if np.isnan(side[:, end]).all():
                line = int(readings.line[np.argmax(target[place] == target[end])])
                raise source.error(
                    f"no {name} reading at {target[end]:g}, an end of the table",
                    line=line,
                    accepted="both directions at either end, or one direction only",
                )
    return Runs(target, forward[0], backward[0], forward[1], backward[1])


def kept_numbers(readings: Readings, names: Sequence[str]) -> tuple[Readings, tuple[str, ...]]:
    """The readings with the numbers of a column of runs, and a line where they tell no runs.

    Parameters
    ----------
    readings : Readings
    names : sequence of str
        Cells of the column, (P,).
    """
    if not all(re.fullmatch(r"\d{1,9}", n.strip()) and int(n) <= LARGEST_RUN for n in names):
        told = f"the column of runs holds no whole numbers up to {LARGEST_RUN}"
        return readings, (f"{told}: runs are counted anew",)
    run = np.array([int(name) for name in names], np.int64)
    place = np.unique(_targets(readings.position), return_inverse=True)[1]
    keys = np.column_stack([run, place, readings.approach])
    _, first, back = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    again = np.flatnonzero(first[back.ravel()] != np.arange(len(keys)))
    if again.size:
        k = again[0]
        told = (
            f"run {run[k]} has the position of line {readings.line[k]} already in line "
            f"{readings.line[first[back.ravel()[k]]]}, from the same side: is a number wrong? Runs "
            "are counted anew"
        )
        return readings, (told,)
    return replace(readings, run=run), ()
