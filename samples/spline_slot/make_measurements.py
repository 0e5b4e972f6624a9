"""What a CMM finds on both slots: a portal machine moved by exact matrices cuts them.

Run from anywhere:  python samples/spline_slot/make_measurements.py

Nothing of vmach is used. The bodies of the machine move as its laser saw it: a reflector at the
stated place of a body reads the table's value, with the whole body turned by the tables' angles.
The tables are followed by direction of motion. Beside them the machine has what no table says:
waves of 170 mm between the positions, a workpiece that is 0.4 K too warm, a tool that yields 3 um
and wears by 2 um. The CMM scatters by 1 um, and the part lies on it shifted and turned.
"""

from __future__ import annotations

import csv
import re
import tomllib
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).resolve().parent
TOOL_RADIUS_MM, DEPTH_MM = 10.0, 15.0
#: beside the tables
WAVE_MM, WAVE_UM, WAVE_URAD = 170.0, 0.4, 0.3
WARM_PPM, YIELDS_UM, WEAR_UM, CMM_UM = 4.5, 3.0, 2.0, 1.0
#: tool positions along the finishing path are no farther apart, mm
STEP_MM = 0.5
REFERENCE_LINES = {"EC0Y": ("Y", 2), "EB0X": ("X", 1), "EA0Y": ("Y", 0)}


def main() -> None:
    """Write measured_centre.csv and measured_corner.csv."""
    for seed, place in enumerate(("centre", "corner"), 5):
        job = tomllib.loads((FOLDER / f"{place}.toml").read_text())
        names, points, normals = wall_points()
        deviation = cut_walls(job, points, normals)
        rows = measured_rows(names, points, normals, deviation, np.random.default_rng(seed))
        (FOLDER / f"measured_{place}.csv").write_text(rows)


def cut_walls(job: dict, points: np.ndarray, normals: np.ndarray, *, bare: bool = False):
    """Deviation of the walls, (P,) mm, positive where material is left; `bare`: tables alone."""
    zero = np.array(job["work_offsets_mm"]["G54"], float)
    length = job["tools"]["2"]["length_mm"]
    nose = finishing_path() + zero + [0.0, 0.0, length]
    way = np.sign(np.gradient(nose, axis=0))
    tool, work = bodies(nose, way, bare=bare)
    deviation = np.empty(len(points))
    for height in np.unique(points[:, 2]):
        rows = np.flatnonzero(points[:, 2] == height)
        on_axis = np.array([0.0, 0.0, height + DEPTH_MM - length, 1.0])
        axis = np.linalg.solve(work, (tool @ on_axis)[..., None])[:, :3, 0] - zero
        deviation[rows] = left_on_wall(points[rows], normals[rows], axis)
    if bare:
        return deviation
    along = np.linspace(0.0, 1.0, len(points))
    warm = WARM_PPM * 1e-6 * (points * normals).sum(axis=1)
    return deviation + 1e-3 * (YIELDS_UM + WEAR_UM * along) - warm


def finishing_path() -> np.ndarray:
    """Tip of the finishing tool on its way round, in workpiece coordinates, (K, 3)."""
    text = (
        (FOLDER / "slot.nc").read_text().split("(--- FINISH)")[1].split(f"Z-{DEPTH_MM:g} F150")[1]
    )
    x, y = map(float, re.search(r"G0 X(\S+) Y(\S+)", (FOLDER / "slot.nc").read_text().split(
        "(--- FINISH)")[1]).groups())  # fmt: skip
    path, arc = [np.array([x, y])], False
    for block in text.splitlines():
        if block.startswith("G0"):
            break
        arc = block.startswith("G3") or (arc and not block.startswith("G1"))
        words = {letter: float(value) for letter, value in re.findall(r"([XYIJ])(-?[\d.]+)", block)}
        if not words:
            continue
        end = np.array([words["X"], words["Y"]])
        start = path[-1]
        if arc:
            centre = start + np.array([words["I"], words["J"]])
            path += list(around(start, end, centre))
        else:
            count = int(np.ceil(np.hypot(*(end - start)) / STEP_MM))
            path += [start + (end - start) * k / count for k in range(1, count + 1)]
    return np.column_stack([np.array(path), np.full(len(path), -DEPTH_MM)])


def around(start: np.ndarray, end: np.ndarray, centre: np.ndarray):
    """Points of a counter-clockwise arc after its start."""
    first, last = (np.arctan2(*(p - centre)[::-1]) for p in (start, end))
    turn = (last - first) % (2 * np.pi) or 2 * np.pi
    radius = np.hypot(*(start - centre))
    count = int(np.ceil(turn * radius / STEP_MM))
    for k in range(1, count + 1):
        angle = first + turn * k / count
        yield centre + radius * np.array([np.cos(angle), np.sin(angle)])


def bodies(nose: np.ndarray, way: np.ndarray, *, bare: bool) -> tuple[np.ndarray, np.ndarray]:
    """Where tool and workpiece are in the bed's frame, (K, 4, 4) each: chain t Z Y b X w."""
    machine = tomllib.loads((FOLDER / "machine.toml").read_text())
    x, y, z = (guided(machine, axis, nose, way, bare=bare) for axis in "XYZ")
    return y @ z, x


def guided(machine: dict, axis: str, nose: np.ndarray, way: np.ndarray, *, bare: bool):
    """Motion of one body along its guideway, (K, 4, 4)."""
    number = "XYZ".index(axis)
    on_work_side = axis == "X"
    position = nose[:, number]
    # tables say how the tool moves against the workpiece: a table moves the other way
    side = -1.0 if on_work_side else 1.0
    angle = np.column_stack([side * reading(machine, f"E{r}{axis}", position, way[:, number],
                                            bare=bare) for r in "ABC"])  # fmt: skip
    turn = rotation(angle)
    motion = np.broadcast_to(np.eye(4), (len(nose), 4, 4)).copy()
    motion[:, :3, :3] = turn
    for k, letter in enumerate("XYZ"):
        name = f"E{letter}{axis}"
        reflector = np.array(machine["errors"][name]["measured_at_mm"])
        seen = (turn @ reflector - reflector)[:, k]
        motion[:, k, 3] = side * reading(machine, name, position, way[:, number], bare=bare) - seen
    travel = np.broadcast_to(np.eye(4), (len(nose), 4, 4)).copy()
    travel[:, number, 3] = side * position
    for name, (owner, about) in REFERENCE_LINES.items():
        if owner == axis:
            leans = np.cross(np.eye(3)[about], np.eye(3)[number])
            lean = 1e-6 * machine["squareness"][name] * position[:, None] * leans
            travel[:, :3, 3] += side * lean
    return travel @ motion


def reading(machine: dict, name: str, position: np.ndarray, way: np.ndarray, *, bare: bool):
    """A table's value, mm or rad, by the direction of motion, with a wave beside it."""
    with (FOLDER / machine["errors"][name]["table"]).open() as file:
        table = [[float(v) for v in row.values()] for row in csv.DictReader(file)]
    at, forward, backward = np.array(table).T
    one, other = np.interp(position, at, forward), np.interp(position, at, backward)
    if bare:
        value = 0.5 * (one + other)
    else:
        value = np.where(way > 0, one, np.where(way < 0, other, 0.5 * (one + other)))
        phase = sum(map(ord, name))
        size = WAVE_URAD if name[1] in "ABC" else WAVE_UM
        value = value + size * np.sin(2 * np.pi * position / WAVE_MM + phase)
    return value * (1e-6 if name[1] in "ABC" else 1e-3)


def rotation(vector: np.ndarray) -> np.ndarray:
    """Rotation matrices of small rotation vectors (K, 3), to second order, (K, 3, 3)."""
    a, b, c = vector.T
    zero = np.zeros_like(a)
    cross = np.array([[zero, -c, b], [c, zero, -a], [-b, a, zero]]).transpose(2, 0, 1)
    return np.eye(3) + cross + 0.5 * cross @ cross


def left_on_wall(points: np.ndarray, normals: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Where the round tool's side comes closest to each wall point, along its normal, mm."""
    start, step = axis[:-1, :2], np.diff(axis[:, :2], axis=0)
    found = np.empty(len(points))
    for k, (p, n) in enumerate(zip(points[:, :2], normals[:, :2], strict=True)):
        shift = 0.0
        for _ in range(4):
            arm = p + shift * n - start
            share = np.clip((arm * step).sum(axis=1) / (step**2).sum(axis=1), 0.0, 1.0)
            nearest = np.linalg.norm(arm - share[:, None] * step, axis=1).min()
            shift += nearest - TOOL_RADIUS_MM
        found[k] = shift
    return found


def wall_points() -> tuple[list[str], np.ndarray, np.ndarray]:
    """Every third point of wall_points.csv: name of its wall, place, normal."""
    with (FOLDER / "wall_points.csv").open() as file:
        rows = list(csv.DictReader(file))[::3]
    points = np.array([[float(row[c]) for c in "xyz"] for row in rows])
    normals = np.array([[float(row[c]) for c in "ijk"] for row in rows])
    return [row["feature"] for row in rows], points, normals


def measured_rows(names, points, normals, deviation, random) -> str:
    """The CMM's file: the part lies somewhere, and every reading scatters."""
    shift, turn = random.normal(0.0, 0.02, 3), random.normal(0.0, 2e-5, 3)
    away = ((shift + np.cross(turn, points)) * normals).sum(axis=1)
    seen = deviation + away + 1e-3 * CMM_UM * random.standard_normal(len(points))
    measured = points + seen[:, None] * normals
    rows = ["id,feature,x,y,z,i,j,k,mx,my,mz,u_um"]
    for k, (name, *numbers) in enumerate(zip(names, points, normals, measured, strict=True), 1):
        places = [f"{v:.7f}" for part in numbers for v in part]
        rows.append(",".join([str(k), name, *places, f"{CMM_UM:g}"]))
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    main()
