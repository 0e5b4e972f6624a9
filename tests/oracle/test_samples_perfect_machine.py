"""Samples on a perfect machine: points on the nominal surfaces, in closed form, show zero."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from vmach.machine import Variant
from vmach.run.pipeline import predict_points

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
FINISHING_RADIUS_MM = 8.0

Row = tuple[float, float, float, float, float, float]


def prism_walls(corner_mm: tuple[float, float], top: float, bottom: float) -> Iterator[Row]:
    """Walls of the square that a path with this corner leaves inside it."""
    half = math.hypot(*corner_mm) / math.sqrt(2) - FINISHING_RADIUS_MM
    angle = math.atan2(corner_mm[1], corner_mm[0]) - math.pi / 4
    for side in range(4):
        n = np.array([math.cos(angle + side * math.pi / 2), math.sin(angle + side * math.pi / 2)])
        for u in np.linspace(-half + 1, half - 1, 25):
            x, y = half * n + u * np.array([-n[1], n[0]])
            for z in (top - 0.2, (top + bottom) / 2, bottom + 0.2):
                yield (x, y, z, *n, 0.0)


def round_wall(
    centre: tuple[float, float], radius: float, heights: tuple[float, float], outward: int
) -> Iterator[Row]:
    """Cylinder; `outward` is +1 for a boss, -1 for a bore."""
    top, bottom = heights
    for angle in np.linspace(0.01, 2 * np.pi, 60):
        n = np.array([math.cos(angle), math.sin(angle)])
        x, y = np.array(centre) + radius * n
        for z in (top - 0.2, (top + bottom) / 2, bottom + 0.2):
            yield (x, y, z, *(outward * n), 0.0)


def contouring_piece() -> Iterator[Row]:
    """Every machined surface of the contouring test piece."""
    yield from round_wall((0, 0), 50, (0, -6), 1)
    yield from prism_walls((0, 84.8528), -6, -12)
    yield from prism_walls((78.5424, 87.2301), -12, -20)
    yield from prism_walls((88, 88), -20, -30)
    yield from round_wall((0, 0), 15, (0, -50), -1)
    for x, y in ((52, 52), (52, -52), (-52, 52), (-52, -52)):
        yield from round_wall((x, y), 13, (-12, -30), -1)
        yield (x + 3, y - 5, -30, 0, 0, 1)
    for x, y, z in ((30, 20, 0), (0, 60, -6), (60, 25, -12), (70, 77, -12), (79.5, 79.5, -20)):
        yield (x, y, z, 0, 0, 1)
    yield (84, -84, -30, 0, 0, 1)


def bracket() -> Iterator[Row]:
    """Outside, round pocket and floors of the CAM sample; straight walls and corners."""
    yield from round_wall((28, 0), 16, (0, -12), -1)
    for centre_x, half_x, half_y, radius, depth, outward in (
        (0, 55, 35, 10, -15, 1),
        (-22, 25, 22, 7, -8, -1),
    ):
        for sx, sy in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            for angle in np.linspace(0, math.pi / 2, 15):
                n = np.array([sx * math.cos(angle), sy * math.sin(angle)])
                x, y = [centre_x + sx * (half_x - radius), sy * (half_y - radius)] + radius * n
                yield (x, y, depth / 2, *(outward * n), 0.0)
        for u in np.linspace(-0.9, 0.9, 19):
            for side in (1, -1):
                x, y = centre_x + side * half_x, side * half_y
                yield (x, u * (half_y - radius), depth / 2, outward * side, 0.0, 0.0)
                yield (centre_x + u * (half_x - radius), y, depth / 2, 0.0, outward * side, 0.0)
    for x, y, z in ((57.5, 0, -15), (-56, 36, -15), (-22, 3, -8), (-45, 15, -8), (28, 0, -12)):
        yield (x, y, z, 0, 0, 1)


@pytest.mark.parametrize(
    ("job", "surface", "limit_um"),
    [
        # exact but for the arithmetic
        ("iso10791_7/job.toml", contouring_piece, 1e-6),
        # FreeCAD's arcs miss the nominal by its own tolerance of 0.1 um and its rounding
        ("freecad_pocket/job.toml", bracket, 0.2),
    ],
)
def test_deviations_are_zero(job, surface, limit_um, tmp_path):
    points = tmp_path / "points.csv"
    with points.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["id", "feature", "x", "y", "z", "i", "j", "k"])
        for number, row in enumerate(surface()):
            writer.writerow([number, "", *(repr(float(v)) for v in row)])
    _, prediction = predict_points(SAMPLES / job, points, variant=Variant.NONE)
    assert prediction.is_cut.all()
    assert 1e3 * np.abs(prediction.deviation_mm).max() < limit_um


def test_slot_walls_show_the_chord_error_of_their_program():
    """Chords on a curve leave material on a hollow wall, and take it from a full one."""
    points, prediction = predict_points(
        SAMPLES / "spline_slot" / "centre.toml",
        SAMPLES / "spline_slot" / "wall_points.csv",
        variant=Variant.NONE,
    )
    assert prediction.is_cut.all()
    deviation_um = 1e3 * prediction.deviation_mm
    assert np.abs(deviation_um).max() < 0.5
    assert deviation_um.max() > 0.3
    assert deviation_um.min() < -0.3
    assert len(points.point_mm) == 720
