"""LinuxCNC's own interpreter as a judge of programs: accepted or not, and the path it makes.

Needs Debian's linuxcnc-uspace: ``rs274`` says whether a program is accepted, and LinuxCNC's
Python module gives its canonical calls with all digits (``golden/gcode/make_golden.py`` prints
them, run by the system's Python).
"""

import shutil
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

__all__ = ["Verdict", "is_installed", "judge", "rows_of"]

PRINTER = Path(__file__).parents[1] / "golden" / "gcode" / "make_golden.py"
SYSTEM_PYTHON = Path("/usr/bin/python3")
INCH_MM = 25.4
AXES_OF_PLANE = {1: (0, 1, 2), 2: (1, 2, 0), 3: (2, 0, 1)}
RAPID, LINE, ARC = 0, 1, 2
_MOVING = {"straight_feed", "straight_traverse", "straight_probe", "arc_feed", "rigid_tap"}
_CALLS = {
    "set_g5x_offset",
    "set_g92_offset",
    "tool_offset",
    "set_xy_rotation",
    "set_plane",
    "set_feed_rate",
    *_MOVING,
}


def is_installed():
    return shutil.which("rs274") is not None and SYSTEM_PYTHON.exists()


@dataclass
class Verdict:
    """What LinuxCNC makes of a program; rows are moves in machine coordinates, mm."""

    refusal: str | None = None
    line: list[int] = field(default_factory=list)
    kind: list[int] = field(default_factory=list)
    start: list[np.ndarray] = field(default_factory=list)
    end: list[np.ndarray] = field(default_factory=list)
    arc: list[tuple | None] = field(default_factory=list)  #: centre, axis vector, turns
    feed: list[float] = field(default_factory=list)

    def __len__(self):
        return len(self.kind)

    def at(self, row, share):
        """Place at a share of a row's path; radius and height change linearly with the angle."""
        start, end = self.start[row], self.end[row]
        if self.arc[row] is None or share in (0.0, 1.0):
            return start + share * (end - start)
        centre, axis, turns = self.arc[row]
        heights = axis @ (start - centre), axis @ (end - centre)
        out = [p - centre - h * axis for p, h in zip((start, end), heights, strict=True)]
        radii = [np.linalg.norm(v) for v in out]
        side = np.cross(axis, out[0])
        angle = np.arctan2(side @ out[1] / radii[0], out[0] @ out[1] / radii[0])
        angle = np.sign(turns) * angle
        if angle < 1e-6:
            angle += 2 * np.pi
        angle = np.sign(turns) * (angle + (abs(turns) - 1) * 2 * np.pi)
        radius = radii[0] + share * (radii[1] - radii[0])
        turned = np.cos(share * angle) * out[0] + np.sin(share * angle) * side
        rise = heights[0] + share * (heights[1] - heights[0])
        return centre + turned * radius / radii[0] + rise * axis


def judge(text, *, tools=(), work_offsets_mm=None):
    """Let LinuxCNC read a program.

    Parameters
    ----------
    text : bytes
    tools : iterable of (number, length_mm, diameter_mm)
    work_offsets_mm : mapping of "G54" ... to three numbers
    """
    table = "".join(f"T{n} P{n} D{d / INCH_MM!r} Z{z / INCH_MM!r}\n" for n, z, d in tools)
    parameters = _parameters(work_offsets_mm or {})
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "program.ngc"
        program.write_bytes(text)
        refused = _run(folder, table, parameters, "rs274", "-t", "tool.tbl", "-v", "p.var",
                       "-n", "2", "-g", str(program))  # fmt: skip
        if refused.returncode and "no percent" in refused.stderr:
            program.write_bytes(text + b"\nM2\n")
            refused = _run(folder, table, parameters, "rs274", "-t", "tool.tbl", "-v", "p.var",
                           "-n", "2", "-g", str(program))  # fmt: skip
        if refused.returncode:
            said = [s for s in refused.stderr.splitlines() if not s.startswith("executing")]
            return Verdict(refusal=" | ".join(said[-3:]))
        told = _run(folder, table, parameters, str(SYSTEM_PYTHON), str(PRINTER), str(program),
                    "tool.tbl", "p.var")  # fmt: skip
        if told.returncode:
            return Verdict(refusal=told.stderr.strip()[-300:])
    return rows_of(told.stdout)


def _run(folder, table, parameters, *command):
    Path(folder, "tool.tbl").write_text(table)
    Path(folder, "p.var").write_text(parameters)
    return subprocess.run(
        command,
        cwd=folder,
        env={"HOME": folder, "PATH": "/usr/bin:/bin"},
        capture_output=True,
        encoding="latin-1",
        timeout=120,
        check=False,
    )


def _parameters(work_offsets_mm):
    names = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"]
    lines = [(5220, 1.0)]
    for name, offset in work_offsets_mm.items():
        first = 5221 + 20 * names.index(name)
        lines += [(first + axis, value / INCH_MM) for axis, value in enumerate(offset)]
    return "".join(f"{index}\t{value!r}\n" for index, value in sorted(lines))


def rows_of(printed):
    """Canonical calls to moves in machine coordinates: R (point + G92) + G5x + tool offset."""
    verdict = Verdict()
    g5x, g92, tool, angle, plane, feed = np.zeros(3), np.zeros(3), np.zeros(3), 0.0, 1, 0.0
    here = np.zeros(3)
    for text in printed.splitlines():
        number, call, *words = text.split()
        if call not in _CALLS:
            continue
        values = [float(w) for w in words]
        if call == "set_g5x_offset":
            g5x = np.array(values[1:4])
        elif call == "set_g92_offset":
            g92 = np.array(values[:3])
        elif call == "tool_offset":
            tool = np.array(values[:3])
        elif call == "set_xy_rotation":
            angle = np.radians(values[0])
        elif call == "set_plane":
            plane = int(values[0])
        elif call == "set_feed_rate":
            feed = values[0]
        elif call in _MOVING:
            turn = np.array([[np.cos(angle), -np.sin(angle), 0.0],
                             [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])  # fmt: skip
            arc, end = None, np.array(values[:3])
            if call == "arc_feed":
                first, second, axial = AXES_OF_PLANE[plane]
                end, centre, axis = np.zeros(3), np.zeros(3), np.zeros(3)
                end[[first, second, axial]] = values[0], values[1], values[5]
                centre[[first, second]] = values[2:4]
                axis[axial] = 1.0
                arc = turn @ (centre + g92) + g5x + tool, turn @ axis, int(values[4])
            end = turn @ (end + g92) + g5x + tool
            verdict.line.append(int(number))
            verdict.kind.append({"straight_traverse": RAPID, "arc_feed": ARC}.get(call, LINE))
            verdict.start.append(here)
            verdict.end.append(end)
            verdict.arc.append(arc)
            verdict.feed.append(feed)
            here = end
    return verdict
