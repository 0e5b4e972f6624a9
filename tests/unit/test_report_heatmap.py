"""heatmap.png."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from PIL import Image

from tests.report_case import block, points, run
from vmach.base.colour_ramp import COLOUR_STOPS
from vmach.features.result import FeatureResult, Place
from vmach.report import (
    Colouring,
    DisplayMesh,
    build_display_mesh,
)
from vmach.report.pictures.camera import Camera, isometric_camera
from vmach.report.pictures.colours import colour_range, colours_of, nice_ceiling
from vmach.report.pictures.flags import seen_place
from vmach.report.pictures.heatmap import draw_heatmap
from vmach.report.pictures.rasterise import Visible, rasterise

FRONT = Camera(np.eye(3), np.zeros(3), width_mm=100.0, height_mm=50.0)


def square(side_mm, height_mm):
    """Two triangles facing +Z, centred."""
    x = side_mm / 2
    vertices = [[-x, -x, height_mm], [x, -x, height_mm], [x, x, height_mm], [-x, x, height_mm]]
    return np.array(vertices), np.array([[0, 1, 2], [0, 2, 3]])


def test_a_square_covers_its_own_pixels_in_its_own_colour():
    mesh = DisplayMesh(*square(20.0, 0.0))
    picture = rasterise(mesh, np.full((4, 3), (1.0, 0.5, 0.25)), FRONT, (200, 100))
    rows, columns = np.nonzero(picture[..., 3])
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (29, 70, 79, 120)
    assert picture[50, 95].tolist() == [255, 128, 64, 255]
    assert picture[28, 95, 3] == 0


def test_a_ball_covers_a_disc_of_its_radius():
    ball = trimesh.creation.icosphere(subdivisions=5, radius=20.0)
    mesh = DisplayMesh(ball.vertices, ball.faces)
    picture = rasterise(mesh, np.ones(ball.vertices.shape), FRONT, (400, 200))
    area_mm2 = (picture[..., 3] / 255).sum() * 0.25**2
    assert area_mm2 == pytest.approx(np.pi * 20**2, rel=0.01)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_what_is_nearer_hides_what_is_behind(order):
    squares = [square(20.0, 5.0), square(30.0, -5.0)]
    colours = [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    near_first = [squares[i] for i in order]
    mesh = DisplayMesh(
        np.vstack([vertices for vertices, _ in near_first]),
        np.vstack([near_first[0][1], near_first[1][1] + 4]),
    )
    picture = rasterise(mesh, np.repeat([colours[i] for i in order], 4, axis=0), FRONT, (200, 100))
    assert picture[50, 105].tolist() == [255, 0, 0, 255]
    assert picture[50, 125].tolist() == [0, 0, 255, 255]


def test_camera_sees_all_points():
    vertices = 100 * np.random.default_rng(3).normal(size=(50, 3)) * [5, 1, 0.1]
    seen = isometric_camera(vertices).pixels(vertices, (640, 480))
    assert (seen[:, :2] >= 0).all()
    assert (seen[:, :2] <= [640, 480]).all()


def test_colours_run_from_blue_over_near_white_to_red():
    colours = colours_of(np.array([-9.0, -1.0, 0.0, 1.0, 9.0]), np.ones(5, bool), 1.0)
    np.testing.assert_array_equal(colours[0], colours[1])
    np.testing.assert_array_equal(colours[3], colours[4])
    assert colours[0, 2] > 2 * colours[0, 0]
    assert colours[4, 0] > 2 * colours[4, 2]
    assert colours[2].min() > 0.9
    lightness = colours_of(np.linspace(-1, 1, 9), np.ones(9, bool), 1.0) @ [0.21, 0.72, 0.07]
    assert (np.diff(lightness)[:4] > 0).all()
    assert (np.diff(lightness)[4:] < 0).all()
    assert len(COLOUR_STOPS) == 9


def test_colour_scale_is_round_and_ignores_a_few_gross_points():
    assert [nice_ceiling(x) for x in (1.0, 1.01, 7.0, 9.0, 0.02)] == [1.0, 1.5, 8.0, 10.0, 0.02]
    values = np.full(1000, 3.3e-3)
    values[:5] = 1.0
    assert colour_range([values]) == pytest.approx(4e-3)
    assert colour_range([np.zeros(0)]) == pytest.approx(1e-6)


def size_and_colours(path):
    with Image.open(path) as picture:
        return picture.size, np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)


def test_the_picture_is_large_and_coloured(tmp_path):
    case = points()
    draw_heatmap(tmp_path / "h.png", build_display_mesh(*block(), case), case, run(title="$x_1"))
    (width, height), colours = size_and_colours(tmp_path / "h.png")
    assert width > 1500
    assert height > 800
    assert len(colours) > 1000


def test_a_perfect_machine_is_drawn_only_where_it_is_alone(tmp_path):
    case = points()
    mesh = build_display_mesh(*block(), case)
    widths = {}
    for name, columns in {"all": case.columns, "none": case.columns[:1]}.items():
        draw_heatmap(tmp_path / "h.png", mesh, replace(case, columns=columns), run())
        widths[name] = size_and_colours(tmp_path / "h.png")[0][0]
    assert widths["none"] > 1000
    assert 1.6 < widths["all"] / widths["none"] < 2  # two panels, not three


def test_unknown_vertices_are_grey():
    colours = colours_of(np.array([5.0]), np.array([False]), 1.0)
    assert np.ptp(colours) < 0.06
    assert Colouring(np.zeros(1), np.array([False])).known.dtype == bool


def test_a_flag_points_at_what_is_seen():
    """Both places face the viewer; a square hides the first one, which decides more."""
    near, far = square(20.0, 5.0), square(80.0, -5.0)
    mesh = DisplayMesh(np.vstack([near[0], far[0]]), np.vstack([near[1], far[1] + 4]))
    hidden, seen = (Place((x, 0.0, -5.0), (0.0, 0.0, 1.0)) for x in (5.0, 30.0))
    result = FeatureResult("floor", "flatness 0.01", "flatness", places=(hidden, seen))
    visible = Visible.of(mesh, FRONT, (200, 100))
    assert seen_place(result, FRONT, visible, (200, 100)) == seen
    assert seen_place(replace(result, places=(hidden,)), FRONT, visible, (200, 100)) is None
    on_top = Place((5.0, 0.0, 5.0), (0.0, 0.0, 1.0))
    result = replace(result, places=(hidden, on_top))
    assert seen_place(result, FRONT, visible, (200, 100)) == on_top
