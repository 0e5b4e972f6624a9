"""The samples' programs and CAD against closed forms and brute force that share no engine code."""

from __future__ import annotations

import importlib.util
import math
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import trimesh

from gcode import MachineLimits, MoveKind, Moves, ToolEntry, read_program

SAMPLES = Path(__file__).resolve().parents[2] / "samples"


def moves_of(program: str, radii_mm: dict[int, float]) -> Moves:
    """Moves in workpiece coordinates: zero work offset, zero tool length."""
    return read_program(
        SAMPLES / program,
        work_offsets_mm={"G54": np.zeros(3)},
        tools={number: ToolEntry(0.0, 2 * r) for number, r in radii_mm.items()},
        limits=MachineLimits(rapid_mm_per_min=20000.0),
    ).moves


def chords(moves: Moves, index: int, step_rad: float = 0.02) -> np.ndarray:
    """Points along one move, (K, 3): its ends, or an arc's points."""
    start, end = moves.start_mm[index], moves.end_mm[index]
    sweep = moves.sweep_rad[index]
    if sweep == 0:
        return np.array([start, end])
    t = np.linspace(0, 1, max(int(abs(sweep) / step_rad), 8) + 1)[:, None]
    across = start - moves.centre_mm[index]
    turned = np.cross(moves.axis[index], across)
    circle = np.cos(sweep * t) * across + np.sin(sweep * t) * turned
    return moves.centre_mm[index] + circle + t * (end - start) * [0, 0, 1]


def lowest_cut(point_mm: np.ndarray, moves: Moves, radii_mm: dict[int, float]) -> np.ndarray:
    """Height that flat tools leave at points (P, 2): the lowest tip whose disc came over them.

    A helix counts with the lower end of each of its chords.
    """
    floor = np.full(len(point_mm), np.inf)
    for index in np.flatnonzero((moves.kind != MoveKind.DWELL) & (moves.tool > 0)):
        radius = radii_mm[int(moves.tool[index])]
        points = chords(moves, index)
        low, high = points[:, :2].min(axis=0) - radius, points[:, :2].max(axis=0) + radius
        near = np.flatnonzero(((point_mm > low) & (point_mm < high)).all(axis=1))
        for a, b in pairwise(points):
            along = b[:2] - a[:2]
            offset = point_mm[near] - a[:2]
            t = np.clip(offset @ along / max(along @ along, 1e-30), 0, 1)
            inside = ((offset - t[:, None] * along) ** 2).sum(axis=1) < radius**2
            hit = near[inside]
            floor[hit] = np.minimum(floor[hit], min(a[2], b[2]))
    return floor


def grid(half_x: float, half_y: float, spacing: float = 3.37) -> np.ndarray:
    """Points (P, 2) of a grid that no edge of a part follows."""
    x, y = np.arange(-half_x + 0.3, half_x, spacing), np.arange(-half_y + 0.3, half_y, spacing)
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def contouring_piece_height(p: np.ndarray) -> np.ndarray:
    """Nominal top surface of the contouring test piece at points (P, 2)."""

    def in_square(half, angle_deg=0.0):
        c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
        return np.abs(p @ np.array([[c, -s], [s, c]])).max(axis=1) < half

    height = np.full(len(p), -30.0)
    height[in_square(80)] = -20
    height[in_square(75, 3)] = -12
    height[in_square(52, 45)] = -6
    height[np.hypot(*p.T) < 50] = 0
    for centre in ((52, 52), (52, -52), (-52, 52), (-52, -52)):
        height[np.hypot(*(p - centre).T) < 13] = -30
    height[np.hypot(*p.T) < 15] = -50
    return height


def bracket_height(p: np.ndarray) -> np.ndarray:
    """Nominal top surface of the bracket of the CAM sample at points (P, 2)."""

    def in_rounded(centre_x, half_x, half_y, radius):
        inner = np.abs(p - [centre_x, 0]) - [half_x - radius, half_y - radius]
        return np.hypot(*np.maximum(inner, 0).T) < radius

    height = np.full(len(p), -15.0)
    height[in_rounded(0, 55, 35, 10)] = 0
    height[in_rounded(-22, 25, 22, 7)] = -8
    height[np.hypot(*(p - [28, 0]).T) < 16] = -12
    return height


@pytest.mark.parametrize(
    ("program", "radii_mm", "half_mm", "nominal"),
    [
        ("iso10791_7/part.nc", {1: 31.5, 2: 10.0, 3: 8.0}, (85, 85), contouring_piece_height),
        ("freecad_pocket/part.nc", {1: 6.0, 2: 5.0}, (59, 39), bracket_height),
    ],
)
def test_program_leaves_the_nominal_floors_everywhere(program, radii_mm, half_mm, nominal):
    points = grid(*half_mm)
    steps = [(0.1, 0.1), (0.1, -0.1), (-0.1, 0.1), (-0.1, -0.1)]
    expected = nominal(points)
    clear = np.all([nominal(points + step) == expected for step in steps], axis=0)
    assert clear.mean() > 0.8
    cut = lowest_cut(points[clear], moves_of(program, radii_mm), radii_mm)
    cut = np.clip(cut, -50, 0)
    assert np.abs(cut - expected[clear]).max() < 1e-9


def groove_area(length_mm: float, ends: int) -> float:
    """Area of a groove of 20 mm along a smooth path with round ends."""
    return 20 * length_mm + ends * math.pi * 100 / 2


def spline_length_mm() -> float:
    """Length of the slot's centre line, Gauss quadrature on each span of the spline."""
    line = module("spline_slot/make_program").centre_line()
    x, w = np.polynomial.legendre.leggauss(40)
    knots = np.unique(line.t)
    half = np.diff(knots)[:, None] / 2
    u = knots[:-1, None] + half * (1 + x)
    return float((half * w * np.linalg.norm(line(u, 1), axis=-1)).sum())


def module(path: str):
    """A script of the samples as a module."""
    file = SAMPLES / f"{path}.py"
    spec = importlib.util.spec_from_file_location(f"sample_{file.stem}", file)
    found = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = found
    spec.loader.exec_module(found)
    return found


def closed_form_mm3(name: str) -> float:
    """Volume of a sample's nominal part."""
    pi = math.pi
    if name == "iso10791_7/part":
        steps = 170**2 * 20 + 160**2 * 10 + 150**2 * 8 + 104**2 * 6 + pi * 50**2 * 6
        return steps - pi * 15**2 * 50 - 4 * pi * 13**2 * 18
    if name == "freecad_pocket/part":
        block = 118 * 78 * 10 + (110 * 70 - (4 - pi) * 100) * 15
        return block - (50 * 44 - (4 - pi) * 49) * 8 - pi * 16**2 * 12
    if name == "spline_slot/slot":
        return 380 * 160 * 60 - 15 * (30 * spline_length_mm() + pi * 15**2)
    if name == "mazak_ajv25/toolpath1":
        ring = (320 * 220 - (4 - pi) * 100) - 280 * 180
        return 380 * 280 * 35 - 5 * ring
    half_circles = 2 * pi * 50 * 2**0.5
    lines = (220 + 240 + 220) * 2**0.5
    return 540 * 460 * 35 - 5 * groove_area(lines + half_circles, ends=2)


@pytest.mark.parametrize(
    "name",
    [
        "iso10791_7/part",
        "freecad_pocket/part",
        "spline_slot/slot",
        "mazak_ajv25/toolpath1",
        "mazak_ajv25/toolpath2",
    ],
)
def test_volume_of_the_cad_model(name):
    mesh = trimesh.load(SAMPLES / f"{name}.stl")
    assert mesh.is_watertight
    # facets of curved walls miss up to 0.01 mm of them
    assert mesh.volume == pytest.approx(closed_form_mm3(name), rel=5e-5)


def test_slot_finishing_path_keeps_within_its_chord_error_of_both_walls():
    """Distance of every wall point from the finishing path, less the tool's radius."""
    moves = moves_of("spline_slot/slot.nc", {1: 10.0, 2: 10.0})
    finish = (moves.tool == 2) & (moves.kind != MoveKind.DWELL) & (moves.start_mm[:, 2] == -15)
    paths = [
        chords(moves, k, 0.01)[:, :2] for k in np.flatnonzero(finish & (moves.end_mm[:, 2] == -15))
    ]
    start = np.vstack([path[:-1] for path in paths])
    along = np.vstack([np.diff(path, axis=0) for path in paths])
    walls = np.genfromtxt(
        SAMPLES / "spline_slot" / "wall_points.csv", delimiter=",", skip_header=1
    )[:, 2:]
    left_um = []
    for x, y, _, i, j, _ in walls[::3]:
        offset = np.array([x, y]) - start
        t = np.clip((offset * along).sum(axis=1) / (along**2).sum(axis=1), 0, 1)
        gap = offset - t[:, None] * along
        nearest = np.linalg.norm(gap, axis=1).argmin()
        left_um.append(1e3 * (np.linalg.norm(gap[nearest]) - 10))
        # the tool lies on the side that the normal points to
        assert gap[nearest] @ [i, j] < 0
    assert np.abs(left_um).max() < 0.5


def test_slot_walls_are_half_a_width_from_the_centre_line():
    line = module("spline_slot/make_program").centre_line()
    dense = line(np.linspace(0, 1, 40001))
    walls = np.genfromtxt(
        SAMPLES / "spline_slot" / "wall_points.csv", delimiter=",", skip_header=1
    )[::20, 2:4]
    nearest = [np.linalg.norm(dense - wall, axis=1).min() for wall in walls]
    assert np.abs(np.array(nearest) - 15).max() < 1e-5


def test_slot_program_and_points_come_out_of_the_script_again():
    script = module("spline_slot/make_program")
    line = script.centre_line()
    assert script.program(line) == (SAMPLES / "spline_slot" / "slot.nc").read_text()
    assert script.wall_points(line) == (SAMPLES / "spline_slot" / "wall_points.csv").read_text()


def test_invented_tables_come_out_of_the_script_again(tmp_path, monkeypatch):
    script = module("make_errors")
    monkeypatch.setattr(script, "SAMPLES", tmp_path)
    script.main()
    written = sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*.csv"))
    assert len(written) == 36
    for path in written:
        assert (tmp_path / path).read_text() == (SAMPLES / path).read_text(), path
