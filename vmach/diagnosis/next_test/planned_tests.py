"""Tests that a machine can run: their motion, what they sense and what they leave free."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from vmach.job import Job
from vmach.machine import LINEAR_AXES
from vmach.measurements.test_motion import MotionRecord, stop_and_go
from vmach.path.toolpath import PathStates

__all__ = ["MAP", "TOOL_LENGTH_MM", "U_MM", "PlannedTest", "planned_tests"]

#: name of the test that maps the whole work space
MAP = "tip grid"
TOOL_LENGTH_MM = 150.0
#: standard uncertainty of a reading
U_MM = 0.5e-3


@dataclass(frozen=True)
class PlannedTest:
    """A test that could be run, with n readings.

    Attributes
    ----------
    name : str
    text : str
        What to do, in words.
    settings : dict
        Keys of its ``[[measurements]]``.
    states : PathStates
        The machine at each reading.
    sensing : (n, 3) float64
        Unit vector along which a displacement of the tool shows.
    nuisance : (n, K) float64
        Columns of what the instrument leaves free.
    """

    name: str
    text: str
    settings: dict[str, Any]
    states: PathStates
    sensing: np.ndarray
    nuisance: np.ndarray


def planned_tests(job: Job) -> Iterator[PlannedTest]:
    """Tests that can be run on the machine within its travel."""
    low, high = job.machine.travel_mm
    for k in range(len(LINEAR_AXES)):
        yield _laser_line(k, low, high)
    yield _ballbar(low, high)
    yield _drift(0.5 * (low + high))
    yield _tip_grid(low, high)


def _laser_line(k: int, low: np.ndarray, high: np.ndarray) -> PlannedTest:
    """One axis through the middle of the others."""
    axis, middle = LINEAR_AXES[k], 0.5 * (low + high)
    margin = 0.05 * (high[k] - low[k])
    steps = np.linspace(low[k] + margin, high[k] - margin, 30)
    fine = 0.5 * (low[k] + high[k]) + np.arange(0.0, 40.0, 1.3)
    out = np.sort(np.concatenate([steps, fine]))
    ways = np.concatenate([out, out[::-1]] * 3)
    nose = np.tile(middle, (len(ways), 1))
    nose[:, k] = ways
    side = np.zeros_like(nose)
    side[:, k] = np.concatenate([np.ones(len(out)), -np.ones(len(out))] * 3)
    states = stop_and_go(nose, 5.0 * np.arange(len(ways)), side=side, tool_length_mm=TOOL_LENGTH_MM)
    return PlannedTest(
        f"laser {axis}",
        f"laser line along {axis}, both ways three times, with fine steps in the middle",
        {"kind": "laser", "axis": axis, "at_mm": middle},
        states,
        np.tile(np.eye(3)[k], (len(ways), 1)),
        np.ones((len(ways), 1)),
    )


def _ballbar(low: np.ndarray, high: np.ndarray) -> PlannedTest:
    """Circles at two feeds, both ways round."""
    middle, radius = 0.5 * (low + high), min(150.0, 0.4 * float((high - low)[:2].min()))
    start = middle + np.array([radius, 0.0, 0.0])
    record = MotionRecord(middle, tool_length_mm=TOOL_LENGTH_MM)
    angle = np.radians(np.arange(0.5, 360.0, 2.0))
    moves, out, clock = [], [], 10.0
    for feed, turn in itertools.product((1000.0, 4000.0), (1.0, -1.0)):
        duration = 2 * np.pi * radius / feed * 60.0
        record.line(start, until_s=clock)
        # a turn and a half, so that the axes have reversed before the readings begin
        move = record.arc(
            2 * middle - start,
            centre_mm=middle,
            axis=np.array([0.0, 0.0, 1.0]),
            sweep_rad=turn * 3 * np.pi,
            until_s=clock + 1.5 * duration,
        )
        clock += 1.5 * duration + 10.0
        moves.append(np.full(len(angle), move))
        facing = turn * (np.pi + angle)
        out.append(np.column_stack([np.cos(facing), np.sin(facing), 0 * facing]))
    sensing = np.vstack(out)
    places = np.tile((np.pi + angle) / (3 * np.pi), len(moves))
    return PlannedTest(
        "ballbar XY",
        f"ballbar in XY, radius {radius:.0f} mm, both ways at 1000 and 4000 mm/min",
        {"kind": "ballbar", "plane": "XY", "centre_mm": middle, "radius_mm": radius},
        record.states(np.concatenate(moves), places),
        sensing,
        np.column_stack([np.ones(len(sensing)), sensing[:, :2]]),
    )


def _drift(middle: np.ndarray) -> PlannedTest:
    """The tool tip while the spindle warms, cools, and warms again."""
    time = np.arange(0.0, 9000.0, 60.0)
    rpm = np.where(time < 3600.0, 8000.0, np.where(time < 6300.0, 0.0, 4000.0))
    states = stop_and_go(
        np.tile(middle, (len(time), 1)),
        time,
        side=np.zeros((len(time), 3)),
        tool_length_mm=TOOL_LENGTH_MM,
        rpm=rpm,
    )
    return _in_three_directions(
        "drift",
        "drift test: probe nest on the table, spindle 60 min at 8000 rpm, 45 min standing, "
        "45 min at 4000 rpm, axes still",
        {"kind": "drift", "at_mm": middle},
        states,
        nuisance=np.tile(np.eye(3), (len(time), 1)),
    )


def _tip_grid(low: np.ndarray, high: np.ndarray) -> PlannedTest:
    """Places at random, each approached from a side at random."""
    random = np.random.default_rng(7)
    nose = random.uniform(low + 0.03 * (high - low), high - 0.03 * (high - low), (120, 3))
    side = random.choice([-1.0, 1.0], (120, 3))
    states = stop_and_go(nose, 8.0 * np.arange(120), side=side, tool_length_mm=TOOL_LENGTH_MM)
    unit = np.tile(np.eye(3), (120, 1))
    arm = np.repeat(nose - nose.mean(axis=0), 3, axis=0)
    return _in_three_directions(
        MAP,
        "tracker on the tool tip at 120 places all over the work space, each approached from a "
        "stated side",
        {"kind": "tip", "frame": "rigid"},
        states,
        nuisance=np.hstack([unit, np.cross(arm, unit)]),
    )


def _in_three_directions(
    name: str, text: str, settings: dict[str, Any], states: PathStates, *, nuisance: np.ndarray
) -> PlannedTest:
    """A test with a reading along each of X, Y and Z at every state."""
    thrice = states[np.repeat(np.arange(len(states)), 3)]
    sensing = np.tile(np.eye(3), (len(states), 1))
    return PlannedTest(name, text, settings, thrice, sensing, nuisance)
