"""A small job written to disk: a rectangular pocket and a bore on a machine with chosen errors."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import trimesh

#: finished pocket, bore and blank, mm
POCKET_MM, DEPTH_MM, BORE_MM = (40.0, 30.0), 8.0, 12.0

PROGRAM = """\
%
G21 G17 G90 G94 G40
T1 M6
S6000 M3
G54 G43 H1
G0 X0 Y0 Z5
G1 Z-8 F300
G1 X-15 Y-10 F900
X15
Y10
X-15
Y-10
X15 Y-6
X-15 Y-2
X15 Y2
X-15 Y6
X15 Y9
G0 Z5
G0 X40 Y0
G1 Z-6 F300
G1 X41 F600
G2 X41 Y0 I-1 J0
G0 Z5
M5
M30
%
"""

MACHINE = """\
schema = 1
name = "test machine"
chain = "t (C) Z Y b X' w"
[convention]
sign = "relative"
length = "um"
angle = "urad"
[motion]
rapid_mm_min = 12000
tool_change_s = 5
[axes.X]
travel_mm = [-400, 0]
[axes.Y]
travel_mm = [-300, 0]
[axes.Z]
travel_mm = [-300, 0]
"""

JOB = """\
schema = 1
machine = "machine.toml"
program = "part.nc"
measured = "points.csv"
[work_offsets_mm]
G54 = [-200, -150, -200]
[stock]
min_mm = [-30, -25, -20]
max_mm = [60, 25, 0]
[tools.1]
shape = "flat"
diameter_mm = 10
length_mm = 100
"""


def pocket_points() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points on walls, floor and bore: names (P,), points and outward normals (P, 3)."""
    rows = []
    for t in np.linspace(-12, 12, 9):
        rows += [
            ("wall +X", (20, t * 0.8, -4), (-1, 0, 0)),
            ("wall -X", (-20, t * 0.8, -4), (1, 0, 0)),
        ]
        rows += [("wall +Y", (t, 15, -4), (0, -1, 0)), ("wall -Y", (t, -15, -4), (0, 1, 0))]
        rows += [("floor", (t, 0.5 * t, -8), (0, 0, 1))]
    for angle in np.linspace(0, 2 * np.pi, 24, endpoint=False) + 0.1:
        out = np.array([np.cos(angle), np.sin(angle), 0.0])
        rows += [("bore", np.array([40, 0, -3]) + BORE_MM / 2 * out, -out)]
    names, points, normals = zip(*rows, strict=True)
    return np.array(names), np.array(points, float), np.array(normals, float)


def write_points(path: Path, measured_mm: np.ndarray | None = None) -> None:
    """The points as CSV; measured exactly where they should be unless given."""
    names, points, normals = pocket_points()
    measured_mm = points if measured_mm is None else measured_mm
    lines = ["id,feature,x,y,z,i,j,k,mx,my,mz,u_um"]
    for k, row in enumerate(np.hstack([points, normals, measured_mm])):
        lines.append(f"{k + 1},{names[k]}," + ",".join(map(repr, row.tolist())) + ",0.5")
    path.write_text("\n".join(lines) + "\n")


def write_table(folder: Path, name: str, axis_range: tuple[float, float], curve) -> None:
    """An error table every 10 mm of a function of the position, um or urad."""
    (folder / "errors").mkdir(exist_ok=True)
    rows = [
        f"{x!r},{float(curve(x))!r},{float(curve(x))!r}"
        for x in np.arange(axis_range[0], 1e-9, 10.0).tolist()
    ]
    text = "position_mm,forward,backward\n" + "\n".join(rows) + "\n"
    (folder / "errors" / f"{name}.csv").write_text(text)


def write_job(
    folder: Path, errors: dict | None = None, *, squareness: str = "", more: str = ""
) -> Path:
    """Write job, machine, program and points; gives the job file.

    `errors` maps a component to (curve, measured_at_mm or None).
    """
    machine = MACHINE
    ranges = {"X": (-400.0, 0.0), "Y": (-300.0, 0.0), "Z": (-300.0, 0.0)}
    for name, (curve, at) in (errors or {}).items():
        write_table(folder, name, ranges[name[2]], curve)
        machine += f'[errors.{name}]\ntable = "errors/{name}.csv"\n'
        machine += f"measured_at_mm = {list(at)}\n" if at is not None else ""
    (folder / "machine.toml").write_text(machine + squareness)
    (folder / "part.nc").write_text(PROGRAM)
    (folder / "job.toml").write_text(JOB + more)
    write_points(folder / "points.csv")
    return folder / "job.toml"


def measurement(kind: str, **settings) -> str:
    """A ``[[measurements]]`` of a job; a tool of 100 mm and 0.3 um unless given."""
    told = {"kind": kind, "file": f"{kind}.csv", "tool_length_mm": 100, "u_um": 0.3} | settings
    lines = [f"{key} = {json.dumps(value)}" for key, value in told.items()]
    return "\n".join(["", "[[measurements]]", *lines, ""])


def write_nominal_stl(path: Path, *, shift_mm: tuple[float, float, float] = (0, 0, 0)) -> None:
    """The blank with the pocket alone, as a closed mesh (the bore is left out)."""
    block = trimesh.creation.box(bounds=[(-30, -25, -20), (60, 25, 0)])
    pocket = trimesh.creation.box(bounds=[(-20, -15, -8), (20, 15, 5)])
    part = trimesh.boolean.difference([block, pocket], engine="manifold")
    part.apply_translation(shift_mm)
    part.export(path)


def write_job_with_nominal(folder: Path, errors: dict | None = None) -> Path:
    """A job as `write_job` writes it, with CAD."""
    path = write_job(folder, errors)
    write_nominal_stl(folder / "part.stl")
    text = path.read_text()
    path.write_text(text.replace("measured =", 'nominal = "part.stl"\nmeasured =', 1))
    return path
