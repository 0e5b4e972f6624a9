"""Moves that are cut as one, against the same part cut move by move and against brute force."""

from __future__ import annotations

import numpy as np
import pytest

from stock import BLANK, cut_part, make_tool
from stock.solid import solid
from stock.solid.joined_strokes import join_strokes
from stock.solid.strokes import strokes_of
from tests.stock_solid_cases import edge_uses, polyline

RADIUS_MM = 3.0
BALL = make_tool("ball", diameter_mm=2.0 * RADIUS_MM, length_mm=30.0)
BOX = ((-5.0, -5.0, -10.0), (20.0, 8.0, 0.0))
TOLERANCE_MM = 0.01
#: triangles lower than this have no normal that means anything
SLIVER_MM = 1e-3


def fine_raster() -> np.ndarray:
    """Passes of 0.05 mm a move over a wave, (P, 3)."""
    x = np.linspace(0.0, 15.0, 301)
    rows = [np.column_stack([x[:: 1 - 2 * (k % 2)], np.full_like(x, 0.6 * k), 0.0 * x])
            for k in range(4)]  # fmt: skip
    path = np.concatenate(rows)
    path[:, 2] = -1.5 + 0.8 * np.sin(path[:, 0] / 3.0)
    return path


@pytest.fixture(scope="module")
def path() -> np.ndarray:
    return fine_raster()


@pytest.fixture(scope="module")
def fine(path):
    return cut_part(polyline(path), [BALL], BOX, tolerance_mm=TOLERANCE_MM)


@pytest.fixture(scope="module")
def joined(path):
    """The part by few strokes, as only far more moves are otherwise."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(solid, "_FEW_STROKES", 400)
        return cut_part(polyline(path), [BALL], BOX, tolerance_mm=TOLERANCE_MM)


def distance_from_moves(points, path) -> np.ndarray:
    """Distance of points (P, 3) from the way of the ball's centre in every move, (P, M)."""
    centre = path + np.array([0.0, 0.0, RADIUS_MM])
    start, way = centre[:-1], np.diff(centre, axis=0)
    arm = points[:, None] - start
    share = np.einsum("pmi,mi->pm", arm, way) / np.maximum((way**2).sum(axis=1), 1e-30)
    return np.linalg.norm(arm - np.clip(share, 0.0, 1.0)[..., None] * way, axis=2)


def test_joined_moves_leave_the_same_part(fine, joined):
    assert fine.joined_mm == 0.0
    assert joined.joined_mm == pytest.approx(0.2 * TOLERANCE_MM)
    assert edge_uses(joined.triangles) == (0, 0)
    floor_mm2 = 21.0 * 7.8
    off_mm = abs(joined.volume_mm3 - fine.volume_mm3) / floor_mm2
    assert off_mm < 2.0 * joined.joined_mm
    assert len(joined.triangles) < len(fine.triangles) / 3


def test_every_triangle_names_a_move_that_made_it(path, joined):
    """No other move's ball comes deeper into the middle of the triangle than the facets allow."""
    corners = joined.vertices_mm[joined.triangles]
    sides = corners - np.roll(corners, 1, axis=1)
    double_area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    cut = (joined.move != BLANK) & (double_area > SLIVER_MM * longest)
    middle = corners[cut].mean(axis=1)
    distance = distance_from_moves(middle, path)
    own = distance[np.arange(len(middle)), joined.move[cut]]
    slack_mm = 2.0 * TOLERANCE_MM + joined.joined_mm
    assert (own < distance.min(axis=1) + slack_mm).all()
    assert own.max() < RADIUS_MM + 2.0 * joined.joined_mm  # facets leave material, no more
    assert len(np.unique(joined.move[cut])) > 3 * len(join_strokes(
        strokes_of(polyline(path), TOLERANCE_MM), joined.joined_mm).strokes) / 2  # fmt: skip


@pytest.mark.parametrize("limit_mm", [1e-4, 2e-3, 1e-2])
def test_nodes_keep_near_their_chord(path, limit_mm):
    """Brute force: every old node within the limit of the joined stroke that it is in."""
    strokes = strokes_of(polyline(path), TOLERANCE_MM)
    found = join_strokes(strokes, limit_mm)
    inside = np.arange(len(found.strokes))[:, None] == np.floor(found.key - 1e-12)
    assert (inside.sum(axis=1) > 0).all()
    for number, rows in enumerate(inside):
        start, end = found.strokes.start_mm[number], found.strokes.end_mm[number]
        nodes = np.vstack([strokes.start_mm[rows], strokes.end_mm[rows]])
        off = np.cross(nodes - start, end - start) / max(np.linalg.norm(end - start), 1e-30)
        assert np.linalg.norm(off, axis=1).max() < np.sqrt(3.0) * limit_mm


def test_a_path_that_turns_back_is_not_one_stroke():
    there_and_back = [[0, 0, -3], [5, 0, -3], [2, 0, -3], [9, 0, -3]]
    strokes = strokes_of(polyline(there_and_back), TOLERANCE_MM)
    assert len(join_strokes(strokes, 0.01).strokes) == 3
