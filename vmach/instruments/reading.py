"""The tests of a job: from a section and a file to a `Measurement`, checked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from itertools import combinations
from pathlib import Path

import numpy as np

from vmach.base.note import Kind, Note, in_file
from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.files.toml_file import check_section, line_of_key
from vmach.instruments.catalogue import catalogue
from vmach.instruments.clocks import read_by_clock
from vmach.job import Job
from vmach.machine import Machine, Variant
from vmach.measurements.columns import Columns, read_columns
from vmach.measurements.instrument import Instrument
from vmach.measurements.measurement import Measurement
from vmach.measurements.plausibility.alternatives import (
    Alternative,
    alternative_notes,
    is_doubtful,
    other_sign,
)
from vmach.measurements.plausibility.exchanged_diagonals import DiagonalPair
from vmach.measurements.plausibility.motion_check import check_times
from vmach.measurements.plausibility.reading_check import (
    SIGNS_ACCEPTED,
    check_readings,
    check_signs,
    check_spindle,
    clock_notes,
    repeat_notes,
    still_notes,
)
from vmach.measurements.plausibility.table_mistakes import exchanged_directions
from vmach.measurements.plausibility.unit_check import check_unit
from vmach.measurements.side_by_side import read_side_by_side
from vmach.path.preparation import Preparation, prepare
from vmach.path.toolpath import PathStates
from vmach.plausibility import doubtful_length
from vmach.prediction import ActingEffect, displacement_of, of_machine

__all__ = ["read_instruments", "settings_of"]

#: of rows: an instrument has no use for it, and people do
_NAME = "id"
#: what a column of times holds
_SECONDS = "seconds since the cold start of this test, such as 12.5, and no time of day"


def read_instruments(job: Job, *, effects: Sequence[ActingEffect] = ()) -> tuple[Measurement, ...]:
    """The ``[[measurements]]`` of a job, each with what the model predicts for it.

    Raises
    ------
    InputError
        Unknown kind or key, missing file or column, a value that is no number, another unit.
    """
    found: list[Measurement] = []
    read: list[tuple[Instrument, Columns]] = []
    model = _Model(job, effects)
    for number in range(len(job.measurements)):
        settings = settings_of(job, number)
        path = job.folder / settings.file
        table, noticed = _read(settings, path)
        test = read_by_clock(settings, table, model)
        check_unit(test, path)
        test = test.noted(*in_file((*noticed, *_twice(test, found), *_length(settings)), path))
        if is_doubtful(test):
            others = _alternatives(settings, table, model)
            test = test.noted(*alternative_notes(test, (*others, other_sign(test))))
        found.append(test)
        read.append((settings, table))
    return _asked_about_names(found, read, model)


def _asked_about_names(
    tests: Sequence[Measurement], read: Sequence[tuple[Instrument, Columns]], model: _Model
) -> tuple[Measurement, ...]:
    """The tests, with a question for every two that look like each other's."""
    pairs = []
    for k, other in combinations(range(len(tests)), 2):
        keys = read[k][0].exchanged_keys
        if not keys or type(read[k][0]) is not type(read[other][0]):
            continue
        with suppress(InputError):  # one is too short for the readings of the other
            there = tuple(
                read_by_clock(_named_as(read[own][0], read[its][0]), read[own][1], model)
                for own, its in ((k, other), (other, k))
            )
            pair = DiagonalPair((tests[k], tests[other]), (there[0], there[1]))
            if pair.looks_exchanged:
                pairs.append((pair.apart_mm[1], k, other, pair))
    asked = list(tests)
    told: set[int] = set()
    for _, k, other, pair in sorted(pairs, key=lambda found: found[:3]):
        if told.isdisjoint((k, other)):
            told |= {k, other}
            asked[k] = asked[k].noted(pair.note())
    return tuple(asked)


def _named_as(settings: Instrument, other: Instrument) -> Instrument:
    """One test with the keys of another by which both may have been exchanged."""
    return settings.model_copy(update={key: getattr(other, key) for key in other.exchanged_keys})


def _alternatives(settings: Instrument, table: Columns, model: _Model) -> Iterator[Alternative]:
    """What the model says of a test if something that the job says of it were mistaken."""
    for change in settings.mistaken():
        ((key, value),) = change.items()
        with suppress(InputError):  # it cannot have been so
            other = read_by_clock(settings.model_copy(update=change), table, model)
            said = f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value:g}"
            question = f"is {key} = {getattr(settings, key)} in the job right?"
            yield Alternative(said, question, other.predicted_mm)
    # a single test shows too little of the machine to tell more than this of its tables
    for mistake in exchanged_directions(model.job.machine):
        other = read_by_clock(settings, table, model.of(mistake.machine))
        yield Alternative(mistake.what, mistake.question, other.predicted_mm)


class _Model:
    """Displacement of the tool at the states of a test."""

    def __init__(self, job: Job, effects: Sequence[ActingEffect]) -> None:
        self.job, self._effects = job, effects
        self.machine = job.machine
        self.travel_mm = np.asarray(job.machine.travel_mm)
        self.rapid_mm_per_min = job.machine.motion.rapid_mm_per_min

    @cached_property
    def preparation(self) -> Preparation:
        """The job's program, read and split."""
        return prepare(self.job)

    def of(self, machine: Machine) -> _Model:
        """The same job on a machine with other tables."""
        other = _Model(replace(self.job, machine=machine), self._effects)
        if "preparation" in vars(self):  # the program's moves do not depend on them
            vars(other)["preparation"] = replace(self.preparation, job=other.job)
        return other

    def moved_mm(self, states: PathStates) -> np.ndarray:
        """Displacement of the tool's point of interest at P states, (P, 3) mm."""
        if states.normal is None:  # of the machine itself, whatever zero the part counts from
            moved = of_machine(self.job.machine, states, Variant.ABBE, self._effects)
        else:
            moved = displacement_of(self.preparation, states, Variant.ABBE, self._effects)
        seen = states.seen_mm(moved)
        for effect in self._effects if states.normal is not None else ():
            seen = seen + effect.at_surface(states)
        return seen

    def predicted_mm(self, states: PathStates, sensing: np.ndarray) -> np.ndarray:
        """Displacement along the sensing directions, (P, 3) unit vectors, at states; (P,) mm."""
        return np.einsum("ij,ij->i", sensing, self.moved_mm(states))


def _read(settings: Instrument, path: Path) -> tuple[Columns, tuple[Note, ...]]:
    """Columns of a test's file, in the order of time, and what is odd about them."""
    every = (*settings.columns, *settings.optional_columns)
    text = [name for name in every if name in settings.text_columns]
    numbers = [name for name in every if name not in settings.text_columns]
    table = read_side_by_side(path, settings.columns) if settings.has_runs else None
    accepted = {"t_s": _SECONDS, **dict.fromkeys(settings.signs, SIGNS_ACCEPTED)}
    sensors = settings.readings if settings.has_sensors else ()
    optional = (*settings.optional_columns, *sensors)
    table = table or read_columns(
        path, numbers=numbers, text=text, optional=optional, accepted=accepted
    )
    readings = [name for name in settings.readings if name in table.numbers]
    if not readings:
        said = f"none of the columns {', '.join(sensors)} is there"
        raise InputError(said, file=path, accepted="one of them or more, those that were read")
    notes = _unused(table)
    if settings.follows_program:
        return table, (*notes, *repeat_notes(table))
    if "t_s" in table.numbers:
        check_times(table)
        notes += clock_notes(table)
    if settings.signs:
        notes += check_signs(table, settings.signs)
    if "spindle_rpm" in settings.columns:
        notes += check_spindle(table)
    check_readings(table, readings)
    return table, (*notes, *still_notes(table, readings), *repeat_notes(table))


def _unused(table: Columns) -> tuple[Note, ...]:
    """A note for every column that says nothing to this instrument: its name may be a slip."""
    return tuple(
        Note.plain(Kind.COLUMN, f"column '{name}' is not used", place=name)
        for name in table.unused
        if name != _NAME
    )


def _twice(test: Measurement, others: Sequence[Measurement]) -> tuple[Note, ...]:
    """A note where an earlier test of the job has the same readings."""
    same = [o.name for o in others if np.array_equal(o.measured_mm, test.measured_mm)]
    if not same:
        return ()
    said = f"the readings are those of {same[0]}: is one test named twice?"
    return (Note.question(Kind.REPEAT, said, len(test), "1", place=same[0]),)


def _length(settings: Instrument) -> tuple[Note, ...]:
    """A note where the length of the tool, from spindle nose to tip, is none in mm."""
    length_mm = settings.tool_length_mm
    said = None if length_mm is None else doubtful_length("tool_length_mm", length_mm)
    if said is None:
        return ()
    return (Note.question(Kind.LENGTH, said, length_mm, "mm", place="tool_length_mm"),)


def settings_of(job: Job, number: int) -> Instrument:
    """One ``[[measurements]]`` of a job, counted from 0, checked.

    Raises
    ------
    InputError
        Unknown kind or key, a key missing, a value that is not accepted.
    """
    entry, within = job.measurements[number], ("measurements", str(number))
    text = read_text(job.path, what="job file")
    kinds = {n: kind for n, kind in sorted(catalogue().items()) if kind.is_section_of_job}
    kind = entry.get("kind")
    if not isinstance(kind, str) or kind not in kinds:
        raise InputError(
            "a measurement needs its kind" if kind is None else f"kind = {kind!r}",
            file=job.path,
            line=line_of_key(text, [*within, "kind"]),
            accepted=f"kind = {', '.join(kinds)}",
        )
    return check_section(entry, kinds[kind], file=job.path, text=text, within=within)
