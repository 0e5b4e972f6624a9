"""The slot's program and its exact wall points, from the poles of its centre line.

Run from anywhere:  python samples/spline_slot/make_program.py

The centre line is a clamped uniform cubic B-spline (centreline.csv). Walls and finishing path are
exact parallels of it; the finishing path has its nodes on the parallel and a chord error below
0.5 um.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.interpolate import BSpline

FOLDER = Path(__file__).resolve().parent
WIDTH_MM, DEPTH_MM = 30.0, 15.0
TOOL_RADIUS_MM = 10.0
WALL_ALLOWANCE_MM, FLOOR_ALLOWANCE_MM = 0.3, 0.2
FINISH_SAG_MM, ROUGH_SAG_MM = 4e-4, 2e-2
LONGEST_CHORD_MM = 3.0
OFFSET_MM = WIDTH_MM / 2 - TOOL_RADIUS_MM
HEADER = """\
%
O2017 (FREE-FORM SLOT 30 WIDE, 15 DEEP; ZERO ON TOP FACE)
(T1 END MILL D20 Z3, ROUGHING: 0.3 LEFT ON WALLS, 0.2 ON FLOOR)
(T2 END MILL D20 Z4, FINISHING: WALLS DOWN-MILLED)
G21 G17 G90 G94 G40 G49 G80
G54
"""


def centre_line() -> BSpline:
    """Clamped uniform cubic B-spline over [0, 1] with the poles of the file."""
    poles = np.loadtxt(FOLDER / "centreline.csv", delimiter=",", skiprows=1)
    spans = len(poles) - 3
    inner = np.arange(1, spans) / spans
    return BSpline(np.concatenate([np.zeros(4), inner, np.ones(4)]), poles, 3)


def parallel(line: BSpline, u: np.ndarray, offset_mm: float) -> np.ndarray:
    """Points (K, 2) at a distance to the left of the centre line."""
    return line(u) + offset_mm * left_normal(line, u)


def left_normal(line: BSpline, u: np.ndarray) -> np.ndarray:
    """Unit normals to the left of the centre line, (K, 2)."""
    tangent = line(u, 1)
    tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
    return np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1)


def nodes(line: BSpline, ends: tuple[float, float], offset_mm: float, sag_mm: float) -> np.ndarray:
    """Parameters along a parallel whose chords stay within a sag, spread evenly."""
    fine = np.linspace(*sorted(ends), 20001)
    points = parallel(line, fine, offset_mm)
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    velocity, acceleration = line(fine, 1), line(fine, 2)
    speed = np.linalg.norm(velocity, axis=1)
    turning = velocity[:, 0] * acceleration[:, 1] - velocity[:, 1] * acceleration[:, 0]
    curvature = turning / speed**3
    curvature = np.abs(curvature / (1 - curvature * offset_mm))
    chord = np.minimum(np.sqrt(8 * sag_mm / np.maximum(curvature, 1e-9)), LONGEST_CHORD_MM)
    steps = np.concatenate([[0], np.cumsum(np.diff(length) / (0.5 * (chord[1:] + chord[:-1])))])
    wanted = np.linspace(0, steps[-1], int(np.ceil(steps[-1])) + 1)
    u = np.interp(wanted, steps, fine)
    return u if ends[0] < ends[1] else u[::-1]


def along(line: BSpline, ends: tuple[float, float], offset_mm: float, sag_mm: float) -> list[str]:
    """Blocks along a parallel, without its first point."""
    points = parallel(line, nodes(line, ends, offset_mm, sag_mm), offset_mm)[1:]
    blocks = [f"X{x:.4f} Y{y:.4f}" for x, y in points]
    return [f"G1 {blocks[0]}", *blocks[1:]]


def arc(start: np.ndarray, end: np.ndarray, centre: np.ndarray) -> str:
    """Counter-clockwise arc; the centre is given from the start as it was written."""
    i, j = centre - np.round(start, 4)
    return f"G3 X{end[0]:.4f} Y{end[1]:.4f} I{i:.4f} J{j:.4f}"


def turn(line: BSpline, u: float, offset_mm: float) -> str:
    """Half circle about an end of the centre line, to its other side."""
    there = offset_mm if u == 1 else -offset_mm
    return arc(parallel(line, u, -there), parallel(line, u, there), line(u))


def round_trip(line: BSpline, start: float, offset_mm: float, sag_mm: float) -> list[str]:
    """Once around the slot, counter-clockwise: the wall on the right of the path."""
    return [
        *along(line, (start, 1.0), -offset_mm, sag_mm),
        turn(line, 1.0, offset_mm),
        *along(line, (1.0, 0.0), offset_mm, sag_mm),
        turn(line, 0.0, offset_mm),
        *(along(line, (0.0, start), -offset_mm, sag_mm) if start else []),
    ]


def program(line: BSpline) -> str:
    """The whole program."""
    offset_mm = OFFSET_MM - WALL_ALLOWANCE_MM
    x, y = parallel(line, 0.0, -offset_mm)
    blocks = ["", "(--- ROUGH)", "T1 M6", "S3000 M3", "G4 P2"]
    blocks += [f"G0 X{x:.4f} Y{y:.4f}", "G43 H1 Z50. M8", "Z2."]
    for depth in (5, 10, DEPTH_MM - FLOOR_ALLOWANCE_MM):
        blocks += [f"G1 Z-{depth:g} F150", "F1200", *round_trip(line, 0.0, offset_mm, ROUGH_SAG_MM)]
    blocks += ["G0 Z50. M9", "M5", "", "(--- FINISH)", "T2 M6", "S4000 M3", "G4 P2"]
    middle, wall = line(0.5), parallel(line, 0.5, -OFFSET_MM)
    x, y = middle
    blocks += [
        f"G0 X{x:.4f} Y{y:.4f}",
        "G43 H2 Z50. M8",
        "Z-13.",
        f"G1 Z-{DEPTH_MM:g} F150",
        "F900",
    ]
    blocks += [arc(middle, wall, (middle + wall) / 2)]
    blocks += round_trip(line, 0.5, OFFSET_MM, FINISH_SAG_MM)
    blocks += [arc(wall, middle, (middle + wall) / 2), "G0 Z50. M9", "M5", "M30", "%"]
    return HEADER + "\n".join(blocks) + "\n"


def wall_points(line: BSpline) -> str:
    """Exact points on both walls at two depths with normals out of the material, as CSV."""
    rows = ["id,feature,x,y,z,i,j,k"]
    u = np.linspace(0.005, 0.995, 180)
    normal = left_normal(line, u)
    for side, name in ((1, "left wall"), (-1, "right wall")):
        for depth in (4, 11):
            for (x, y), (i, j) in zip(
                parallel(line, u, side * WIDTH_MM / 2), -side * normal, strict=True
            ):
                rows.append(f"{len(rows)},{name},{x:.7f},{y:.7f},-{depth},{i:.9f},{j:.9f},0")
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    spline = centre_line()
    (FOLDER / "slot.nc").write_text(program(spline))
    (FOLDER / "wall_points.csv").write_text(wall_points(spline))
