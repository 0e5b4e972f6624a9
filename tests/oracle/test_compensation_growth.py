"""Points are inserted sparingly: closed forms of sagitta, and all polylines of small cases."""

import math
import re
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import linprog

from gcode import MoveKind
from tests.oracle.test_compensation_programs import HEAD, JOB, MACHINE, job_with
from vmach.compensation import compensate
from vmach.compensation.pieces.tube import fewest_pieces
from vmach.job import read_job
from vmach.path.preparation import prepare

FREE = np.array([[-1.0], [1.0]])


def tube(curve, width, place=None):
    """Fewest pieces with both ends free in the tube, and the largest distance from the curve."""
    curve = np.asarray(curve, float).reshape(len(curve), -1)
    place = np.arange(len(curve), dtype=float) if place is None else place
    width = np.broadcast_to(np.asarray(width, float), curve.shape[1:])
    vertex, off = fewest_pieces(place, curve, width, start=FREE * width, end=FREE * width)
    value = curve[vertex] + off
    drawn = [np.interp(place, place[vertex], value[:, k]) for k in range(curve.shape[1])]
    return len(vertex) - 1, np.abs((np.transpose(drawn) - curve) / width).max()


@pytest.mark.parametrize("sagitta", [0.19, 0.21, 0.79, 0.81, 1.79, 4.0, 12.7, 60.0])
def test_parabola_takes_as_many_pieces_as_its_sagitta_asks_for(sagitta):
    width, place = 0.1, np.linspace(0.0, 1.0, 2001)
    pieces, farthest = tube(4 * sagitta * place * (1 - place), width, place)
    # a chord of 1 / n leaves sagitta / n^2, half of it on either side
    assert math.ceil(math.sqrt(sagitta / (2 * width))) <= pieces
    assert pieces <= math.ceil(1.01 * math.sqrt(sagitta / (2 * width)) + 0.02)
    assert farthest <= 1.0 + 1e-9


def fits(curve, vertices, width):
    """Whether a polyline with these vertices stays in the tube, by linear programming."""
    place = np.arange(len(curve))
    hats = np.array([np.interp(place, vertices, row) for row in np.eye(len(vertices))]).T
    found = linprog(
        np.zeros(len(vertices)),
        A_ub=np.vstack([hats, -hats]),
        b_ub=np.concatenate([curve + width, width - curve]),
        bounds=(None, None),
    )
    return found.status == 0


@pytest.mark.parametrize("seed", range(12))
def test_no_polyline_on_the_samples_has_fewer_pieces(seed):
    curve = np.cumsum(np.cumsum(np.random.default_rng(seed).normal(size=9)))
    width, inner = 0.8, range(1, len(curve) - 1)
    fewest = next(
        count + 1
        for count in range(len(curve))
        if any(fits(curve, [0, *v, len(curve) - 1], width) for v in combinations(inner, count))
    )
    pieces, farthest = tube(curve, width)
    assert fewest <= pieces <= fewest + 1  # greedy, and vertices on samples only
    assert farthest <= 1.0 + 1e-9


def test_two_components_share_their_vertices():
    place = np.linspace(0.0, 1.0, 501)
    curve = np.column_stack([3.0 * place**2, np.sin(7.0 * place)])
    pieces, farthest = tube(curve, [0.05, 0.02], place)
    alone = tube(curve[:, 1], 0.02, place)[0]
    assert alone <= pieces <= alone + 3
    assert farthest <= 1.0 + 1e-9


def bowed_job(folder, body, bow_um):
    """A machine whose X axis goes in a parabola: EYX = bow (x / 100)^2 over the travel."""
    at = np.arange(-400.0, 401.0, 2.0)
    rows = "".join(
        f"{x:g},{y:.6f},{y:.6f}\n" for x, y in zip(at, bow_um * (at / 100) ** 2, strict=True)
    )
    (folder / "EYX.csv").write_text("position_mm,forward,backward\n" + rows)
    table = '[errors.EYX]\ntable = "EYX.csv"\nmeasured_at_mm = [0.0, 0.0, 0.0]\n'
    machine = MACHINE.replace(
        "[axes.X]\ntravel_mm = [-1000, 1000]", "[axes.X]\ntravel_mm = [-400, 400]"
    )
    (folder / "machine.toml").write_text(machine + table)
    (folder / "job.toml").write_text(JOB)
    (folder / "part.nc").write_text(HEAD + body)
    return read_job(folder)


def test_bow_across_the_path_takes_the_fewest_blocks(tmp_path):
    job = bowed_job(tmp_path, "G1 Z-1. F200\nX200.\nM30\n", 8.0)
    found = compensate(job)
    blocks = sum(
        line.startswith("X") or " X" in line for line in found.text.decode().splitlines()[8:]
    )
    # sagitta 8 um over 200 mm: interpolation at 0.1 um takes sqrt(80), a tube sqrt(40)
    assert math.ceil(math.sqrt(40.0)) <= blocks <= 8
    assert found.unrounded.largest_mm <= 1e-4


def test_error_along_the_path_needs_no_points(tmp_path):
    cyclic = "[effects.cyclic_pitch.X]\namplitude_um = 4\npitch_mm = 40\nphase_rad = 0.3\n"
    job, effects = job_with(tmp_path, "G1 Z-1. F200\nX95.\nM30\n", cyclic)
    found = compensate(job, effects, resolution_mm=1e-5)
    assert found.growth == 1.0
    # the programmed point itself is corrected in full
    x = float(re.findall(r"X(-?\d+\.\d*)", found.text.decode())[-1])
    machine = x + 100.0
    error = 4e-3 * np.sin(2 * np.pi * machine / 40 + 0.3)
    assert abs(abs(x - 95.0) - abs(error)) < 2e-5


def test_arcs_stay_arcs_within_the_tolerance_of_the_true_circle(tmp_path):
    ppm = {"X": 150.0, "Y": -200.0}
    scales = "".join(f"[effects.scale.{a}]\nscale_ppm = {v}\n" for a, v in ppm.items())
    body = "G1 Z-1. F200\nX10.\nG2 X10. Y0. I40. J0.\nG3 X30. Y-20. I20. J0.\nM30\n"
    job, effects = job_with(tmp_path, body, scales)
    found = compensate(job, effects, resolution_mm=1e-6)
    assert (found.arcs, found.arcs_kept) == (2, 2)
    (tmp_path / "new.nc").write_bytes(found.text)
    moves = prepare(job, program_path=tmp_path / "new.nc").program.moves
    rows = np.flatnonzero(moves.kind == MoveKind.ARC)
    circles = {(150.0, 50.0): 40.0, (130.0, 50.0): 20.0}  # machine coordinates
    off = []
    for row in rows:
        out = moves.start_mm[row, :2] - moves.centre_mm[row, :2]
        angle = np.linspace(0.0, moves.sweep_rad[row], 200) * moves.axis[row, 2]
        turn = np.exp(1j * angle) * complex(*out)
        written = moves.centre_mm[row, :2] + np.column_stack([turn.real, turn.imag])
        true = written * (1.0 + 1e-6 * np.array([ppm["X"], ppm["Y"]]))
        centre = min(circles, key=lambda c: abs(np.hypot(*(true - c).T) - circles[c]).max())
        off.append(abs(np.hypot(*(true - centre).T) - circles[centre]).max())
    assert len(off) < 12
    assert max(off) < 1.02e-4
