"""Volumes of the virtual part against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import trapezoid

from stock import cut_part, make_tool
from tests.stock_solid_cases import circle, polyline

BOX = (np.array([-20.0, -20.0, -10.0]), np.array([40.0, 40.0, 0.0]))
BOX_VOLUME = 60.0 * 60.0 * 10.0
TOLERANCE = 0.01

FLAT = make_tool("flat", diameter_mm=10.0, length_mm=30.0)
BALL = make_tool("ball", diameter_mm=10.0, length_mm=30.0)
BULL = make_tool("bull", diameter_mm=10.0, length_mm=30.0, corner_radius_mm=2.0)
DRILL = make_tool("drill", diameter_mm=10.0, length_mm=30.0, angle_deg=90.0)
CHAMFER = make_tool("chamfer", diameter_mm=10.0, length_mm=30.0, tip_diameter_mm=4.0)


def plunge(depth_mm: float) -> np.ndarray:
    return np.array([[0.0, 0.0, 5.0], [0.0, 0.0, -depth_mm]])


def half_torus_ring(radius: float, corner: float) -> float:
    """Volume under a bull nose up to its corner radius, by Pappus."""
    inner = radius - corner
    quarter = np.pi * corner**2 / 4
    centroid = inner + 4 * corner / (3 * np.pi)
    return np.pi * inner**2 * corner + 2 * np.pi * centroid * quarter


PLUNGES = [
    (FLAT, 3.0, np.pi * 25 * 3),
    (BALL, 5.0, 2 / 3 * np.pi * 125),
    (BALL, 2.0, np.pi * 2**2 * (5 - 2 / 3)),
    (BULL, 2.0, half_torus_ring(5.0, 2.0)),
    (DRILL, 5.0, np.pi * 125 / 3),
    (CHAMFER, 3.0, np.pi * 3 / 3 * (2**2 + 2 * 5 + 5**2)),
]


@pytest.mark.parametrize(("tool", "depth", "expected"), PLUNGES)
def test_plunge(tool, depth, expected):
    part = cut_part(polyline(plunge(depth)), [tool], BOX, tolerance_mm=TOLERANCE)
    removed = BOX_VOLUME - part.volume_mm3
    surface = 2 * np.pi * 5 * depth + np.pi * 25
    assert 0 <= expected - removed <= 2 * TOLERANCE * surface


def test_plunge_converges_with_the_tolerance():
    lack = []
    for tolerance in (0.04, 0.01, 0.0025):
        part = cut_part(polyline(plunge(3.0)), [FLAT], BOX, tolerance_mm=tolerance)
        lack.append(np.pi * 75 - (BOX_VOLUME - part.volume_mm3))
    assert lack[0] > 2.5 * lack[1] > 6 * lack[2] > 0


def test_slot_with_a_corner():
    """Two slots of width 2 R at a right angle; the corner's overlap is R^2 (1 + 3 pi / 4)."""
    path = [[0, 0, 5], [0, 0, -3], [20, 0, -3], [20, 20, -3]]
    part = cut_part(polyline(path), [FLAT], BOX, tolerance_mm=TOLERANCE)
    area = 2 * (20 * 10 + np.pi * 25) - 25 * (1 + 3 * np.pi / 4)
    lack = 3 * area - (BOX_VOLUME - part.volume_mm3)
    assert 0 <= lack <= 3 * TOLERANCE * (2 * np.pi * 5 + 80)


@pytest.mark.parametrize("direction", [(7, 1), (1, 1), (2, -3)])
def test_ball_groove(direction):
    """A ball through the whole box leaves half a cylinder of its radius."""
    unit = np.array(direction) / np.hypot(*direction)
    path = np.column_stack([np.outer([-60, 60], unit) + 10, [-5, -5]])
    part = cut_part(polyline(path), [BALL], BOX, tolerance_mm=TOLERANCE)
    offset = np.linspace(-5, 5, 20001)
    expected = trapezoid(_chords_through_box(unit, offset) * np.sqrt(25 - offset**2), offset)
    lack = expected - (BOX_VOLUME - part.volume_mm3)
    assert -1e-3 <= lack <= TOLERANCE * 90 * np.pi * 5


def _chords_through_box(unit: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Length inside the box of lines along `unit` at `offset` beside its middle."""
    normal = np.array([-unit[1], unit[0]])
    start = np.outer(offset, normal)
    near = (-30 * np.sign(unit) - start) / unit
    far = (30 * np.sign(unit) - start) / unit
    return np.maximum(far.min(axis=1) - near.max(axis=1), 0)


def test_ring_by_a_native_arc():
    part = cut_part(circle(12.0, -3.0), [FLAT], ((-20, -20, -10), (20, 20, 0)))
    expected = 3 * np.pi * (17**2 - 7**2)
    removed = 40 * 40 * 10 - part.volume_mm3
    assert abs(expected - removed) <= 3 * 2 * TOLERANCE * 2 * np.pi * (17 + 7)


def test_helix_reaches_its_depth_and_radius():
    part = cut_part(
        circle(6.0, 0.0, turns=3.0, rise_mm=-6.0), [FLAT], ((-20, -20, -10), (20, 20, 0))
    )
    cut = part.move == 0
    corners = part.vertices_mm[part.triangles[cut]].reshape(-1, 3)
    assert corners[:, 2].min() == pytest.approx(-6.0, abs=1e-9)
    assert np.hypot(*corners[:, :2].T).max() == pytest.approx(11.0, abs=1e-9)
