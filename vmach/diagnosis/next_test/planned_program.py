"""A planned test as an NC program, with what to do with its readings in comments at its head."""

from __future__ import annotations

from typing import Any

import numpy as np

from gcode import MoveKind, Moves
from vmach.base.units import um_from_mm
from vmach.instruments import PlannedTest, catalogue
from vmach.instruments.readings import PLANNED_TOOL_LENGTH_MM
from vmach.job import Job

__all__ = ["U_MM", "write_program"]

#: standard uncertainty of a reading, of whatever instrument
U_MM = 0.5e-3
#: a comment holds no other
_NO_BRACKETS = str.maketrans("()", ",,")
#: plane of arcs about each axis, and which of I, J and K lie in it
_PLANES = (("G19", (1, 2)), ("G18", (0, 2)), ("G17", (0, 1)))
_SIDES = "{}: the last motion of each axis before the reading, 1 in +, -1 in -"


def write_program(test: PlannedTest, job: Job) -> str:
    """The test's motion as an NC program in the job's first work offset, without tool length.

    It comes to its first place from above, Z first drawn back to the end of its travel. Comments
    at its head say which columns its readings make, and what the job says of them.
    """
    name, offset = next(iter(job.work_offsets_mm.items()))
    moves = test.states.moves
    start = moves.start_mm[0] - offset
    lines = [
        "%",
        f"({test.text})",
        *(
            ["(part and fixtures off the table: the places are all over the work space)"]
            if test.maps_work_space
            else []
        ),
        f"(places of the spindle nose in {name} of the job, tool length off)",
        *(f"({line})" for line in _how_to_diagnose_again(test)),
        f"G21 G90 G94 G17 G40 G49 G80 {name}",
        f"G53 G0 Z{job.machine.travel_mm[1][2]:.4f}",
        f"G0 X{start[0]:.4f} Y{start[1]:.4f}",
        f"G0 Z{start[2]:.4f}",
    ]
    rpm = None
    for k in range(len(moves)):
        if moves.spindle_rpm[k] != rpm:
            rpm = moves.spindle_rpm[k]
            lines.append(f"S{rpm:.0f} M3" if rpm > 0 else "M5")
        lines += _lines_of_move(moves, k, offset)
    return "\n".join([*lines, "M5", "M30", "%", ""])


def _how_to_diagnose_again(test: PlannedTest) -> list[str]:
    """What to do with the readings: the columns of their file, and the job's section."""
    kind = test.settings["kind"]
    stated = {
        **test.settings,
        "file": f"{kind}.csv",
        "tool_length_mm": PLANNED_TOOL_LENGTH_MM,
        "u_um": um_from_mm(U_MM),
    }
    instrument = catalogue()[kind]
    return [
        "start with the machine cold; t_s counts from the start of this program",
        f"readings into {kind}.csv: {','.join(instrument.columns)}",
        instrument.sign_meaning.translate(_NO_BRACKETS),
        *([_SIDES.format(", ".join(instrument.signs))] if instrument.signs else []),
        "then into the job, with the length and the uncertainty that were used:",
        "[[measurements]]",
        *(f"{key} = {_toml(value)}" for key, value in stated.items()),
    ]


def _toml(value: Any) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    return "[" + ", ".join(f"{v:g}" for v in value) + "]" if np.ndim(value) else f"{value:g}"


def _lines_of_move(moves: Moves, k: int, offset: np.ndarray) -> list[str]:
    if moves.kind[k] == MoveKind.DWELL:
        return [f"G4 P{moves.duration_s[k]:.1f}"]
    if moves.kind[k] == MoveKind.ARC:
        return _arc_lines(moves, k, offset)
    x, y, z = moves.end_mm[k] - offset
    way = np.linalg.norm(moves.end_mm[k] - moves.start_mm[k])
    feed = min(max(60.0 * way / moves.duration_s[k], 100.0), 10000.0)
    return [f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f} F{feed:.0f}"]


def _arc_lines(moves: Moves, k: int, offset: np.ndarray) -> list[str]:
    """An arc as equal pieces of half a turn at most, and the XY plane again."""
    centre, sweep, axis = moves.centre_mm[k], moves.sweep_rad[k], moves.axis[k]
    out = moves.start_mm[k] - centre
    feed = 60.0 * abs(sweep) * np.linalg.norm(out) / moves.duration_s[k]
    plane, places = _PLANES[int(np.argmax(np.abs(axis)))]
    word = "G3" if sweep * axis.sum() > 0 else "G2"
    lines, here = [], moves.start_mm[k]
    for turned in np.linspace(0.0, sweep, int(np.ceil(abs(sweep) / np.pi - 1e-9)) + 1)[1:]:
        there = centre + np.cos(turned) * out + np.sin(turned) * np.cross(axis, out)
        x, y, z = there - offset
        back = " ".join(f"{'IJK'[p]}{(centre - here)[p]:.4f}" for p in places)
        lines.append(f"{word} X{x:.4f} Y{y:.4f} Z{z:.4f} {back} F{feed:.0f}")
        here = there
    return lines if plane == "G17" else [plane, *lines, "G17"]
