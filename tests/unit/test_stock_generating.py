"""The move that was meant to make a point, against a trial of every place of every move."""

from __future__ import annotations

import numpy as np
import pytest

from stock import Sweeps, find_generating, make_tool

_DIAMETERS_MM = (10.0, 6.0)
_TOOLS = [make_tool("flat", diameter_mm=d, length_mm=30.0) for d in _DIAMETERS_MM]
_MOVES, _POINTS = 12, 60
#: places of every move that are tried
_PLACES = np.linspace(0.0, 1.0, 4001)


def _straight(start_mm: np.ndarray, end_mm: np.ndarray, tool: np.ndarray) -> Sweeps:
    count = len(start_mm)
    still = np.zeros((count, 2, 3))
    return Sweeps(
        start_mm, end_mm, np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count), tool,
        np.arange(count), still, still, still, still,
    )  # fmt: skip


def _on_move(sweeps: Sweeps, move: int, places: np.ndarray) -> tuple[np.ndarray, float]:
    """Tips (n, 3) at places of a straight move, and the radius of its tool."""
    start, end = sweeps.start_mm[move], sweeps.end_mm[move]
    return start + places[:, None] * (end - start), 0.5 * _DIAMETERS_MM[sweeps.tool[move]]


def _miss_mm(point: np.ndarray, normal: np.ndarray, tips: np.ndarray, radius: float) -> np.ndarray:
    """Of a flat end mill at tips (n, 3): of its end for a floor, of its flank for a wall."""
    away = point - tips
    if normal[2] == 1.0:
        across = np.maximum(np.hypot(away[:, 0], away[:, 1]) - radius, 0.0)
        return np.hypot(across, away[:, 2])
    beside = np.hypot(away[:, 0] + radius * normal[0], away[:, 1] + radius * normal[1])
    along = np.maximum(np.maximum(-away[:, 2], away[:, 2] - 30.0), 0.0)
    return np.hypot(beside, along)


@pytest.fixture(scope="module")
def drawn() -> tuple[Sweeps, np.ndarray, np.ndarray]:
    """Moves, points and normals, half of them of floors."""
    random = np.random.default_rng(7)
    ends = random.uniform((-40.0, -40.0, -5.0), (40.0, 40.0, 0.0), (2, _MOVES, 3))
    points = random.uniform((-40.0, -40.0, -5.0), (40.0, 40.0, 5.0), (_POINTS, 3))
    turn = random.uniform(0.0, 2.0 * np.pi, _POINTS)
    walls = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(_POINTS)])
    is_floor = np.arange(_POINTS) % 2 == 0
    normals = np.where(is_floor[:, None], [0.0, 0.0, 1.0], walls)
    return _straight(*ends, random.integers(0, 2, _MOVES)), points, normals


def test_no_place_of_any_move_comes_closer(drawn):
    sweeps, points, normals = drawn
    found = find_generating(points, normals, sweeps=sweeps, tools=_TOOLS)
    for k, (point, normal) in enumerate(zip(points, normals, strict=True)):
        tried = [_miss_mm(point, normal, *_on_move(sweeps, m, _PLACES)) for m in range(_MOVES)]
        least = float(np.min(tried))
        # a place that is tried lies within half a step of 125 mm / 4000 from the best
        assert found.miss_mm[k] == pytest.approx(least, abs=0.016)
        assert found.miss_mm[k] <= least + 1e-9
        place = _on_move(sweeps, found.sweep[k], found.parameter[k : k + 1])
        (own,) = _miss_mm(point, normal, *place)
        assert found.miss_mm[k] == pytest.approx(own, abs=1e-9)


@pytest.mark.parametrize("rise_mm", [0.0, -3.0])
def test_a_wall_is_made_on_its_circle_or_helix_where_the_tool_is_beside_it(rise_mm):
    """Once round, from +X towards +Y, at a radius of 20 mm: the wall has one of 25 mm."""
    still = np.zeros((1, 2, 3))
    ends = np.array([[[20.0, 0.0, -1.0]], [[20.0, 0.0, -1.0 + rise_mm]]])
    circle = Sweeps(
        *ends, np.array([[0.0, 0.0, -1.0]]), np.array([[0.0, 0.0, 1.0]]),
        np.array([2.0 * np.pi]), np.zeros(1), np.zeros(1), still, still, still, still,
    )  # fmt: skip
    turn = np.array([0.3, 2.0, 4.5])
    around = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(3)])
    found = find_generating(25.0 * around, -around, sweeps=circle, tools=_TOOLS)
    # the place on an arc is searched for to 1e-9 of it, where the distance has a flat minimum
    assert found.miss_mm == pytest.approx(0.0, abs=1e-6)
    assert found.parameter == pytest.approx(turn / (2.0 * np.pi), abs=1e-6)


@pytest.mark.parametrize("depth", [0.0, 3.0])
def test_the_bottom_of_a_plunge_is_made_at_its_end(depth):
    """Going down to the floor, or through it."""
    plunge = _straight(np.array([[0.0, 0.0, 5.0]]), np.array([[0.0, 0.0, -depth]]), np.zeros(1))
    found = find_generating(
        np.array([[1.0, 2.0, 0.0]]), np.array([[0.0, 0.0, 1.0]]), sweeps=plunge, tools=_TOOLS
    )
    assert found.miss_mm[0] == pytest.approx(0.0, abs=1e-12)
    assert found.parameter[0] == pytest.approx(5.0 / (5.0 + depth), abs=1e-12)


def test_many_points_are_found_as_each_alone(drawn):
    sweeps, points, normals = drawn
    found = find_generating(points, normals, sweeps=sweeps, tools=_TOOLS)
    for k in range(_POINTS):
        own = slice(k, k + 1)
        alone = find_generating(points[own], normals[own], sweeps=sweeps, tools=_TOOLS)
        assert alone.sweep[0] == found.sweep[k]
        assert alone.parameter[0] == found.parameter[k]
        assert np.array_equal(alone.contact_mm[0], found.contact_mm[k])


def test_no_points_are_no_trouble(drawn):
    sweeps, points, normals = drawn
    found = find_generating(points[:0], normals[:0], sweeps=sweeps, tools=_TOOLS)
    assert found.sweep.shape == (0,) and found.contact_mm.shape == (0, 3)
