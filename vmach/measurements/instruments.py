"""Ballbar, laser, diagonal, drift and tip tests: from a file to a `Measurement`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np

from vmach.base.units import mm_from_um
from vmach.errors import InputError
from vmach.job import Job
from vmach.machine import LINEAR_AXES, Variant, displacement
from vmach.measurements.ballbar_motion import Circle, circles
from vmach.measurements.columns import Columns, read_columns
from vmach.measurements.instrument_settings import (
    ALONG,
    Ballbar,
    Diagonal,
    Drift,
    InstrumentSettings,
    Laser,
    Tip,
    settings_of,
)
from vmach.measurements.measurement import Measurement
from vmach.measurements.plausibility.motion_check import (
    check_extent,
    check_feed,
    check_times,
    check_travel,
)
from vmach.measurements.plausibility.motion_doubts import (
    approach_notes,
    circle_notes,
    drift_notes,
    lost_motion_notes,
    pace_notes,
)
from vmach.measurements.plausibility.otherwise import (
    Otherwise,
    exchanged,
    exchanged_tables,
    is_doubtful,
    otherwise_notes,
)
from vmach.measurements.plausibility.reading_check import (
    check_readings,
    check_signs,
    check_spindle,
    clock_notes,
    repeat_notes,
    still_notes,
)
from vmach.measurements.plausibility.unit_check import check_unit
from vmach.measurements.test_motion import stop_and_go
from vmach.path.toolpath import PathStates
from vmach.plausibility import doubtful_length
from vmach.prediction import ActingEffect

__all__ = ["read_instruments"]


def read_instruments(
    job: Job, *, variant: Variant = Variant.ABBE, effects: Sequence[ActingEffect] = ()
) -> tuple[Measurement, ...]:
    """The ``[[measurements]]`` of a job, each with what the model predicts for it.

    Raises
    ------
    InputError
        Unknown kind or key, missing file or column, a value that is no number, another unit.
    """
    found = []
    for number in range(len(job.measurements)):
        settings = settings_of(job, number)
        path = job.folder / settings.file
        table, noticed = _read(settings, path)
        test = _READERS[settings.kind](settings, table, _Model(job, variant, effects))
        check_unit(test, path)
        test = test.noted(*_named(path, noticed), *_twice(test, found))
        if doubt := doubtful_length("tool_length_mm", settings.tool_length_mm):
            test = test.noted(f"{test.name}: {doubt}")
        if is_doubtful(test):
            others = _otherwise(settings, table, job=job, variant=variant, effects=effects)
            test = test.noted(*otherwise_notes(test, others))
        found.append(test)
    return tuple(found)


def _otherwise(
    settings: InstrumentSettings,
    table: Columns,
    *,
    job: Job,
    variant: Variant,
    effects: Sequence[ActingEffect],
) -> Iterator[Otherwise]:
    """What the model says of a test if something that the job says of it were mistaken."""
    read = _READERS[settings.kind]
    for change in settings.mistaken():
        ((key, value),) = change.items()
        with suppress(InputError):  # it cannot have been so
            other = read(settings.model_copy(update=change), table, _Model(job, variant, effects))
            said = f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value:g}"
            question = f"is {key} = {getattr(settings, key)} in the job right?"
            yield Otherwise(said, question, other.predicted_mm)
    for axes, machine in exchanged_tables(job.machine):
        model = _Model(replace(job, machine=machine), variant, effects)
        yield exchanged(axes, read(settings, table, model).predicted_mm)


class _Model:
    """Displacement of the tool tip at the states of a test."""

    def __init__(self, job: Job, variant: Variant, effects: Sequence[ActingEffect]) -> None:
        self._job, self._variant, self._effects = job, variant, effects
        self.travel_mm = np.asarray(job.machine.travel_mm)
        self.rapid_mm_per_min = job.machine.motion.rapid_mm_per_min

    def predicted_mm(self, states: PathStates, sensing: np.ndarray) -> np.ndarray:
        machine = self._job.machine
        direction = states.direction if machine.separate_directions else None
        moved = displacement(
            machine, states.nose_mm, states.tool_mm, self._variant, direction=direction
        )
        for effect in self._effects:
            moved = moved + effect.displacement(states)
        return np.einsum("ij,ij->i", sensing, moved.shift_mm)


def _read(settings: InstrumentSettings, path: Path) -> tuple[Columns, tuple[str, ...]]:
    """Columns of a test's file, in the order of time, and what is odd about them.

    Only names of runs are text.
    """
    text = [name for name in settings.columns if name == "run"]
    numbers = [name for name in settings.columns if name != "run"]
    table = read_columns(path, numbers=numbers, text=text)
    check_times(table)
    notes = clock_notes(table)
    if settings.signs:
        notes += check_signs(table, settings.signs)
    if "spindle_rpm" in settings.columns:
        check_spindle(table)
    check_readings(table, settings.readings)
    return table, (*notes, *still_notes(table, settings.readings), *repeat_notes(table))


def _twice(test: Measurement, others: Sequence[Measurement]) -> tuple[str, ...]:
    """A note where an earlier test of the job has the same readings."""
    same = [o.name for o in others if np.array_equal(o.measured_mm, test.measured_mm)]
    if not same:
        return ()
    return (f"{test.name}: the readings are those of {same[0]}: is one test named twice?",)


def _ballbar(settings: Ballbar, table: Columns, model: _Model) -> Measurement:
    across, upward = (np.eye(3)[LINEAR_AXES.index(axis)] for axis in settings.plane)
    circle = Circle(
        np.array(settings.centre_mm), across, upward, settings.radius_mm, settings.tool_length_mm
    )
    angle, feed = np.radians(table.numbers["angle_deg"]), table.numbers["feed_mm_min"]
    group = np.char.add(np.char.add(table.text["run"], " "), feed.astype(str))
    states = circles(circle, angle, table.numbers["t_s"], group=group, path=table.path)
    out = circle.outward(angle)
    check_feed(table, group, settings.radius_mm)
    check_travel(circle.centre_mm + circle.radius_mm * out, table, model.travel_mm)
    return Measurement(
        kind="ballbar",
        name=table.path.name,
        id=np.arange(1, len(out) + 1).astype(str),
        states=states,
        sensing=out,
        measured_mm=mm_from_um(table.numbers["radius_um"]),
        predicted_mm=model.predicted_mm(states, out),
        u_mm=np.full(len(out), mm_from_um(settings.u_um)),
        group=group,
        nuisance=np.column_stack([np.ones(len(out)), np.cos(angle), np.sin(angle)]),
        notes=_named(table.path, circle_notes(table.text["run"], angle, settings.plane)),
    )


def _laser(settings: Laser, table: Columns, model: _Model) -> Measurement:
    axis = LINEAR_AXES.index(settings.axis)
    nose = np.tile(settings.at_mm, (len(table.numbers["t_s"]), 1))
    nose[:, axis] = table.numbers["position_mm"]
    test = _along_line(settings, table, nose, direction=np.eye(3)[axis], model=model)
    if test.notes:
        return test
    return test.noted(*_named(table.path, lost_motion_notes(test, table.numbers["approach"])))


def _diagonal(settings: Diagonal, table: Columns, model: _Model) -> Measurement:
    start, end = np.array(settings.from_mm), np.array(settings.to_mm)
    length = float(np.linalg.norm(end - start))
    if length == 0.0:
        raise InputError(
            "from_mm and to_mm are the same place",
            file=table.path,
            accepted="two ends of a diagonal",
        )
    direction = (end - start) / length
    nose = start + table.numbers["distance_mm"][:, None] * direction
    return _along_line(settings, table, nose, direction=direction, model=model)


def _along_line(
    settings: Laser | Diagonal,
    table: Columns,
    nose_mm: np.ndarray,
    *,
    direction: np.ndarray,
    model: _Model,
) -> Measurement:
    """Readings along a straight line, zero left free."""
    check_travel(nose_mm, table, model.travel_mm)
    check_extent(nose_mm, table)
    count = len(nose_mm)
    side = np.sign(table.numbers["approach"])[:, None] * np.sign(np.round(direction, 9))
    states = stop_and_go(
        nose_mm, table.numbers["t_s"], side=side, tool_length_mm=settings.tool_length_mm
    )
    sensing = np.tile(direction, (count, 1))
    return Measurement(
        kind=settings.kind,
        name=table.path.name,
        id=np.arange(1, count + 1).astype(str),
        states=states,
        sensing=sensing,
        measured_mm=mm_from_um(table.numbers["deviation_um"]),
        predicted_mm=model.predicted_mm(states, sensing),
        u_mm=np.full(count, mm_from_um(settings.u_um)),
        group=np.char.add("run ", table.text["run"]),
        nuisance=np.ones((count, 1)),
        notes=_doubts_of_stops(nose_mm, side, table, model),
    )


def _doubts_of_stops(
    nose_mm: np.ndarray, side: np.ndarray, table: Columns, model: _Model
) -> tuple[str, ...]:
    """Notes on a test that drives from place to place."""
    pace = pace_notes(nose_mm, table.numbers["t_s"], model.rapid_mm_per_min)
    return _named(table.path, (*approach_notes(nose_mm, side), *pace))


def _named(path: Path, notes: Sequence[str]) -> tuple[str, ...]:
    """Notes with the file that they are about."""
    return tuple(f"{path.name}: {note}" for note in notes)


def _drift(settings: Drift, table: Columns, model: _Model) -> Measurement:
    time = table.numbers["t_s"]
    nose = np.tile(settings.at_mm, (len(time), 1))
    check_travel(nose, table, model.travel_mm)
    states = stop_and_go(
        nose,
        time,
        side=np.zeros((len(time), 3)),
        tool_length_mm=settings.tool_length_mm,
        rpm=table.numbers["spindle_rpm"],
    )
    zero = np.tile(np.eye(3), (len(time), 1))
    return _three_directions(
        "drift",
        settings,
        table,
        states,
        model=model,
        nuisance=zero,
        notes=_named(table.path, drift_notes(time)),
    )


def _tip(settings: Tip, table: Columns, model: _Model) -> Measurement:
    nose = table.vectors("XYZ")
    check_travel(nose, table, model.travel_mm)
    check_extent(nose, table)
    side = np.sign(table.vectors(("sx", "sy", "sz")))
    states = stop_and_go(
        nose, table.numbers["t_s"], side=side, tool_length_mm=settings.tool_length_mm
    )
    unit = np.tile(np.eye(3), (len(nose), 1))
    nuisance = unit
    if settings.frame == "rigid":
        arm = np.repeat(nose - nose.mean(axis=0), 3, axis=0)
        nuisance = np.hstack([unit, np.cross(arm, unit)])
    return _three_directions(
        "tip",
        settings,
        table,
        states,
        model=model,
        nuisance=nuisance,
        notes=_doubts_of_stops(nose, side, table, model),
    )


def _three_directions(
    kind: str,
    settings: InstrumentSettings,
    table: Columns,
    states: PathStates,
    *,
    model: _Model,
    nuisance: np.ndarray,
    notes: Sequence[str],
) -> Measurement:
    """One reading along each of X, Y and Z at every state."""
    count = len(states)
    thrice = states[np.repeat(np.arange(count), 3)]
    sensing = np.tile(np.eye(3), (count, 1))
    return Measurement(
        kind=kind,
        name=table.path.name,
        id=np.repeat(np.arange(1, count + 1), 3).astype(str),
        states=thrice,
        sensing=sensing,
        measured_mm=mm_from_um(table.vectors(ALONG).ravel()),
        predicted_mm=model.predicted_mm(thrice, sensing),
        u_mm=np.full(3 * count, mm_from_um(settings.u_um)),
        group=np.tile([f"along {axis}" for axis in LINEAR_AXES], count),
        nuisance=nuisance,
        notes=tuple(notes),
    )


_READERS: dict[str, Callable[..., Measurement]] = {
    "ballbar": _ballbar,
    "laser": _laser,
    "diagonal": _diagonal,
    "drift": _drift,
    "tip": _tip,
}
