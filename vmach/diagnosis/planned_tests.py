"""Tests that a machine can run, simulated and written as NC programs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from gcode import MoveKind
from vmach.job import Job
from vmach.machine import LINEAR_AXES
from vmach.measurements.instrument_settings import KINDS
from vmach.measurements.test_motion import MotionRecord, stop_and_go
from vmach.toolpath import PathStates
from vmach.units import um_from_mm

__all__ = ["MAP", "U_MM", "PlannedTest", "planned_tests", "write_program"]

#: name of the test that maps the whole work space
MAP = "tip grid"
_TOOL_MM = 150.0
#: standard uncertainty of a reading
U_MM = 0.5e-3


@dataclass(frozen=True)
class PlannedTest:
    """A test that could be run: its motion, what it senses and leaves free.

    `settings` are the keys of its ``[[measurements]]``.
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
    middle = 0.5 * (low + high)
    for k, axis in enumerate(LINEAR_AXES):
        yield _laser_line(k, axis, low, high, middle)
    yield _ballbar(low, high, middle)
    yield _drift(middle)
    yield _tip_grid(low, high)


def _laser_line(k: int, axis: str, low, high, middle) -> PlannedTest:
    margin = 0.05 * (high[k] - low[k])
    steps = np.linspace(low[k] + margin, high[k] - margin, 30)
    fine = 0.5 * (low[k] + high[k]) + np.arange(0.0, 40.0, 1.3)
    out = np.sort(np.concatenate([steps, fine]))
    ways = np.concatenate([out, out[::-1]] * 3)
    nose = np.tile(middle, (len(ways), 1))
    nose[:, k] = ways
    side = np.zeros_like(nose)
    side[:, k] = np.concatenate([np.ones(len(out)), -np.ones(len(out))] * 3)
    states = stop_and_go(nose, 5.0 * np.arange(len(ways)), side=side, tool_length_mm=_TOOL_MM)
    return PlannedTest(
        f"laser {axis}",
        f"laser line along {axis}, both ways three times, with fine steps in the middle",
        {"kind": "laser", "axis": axis, "at_mm": middle},
        states,
        np.tile(np.eye(3)[k], (len(ways), 1)),
        np.ones((len(ways), 1)),
    )


def _ballbar(low, high, middle) -> PlannedTest:
    radius = min(150.0, 0.4 * float((high - low)[:2].min()))
    record = MotionRecord(middle, tool_length_mm=_TOOL_MM)
    angle = np.radians(np.arange(0.5, 360.0, 2.0))
    moves, places, out = [], [], []
    clock = 10.0
    for feed in (1000.0, 4000.0):
        for turn in (1.0, -1.0):
            duration = 2 * np.pi * radius / feed * 60.0
            start = middle + np.array([radius, 0.0, 0.0])
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
            places.append((np.pi + angle) / (3 * np.pi))
            facing = turn * (np.pi + angle)
            out.append(np.column_stack([np.cos(facing), np.sin(facing), 0 * facing]))
    sensing = np.vstack(out)
    states = record.states(np.concatenate(moves), np.concatenate(places))
    return PlannedTest(
        "ballbar XY",
        f"ballbar in XY, radius {radius:.0f} mm, both ways at 1000 and 4000 mm/min",
        {"kind": "ballbar", "plane": "XY", "centre_mm": middle, "radius_mm": radius},
        states,
        sensing,
        np.column_stack([np.ones(len(sensing)), sensing[:, :2]]),
    )


def _drift(middle) -> PlannedTest:
    time = np.arange(0.0, 9000.0, 60.0)
    rpm = np.where(time < 3600.0, 8000.0, np.where(time < 6300.0, 0.0, 4000.0))
    states = stop_and_go(
        np.tile(middle, (len(time), 1)),
        time,
        side=np.zeros((len(time), 3)),
        tool_length_mm=_TOOL_MM,
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


def _tip_grid(low, high) -> PlannedTest:
    random = np.random.default_rng(7)
    nose = random.uniform(low + 0.03 * (high - low), high - 0.03 * (high - low), (120, 3))
    side = random.choice([-1.0, 1.0], (120, 3))
    states = stop_and_go(nose, 8.0 * np.arange(120), side=side, tool_length_mm=_TOOL_MM)
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


def _in_three_directions(name, text, settings, states: PathStates, *, nuisance) -> PlannedTest:
    """The test with a reading along each of X, Y and Z at every state."""
    thrice = states[np.repeat(np.arange(len(states)), 3)]
    sensing = np.tile(np.eye(3), (len(states), 1))
    return PlannedTest(name, text, settings, thrice, sensing, nuisance)


def write_program(test: PlannedTest, job: Job) -> str:
    """The test's motion as an NC program in the job's first work offset, without tool length.

    It comes to its first place from above, Z first drawn back to the end of its travel. Comments
    at its head say which columns its readings make, and what the job says of them.
    """
    offset = next(iter(job.work_offsets_mm.items()))
    moves = test.states.moves
    start = moves.start_mm[0] - offset[1]
    lines = [
        "%",
        f"({test.text})",
        "(part and fixtures off the table: the places are all over the work space)",
        f"(places of the spindle nose in {offset[0]} of the job, tool length off)",
        *(f"({line})" for line in _how_to_diagnose_again(test)),
        f"G21 G90 G94 G17 G40 G49 G80 {offset[0]}",
        f"G53 G0 Z{job.machine.travel_mm[1][2]:.4f}",
        f"G0 X{start[0]:.4f} Y{start[1]:.4f}",
        f"G0 Z{start[2]:.4f}",
    ]
    rpm = None
    for k in range(len(moves)):
        if moves.spindle_rpm[k] != rpm:
            rpm = moves.spindle_rpm[k]
            lines.append(f"S{rpm:.0f} M3" if rpm > 0 else "M5")
        end = moves.end_mm[k] - offset[1]
        place = f"X{end[0]:.4f} Y{end[1]:.4f} Z{end[2]:.4f}"
        way = np.linalg.norm(moves.end_mm[k] - moves.start_mm[k])
        if moves.kind[k] == MoveKind.DWELL:
            lines.append(f"G4 P{moves.duration_s[k]:.1f}")
        elif moves.kind[k] == MoveKind.ARC:
            lines += _arc_lines(moves, k, offset[1])
        else:
            feed = min(max(60.0 * way / moves.duration_s[k], 100.0), 10000.0)
            lines.append(f"G1 {place} F{feed:.0f}")
    return "\n".join([*lines, "M5", "M30", "%", ""])


def _how_to_diagnose_again(test: PlannedTest) -> list[str]:
    """What to do with the readings: the columns of their file, and the job's section."""
    kind = test.settings["kind"]
    stated = {
        **test.settings,
        "file": f"{kind}.csv",
        "tool_length_mm": _TOOL_MM,
        "u_um": um_from_mm(U_MM),
    }
    return [
        f"readings into {kind}.csv: {','.join(KINDS[kind].columns)}",
        "then into the job, with the length and the uncertainty that were used:",
        "[[measurements]]",
        *(f"{key} = {_toml(value)}" for key, value in stated.items()),
    ]


def _toml(value: Any) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    return "[" + ", ".join(f"{v:g}" for v in value) + "]" if np.ndim(value) else f"{value:g}"


def _arc_lines(moves, k: int, offset: np.ndarray) -> list[str]:
    """An arc as half turns."""
    centre, sweep = moves.centre_mm[k], moves.sweep_rad[k]
    radius = np.linalg.norm(moves.start_mm[k] - centre)
    feed = 60.0 * abs(sweep) * radius / moves.duration_s[k]
    word = "G3" if sweep > 0 else "G2"
    lines, here = [], moves.start_mm[k]
    for _ in range(round(abs(sweep) / np.pi)):
        there = 2 * centre - here
        x, y, z = there - offset
        i, j, _ = centre - here
        lines.append(f"{word} X{x:.4f} Y{y:.4f} Z{z:.4f} I{i:.4f} J{j:.4f} F{feed:.0f}")
        here = there
    return lines
