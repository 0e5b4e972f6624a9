"""Readings as most instruments take them: along a line, or in three directions at each place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from vmach.base.note import Note, in_file
from vmach.base.units import mm_from_um
from vmach.machine import LINEAR_AXES
from vmach.measurements import Measurement
from vmach.measurements.columns import Columns
from vmach.measurements.instrument import Instrument, ModelOfTest, PlannedTest
from vmach.measurements.plausibility.motion_check import check_extent, check_travel
from vmach.measurements.plausibility.motion_doubts import approach_notes, inch_notes, pace_notes
from vmach.path.instrument_motion import stop_and_go
from vmach.path.toolpath import PathStates

__all__ = [
    "ALONG",
    "PLANNED_TOOL_LENGTH_MM",
    "STRETCHES",
    "along_line",
    "doubts_of_stops",
    "in_stretches",
    "in_three_directions",
    "one_a_stop",
    "three_directions",
]

#: displacements along X, Y and Z of one place
ALONG = ("dx_um", "dy_um", "dz_um")
#: from spindle nose to tip, of tests that are planned
PLANNED_TOOL_LENGTH_MM = 150.0
#: standard uncertainty of the scale of a laser where none is stated; chosen: of the temperature of
#: screw or scale a quarter of a kelvin is not known, at 11.5 ppm/K (ISO 230-2, ISO/TR 230-9)
_ORDINARY_SCALE_PPM = 3.0
#: into how many stretches a test without runs is cut
STRETCHES = 10


def doubts_of_stops(
    nose_mm: np.ndarray, side: np.ndarray, table: Columns, model: ModelOfTest
) -> tuple[Note, ...]:
    """Notes on a test that drives from place to place, (P, 3) mm, each approached from a side."""
    pace = pace_notes(nose_mm, table.numbers["t_s"], model.rapid_mm_per_min)
    spot = inch_notes(nose_mm, model.travel_mm, "the travel")
    return in_file((*approach_notes(nose_mm, side), *pace, *spot), table.path)


def along_line(
    settings: Instrument,
    table: Columns,
    nose_mm: np.ndarray,
    *,
    direction: np.ndarray,
    scale_u_ppm: float | None,
    model: ModelOfTest,
) -> Measurement:
    """Readings of ``deviation_um`` along a straight line, its zero left free.

    Parameters
    ----------
    settings : Instrument
    table : Columns
        With ``run``, ``approach``, ``deviation_um`` and ``t_s``.
    nose_mm : (P, 3) float64
        Places of the spindle nose.
    direction : (3,) float64
        Unit vector of the line.
    scale_u_ppm : float, optional
        Standard uncertainty of the instrument's own scale, where it is stated.
    model : ModelOfTest

    Raises
    ------
    InputError
        Places outside the travel, or all but the same.
    """
    check_travel(nose_mm, table, model.travel_mm)
    check_extent(nose_mm, table)
    side = np.sign(table.numbers["approach"])[:, None] * np.sign(np.round(direction, 9))
    states = stop_and_go(
        nose_mm, table.numbers["t_s"], side=side, tool_length_mm=settings.tool_length_mm
    )
    sensing = np.tile(direction, (len(nose_mm), 1))
    notes = doubts_of_stops(nose_mm, side, table, model)
    test = one_a_stop(settings, table, states, sensing, model=model, notes=notes)
    ppm = _ORDINARY_SCALE_PPM if scale_u_ppm is None else scale_u_ppm
    scale_u_mm = 1e-6 * ppm * (nose_mm @ direction)
    return replace(test, scale_u_mm=scale_u_mm, scale_is_stated=scale_u_ppm is not None)


def one_a_stop(
    settings: Instrument,
    table: Columns,
    states: PathStates,
    sensing: np.ndarray,
    *,
    model: ModelOfTest,
    notes: tuple[Note, ...],
) -> Measurement:
    """One reading along `sensing` (P, 3) at each of P stops, its zero left free."""
    count = len(states)
    (column,) = settings.readings
    return Measurement(
        instrument=type(settings),
        name=table.path.name,
        id=table.text.get("id", np.arange(1, count + 1).astype(str)),
        states=states,
        sensing=sensing,
        measured_mm=mm_from_um(table.numbers[column]),
        predicted_mm=model.predicted_mm(states, sensing),
        u_mm=np.full(count, mm_from_um(settings.u_um)),
        group=np.char.add("run ", table.text["run"]),
        nuisance=np.ones((count, 1)),
        notes=notes,
    )


def three_directions(
    settings: Instrument,
    table: Columns,
    states: PathStates,
    *,
    model: ModelOfTest,
    nuisance: np.ndarray,
    notes: Sequence[Note],
) -> Measurement:
    """One reading along each of X, Y and Z at each of P states, or along those that were read.

    `nuisance` is (3 P, K); what it leaves free of directions that were not read is left out.
    """
    was_read = np.array([name in table.numbers for name in ALONG])
    along = [name for name in ALONG if name in table.numbers]
    count, sensors = len(states), len(along)
    own = states[np.repeat(np.arange(count), sensors)]
    sensing = np.tile(np.eye(3)[was_read], (count, 1))
    free = nuisance[np.tile(was_read, count)]
    return Measurement(
        instrument=type(settings),
        name=table.path.name,
        id=np.repeat(np.arange(1, count + 1), sensors).astype(str),
        states=own,
        sensing=sensing,
        measured_mm=mm_from_um(table.vectors(along).ravel()),
        predicted_mm=model.predicted_mm(own, sensing),
        u_mm=np.full(sensors * count, mm_from_um(settings.u_um)),
        group=np.tile([f"along {LINEAR_AXES[k]}" for k in np.flatnonzero(was_read)], count),
        nuisance=free[:, free.any(axis=0)],
        notes=tuple(notes),
    )


def in_stretches(measurement: Measurement) -> np.ndarray:
    """Stretches of a test of three directions at once, (P,) str, to be held out together.

    Cut across the directions: without any reading along X nothing could be foretold of it.
    """
    number = np.arange(len(measurement)) * STRETCHES // len(measurement)
    return np.array([f"stretch {s}" for s in number])


def in_three_directions(
    name: str,
    text: str,
    settings: dict[str, Any],
    states: PathStates,
    *,
    nuisance: np.ndarray,
    maps_work_space: bool = False,
) -> PlannedTest:
    """A planned test, read along X, Y, Z at each of P states; `nuisance` is (R, K), R = 3 P."""
    thrice = states[np.repeat(np.arange(len(states)), 3)]
    sensing = np.tile(np.eye(3), (len(states), 1))
    return PlannedTest(name, text, settings, thrice, sensing, nuisance, maps_work_space)
