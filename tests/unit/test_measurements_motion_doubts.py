"""Approaches, times and circles that contradict their places are asked about, odd ones are not."""

import numpy as np
import pytest

from vmach.base.note import Kind
from vmach.measurements.plausibility.motion_doubts import (
    approach_notes,
    circle_notes,
    drift_notes,
    inch_notes,
    pace_notes,
)

TARGETS = np.arange(0.0, -500.0, -25.0)
THERE_AND_BACK = np.concatenate([TARGETS, TARGETS[::-1]] * 2)
SIGNS = np.repeat([-1.0, 1.0, -1.0, 1.0], len(TARGETS))


def along_x(values):
    return np.outer(values, [1.0, 0.0, 0.0])


def test_exchanged_approaches_are_asked_about():
    assert approach_notes(along_x(THERE_AND_BACK), along_x(SIGNS)) == ()
    (note,) = approach_notes(along_x(THERE_AND_BACK), along_x(-SIGNS))
    assert "76 of 76 approaches contradict the direction" in note.text


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_one_sided_approach_may_be_meant(side):
    """Always from one side, with an overrun: the usual way to keep lost motion out."""
    places = along_x(THERE_AND_BACK)
    assert approach_notes(places, along_x(np.full(len(places), side))) == ()


@pytest.mark.parametrize("first", [1.0, -1.0])
def test_pilgrim_steps_are_no_exchange(first):
    """Every target from both sides before the next one, ISO 230-2's other cycle."""
    places = along_x(np.repeat(TARGETS, 2))
    assert approach_notes(places, along_x(np.tile([first, -first], len(TARGETS)))) == ()


def test_places_all_over_the_volume():
    places = np.random.default_rng(4).uniform(-400, 0, (60, 3))
    side = np.vstack([np.zeros(3), np.sign(np.diff(places, axis=0))])
    assert approach_notes(places, side) == ()
    assert "177 of 177" in str(approach_notes(places, -side)[0])
    mixed = np.random.default_rng(5).choice([-1.0, 1.0], (60, 3))  # each with its own overrun
    assert approach_notes(places, mixed) == ()


def test_times_in_minutes_are_faster_than_rapid():
    """25 mm at 6000 mm/min and 4 s of standing; rapid motion is 20 m/min."""
    places, time = along_x(THERE_AND_BACK), 4.25 * np.arange(len(THERE_AND_BACK))
    assert pace_notes(places, time, 20000.0) == ()
    assert pace_notes(places, np.round(time), 20000.0) == ()
    (note,) = pace_notes(places, time / 60.0, 20000.0)
    assert "1900 mm in 5.596 s" in note.text and note.kind is Kind.CLOCK


def test_a_drift_test_takes_longer_than_minutes():
    assert drift_notes(np.arange(0.0, 3600.0, 30.0)) == ()
    assert "lasts 59.5 s" in str(drift_notes(np.arange(0.0, 3600.0, 30.0) / 60.0)[0])


@pytest.mark.parametrize(("plane", "asked"), [("XY", True), ("ZX", True), ("YX", False)])
def test_circles_turn_as_they_are_called(plane, asked):
    angle = np.radians(np.concatenate([np.arange(1, 360, 2), np.arange(359, 0, -2)]) % 360)
    runs = np.repeat(["CCW", "cw"], 180)
    assert circle_notes(runs, angle, plane) == ()
    assert bool(circle_notes(runs, -angle, plane)) == asked
    assert circle_notes(np.repeat(["first", "second"], 180), -angle, plane) == ()
    numbered = np.repeat(["CCW1", "cw 1000"], 180)  # as an import names them, and as people do
    assert circle_notes(numbered, angle, plane) == ()
    assert bool(circle_notes(numbered, -angle, plane)) == asked


ROOM = np.array([[-800.0, -500.0, -400.0], [0.0, 0.0, 0.0]])


def test_places_in_inches_are_asked_about():
    line = np.linspace(-780.0, -20.0, 21)
    places = np.column_stack([line, np.full((21, 2), -3.0)])
    assert inch_notes(places, ROOM, "the travel") == ()
    (note,) = inch_notes(places / [25.4, 1, 1], ROOM, "the travel")
    assert "from -30.71 to -0.7874 mm" in note.text and note.kind is Kind.UNIT


@pytest.mark.parametrize("middle", [-400.0, -60.0])
def test_a_short_line_that_would_leave_the_travel_in_inches_is_none(middle):
    places = np.column_stack([middle + np.linspace(-20.0, 20.0, 41), np.zeros((41, 2))])
    assert inch_notes(places, ROOM, "the travel") == ()


def test_a_short_line_that_would_stay_short_in_inches_is_none():
    places = np.column_stack([np.linspace(-14.0, -1.0, 27), np.zeros((27, 2))])
    assert inch_notes(places, ROOM, "the travel") == ()
