"""The virtual part: heights, origins, order of work, wrong input."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from stock import BLANK, StockError, cut_part, make_tool
from tests.stock_solid_cases import edge_uses, mesh_volume, polyline, wavy_raster

FLAT = make_tool("flat", diameter_mm=10.0, length_mm=30.0)
BALL = make_tool("ball", diameter_mm=6.0, length_mm=30.0)
BOX = ((-20.0, -20.0, -10.0), (40.0, 40.0, 0.0))
ACROSS = [[-30.0, 0.0, -3.0], [50.0, 0.0, -3.0]]


def test_micrometres_survive():
    shift = np.tile([0.0, 0.003, 0.005], (2, 1))
    part = cut_part(polyline(ACROSS, shift_mm=shift), [FLAT], BOX)
    heights = np.unique(part.vertices_mm[:, 2])
    sides = np.unique(part.vertices_mm[:, 1])
    np.testing.assert_allclose(heights, [-10, -2.995, 0], atol=1e-12)
    np.testing.assert_allclose(sides, [-20, -4.997, 5.003, 40], atol=1e-12)


def test_tilt_leans_the_floor():
    tilt = np.tile([2e-5, 0.0, 0.0], (2, 1))
    part = cut_part(polyline(ACROSS, tilt_rad=tilt), [FLAT], BOX)
    floor = part.vertices_mm[np.abs(part.vertices_mm[:, 2] + 3) < 0.1]
    np.testing.assert_allclose(floor[:, 2], -3 + 2e-5 * floor[:, 1], atol=1e-9)
    assert np.ptp(floor[:, 2]) == pytest.approx(2e-4, rel=1e-6)


def test_a_wavy_displacement_shows_between_the_nodes():
    x = np.linspace(-30, 50, 17)
    path = np.column_stack([x, 0 * x, 0 * x - 3])
    shift = np.column_stack([0 * x, 0 * x, 0.004 * np.sin(x / 10)])
    part = cut_part(polyline(path, shift_mm=shift, move=np.zeros(16)), [FLAT], BOX)
    floor = part.vertices_mm[np.abs(part.vertices_mm[:, 2] + 3) < 0.1]
    fine = np.linspace(-30, 50, 8001)
    height = np.interp(fine, x, shift[:, 2]) - 3
    covers = np.hypot(fine - floor[:, :1], floor[:, 1:2]) <= 5 + 1e-9
    lowest = np.where(covers, height, np.inf).min(axis=1)  # of all places of the tool's disc
    np.testing.assert_allclose(floor[:, 2], lowest, atol=2e-4)
    assert np.ptp(floor[:, 2]) > 0.007


def test_triangles_know_their_move():
    path = [[0, 0, 5], [0, 0, -3], [20, 0, -3], [20, 20, -5]]
    part = cut_part(polyline(path, move=[7, 8, 9]), [FLAT], BOX)
    centre = part.vertices_mm[part.triangles].mean(axis=1)
    low, high = np.array(BOX)
    on_blank = (np.isclose(centre, low) | np.isclose(centre, high)).any(axis=1)
    assert np.array_equal(part.move == BLANK, on_blank)
    assert set(part.move.tolist()) == {BLANK, 7, 8, 9}
    assert (centre[part.move == 8, 1] < 5 + 1e-9).all()
    assert centre[part.move == 9, 2].min() < -4


@pytest.mark.parametrize("rise", [0.0, 0.3])
def test_every_triangle_lies_on_the_side_of_its_move(rise):
    """Level passes (merged in the plane) and rising ones; distance from the axis of the move."""
    rng = np.random.default_rng(3)
    path = np.column_stack([rng.uniform(-10, 30, (30, 2)), -3 + rise * rng.uniform(size=30)])
    part = cut_part(polyline(path), [FLAT], BOX)
    corners = part.vertices_mm[part.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    kept = (part.move != BLANK) & (size > 1e-9)
    wall = kept & (np.abs(normal[:, 2]) < 1e-6 * size)
    off = axis_distance(corners.mean(axis=1)[:, :2], path, part.move)
    assert wall.sum() > 20
    np.testing.assert_allclose(off[wall], 5.0, atol=0.02)
    assert (off[kept & ~wall] <= 5.0).all()


def axis_distance(points, path, move) -> np.ndarray:
    start, end = path[move, :2], path[np.minimum(move + 1, len(path) - 1), :2]
    along = end - start
    length2 = np.maximum((along**2).sum(axis=1), 1e-30)
    share = np.clip(((points - start) * along).sum(axis=1) / length2, 0, 1)
    return np.linalg.norm(points - start - share[:, None] * along, axis=1)


def test_level_passes_leave_one_clean_floor():
    """A hundred passes at one height need few triangles, and remove a rectangle."""
    y = np.repeat(np.arange(-19, 40, 3.0), 2)
    x = np.tile([-30.0, 50.0, 50.0, -30.0], 10)
    part = cut_part(polyline(np.column_stack([x, y, 0 * x - 3])), [FLAT], BOX)
    assert part.volume_mm3 == pytest.approx(60 * 60 * 7, abs=1e-6)
    assert len(part.triangles) < 400


@pytest.mark.parametrize("block", [60, 250])
def test_blocks_make_the_same_closed_part(block):
    path = wavy_raster(25, 20)
    box = ((-5.0, -5.0, -10.0), (30.0, 15.0, 0.0))
    whole = cut_part(polyline(path), [BALL], box)
    part = cut_part(polyline(path), [BALL], box, block_strokes=block)
    assert edge_uses(part.triangles) == (0, 0)
    assert part.volume_mm3 == pytest.approx(whole.volume_mm3, abs=1e-8)
    assert mesh_volume(part.vertices_mm, part.triangles) == pytest.approx(
        whole.volume_mm3, abs=1e-8
    )
    assert set(part.move.tolist()) == set(whole.move.tolist())


def test_same_input_same_bits():
    sweeps = polyline(wavy_raster(10, 6))
    first, second = (cut_part(sweeps, [BALL], BOX, block_strokes=30) for _ in range(2))
    assert np.array_equal(first.vertices_mm, second.vertices_mm)
    assert np.array_equal(first.triangles, second.triangles)
    assert np.array_equal(first.move, second.move)


def test_order_of_the_moves_does_not_change_the_part():
    path = wavy_raster(10, 6)
    there = cut_part(polyline(path), [BALL], BOX)
    back = cut_part(polyline(path[::-1]), [BALL], BOX)
    area = 4 * 60 * 60
    assert there.volume_mm3 == pytest.approx(back.volume_mm3, abs=1e-4 * area)


def test_more_moves_never_add_material():
    path = wavy_raster(10, 6)
    volumes = [cut_part(polyline(path[: k + 1]), [BALL], BOX).volume_mm3 for k in (1, 10, 40)]
    assert 36000 > volumes[0] > volumes[1] > volumes[2]


def test_blank_from_a_mesh():
    blank = trimesh.creation.cylinder(radius=20, height=10).apply_translation([0, 0, -5])
    part = cut_part(polyline(ACROSS), [FLAT], blank)
    assert edge_uses(part.triangles) == (0, 0)
    half = np.arcsin(5 / 20)
    strip = 20**2 * (2 * half + np.sin(2 * half))
    assert blank.volume - part.volume_mm3 == pytest.approx(3 * strip, rel=5e-3)


def test_nothing_left_and_nothing_cut():
    wide = make_tool("flat", diameter_mm=200.0, length_mm=30.0)
    assert len(cut_part(polyline([[0, 0, -20], [5, 0, -20]]), [wide], BOX).triangles) == 0
    whole = cut_part(polyline([[0, 0, 9], [5, 0, 9]]), [wide], BOX)
    assert (len(whole.triangles), set(whole.move.tolist())) == (12, {BLANK})


def test_zero_length_and_repeated_moves():
    still = cut_part(polyline([[0, 0, -3], [0, 0, -3]]), [FLAT], BOX)
    assert 36000 - still.volume_mm3 == pytest.approx(75 * np.pi, rel=5e-3)
    path = np.array([[0, 0, -3], [20, 0, -3], [20, 0, -3], [0, 0, -3], [20, 0, -3]])
    again = cut_part(polyline(path), [FLAT], BOX)
    once = cut_part(polyline(path[:2]), [FLAT], BOX)
    assert edge_uses(again.triangles) == (0, 0)
    assert again.volume_mm3 == pytest.approx(once.volume_mm3, abs=0.05)


def test_progress_and_interrupt():
    seen = []
    cut_part(
        polyline(wavy_raster(10, 6)), [BALL], BOX, progress=lambda *counts: seen.append(counts)
    )
    assert seen[-1][0] == seen[-1][1] == 65
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)

    def stop(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cut_part(polyline(wavy_raster(10, 6)), [BALL], BOX, progress=stop)


def open_mesh() -> trimesh.Trimesh:
    box = trimesh.creation.box()
    return trimesh.Trimesh(box.vertices, box.faces[:-1], process=False)


@pytest.mark.parametrize(
    ("blank", "options", "words"),
    [
        (((0, 0, 0), (1, 0, 1)), {}, "no volume"),
        (((0, 0, 0), (1, np.nan, 1)), {}, "no volume"),
        (open_mesh(), {}, "no closed solid"),
        (BOX, {"tolerance_mm": 0.0}, "tolerance of 0.0 mm"),
        (BOX, {"tolerance_mm": np.nan}, "tolerance of nan mm"),
        (BOX, {"block_strokes": 0}, "blocks of 0"),
    ],
)
def test_wrong_input(blank, options, words):
    with pytest.raises(StockError, match=words):
        cut_part(polyline(ACROSS), [FLAT], blank, **options)


def test_mesh_inside_out_and_missing_tool():
    box = trimesh.creation.box()
    inside_out = trimesh.Trimesh(box.vertices, box.faces[:, ::-1], process=False)
    with pytest.raises(StockError, match="outwards"):
        cut_part(polyline(ACROSS), [FLAT], inside_out)
    with pytest.raises(StockError, match="has tool 3; accepted: 0 to 0"):
        cut_part(polyline(ACROSS, tool=3), [FLAT], BOX)
