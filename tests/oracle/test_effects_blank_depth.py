"""Radial depth from the blank: closed forms of boxes, and the same boxes as triangles."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from vmach.job import Blank
from vmach.path.blank_depth import blank_depth_mm

LOW, HIGH = np.array([0.0, 0.0, -30.0]), np.array([100.0, 60.0, 0.0])
BOX = Blank(LOW, HIGH)


def as_solid(mesh: trimesh.Trimesh) -> Blank:
    return Blank(*mesh.bounds, Path("roughed.stl"), mesh)


def block(low, high) -> trimesh.Trimesh:
    return trimesh.creation.box(bounds=[low, high])


@pytest.mark.parametrize("blank", [BOX, as_solid(block(LOW, HIGH))], ids=["box", "solid"])
def test_a_wall_near_the_edge_of_the_blank_takes_what_is_there(blank):
    x, y = [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]
    oblique = [0.6, 0.8, 0.0]
    point = [[99.0, 30, -5], [50, 0.4, -5], [97, 30, -5], [100, 30, -5], [101, 30, -5], [9, 9, 1]]
    direction = [x, y, oblique, x, x, x]
    depth = blank_depth_mm(blank, np.array(point), np.array(direction), np.full(6, 20.0))
    assert depth == pytest.approx([1.0, 0.4, 5.0, 0.0, 0.0, 0.0], abs=1e-6)


def test_no_deeper_than_what_earlier_passes_left():
    point, direction = np.array([[50.0, 30, -5]] * 2), np.array([[1.0, 0, 0], [0, 0, 0]])
    assert blank_depth_mm(BOX, point, direction, np.array([0.3, 0.3])).tolist() == [0.3, 0.0]


def test_a_slot_that_another_program_roughed():
    roughed = block(LOW, HIGH).difference(block([20, 10.3, -12], [80, 29.8, 1]))
    walls = np.array([[50.0, 10.0, -6], [50.0, 30.0, -6], [50.0, 30.0, -15]])
    into_slot = np.array([[0, 1.0, 0], [0, -1.0, 0], [0, -1.0, 0]])
    depth = blank_depth_mm(as_solid(roughed), walls, into_slot, np.full(3, 20.0))
    assert depth == pytest.approx([0.3, 0.2, 20.0], abs=1e-6)


def test_no_line_slips_through_the_seams_of_many_triangles():
    mesh = block(LOW, HIGH).subdivide().subdivide().subdivide()
    draw = np.random.default_rng(7)
    # on the grid of the triangles' corners, where lines meet edges and vertices exactly
    point = LOW + np.round(draw.uniform(0.05, 0.95, (1000, 3)) * 16) / 16 * (HIGH - LOW)
    angle = draw.integers(0, 8, 1000) * np.pi / 4
    direction = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    far = np.full(1000, 200.0)
    assert blank_depth_mm(as_solid(mesh), point, direction, far) == pytest.approx(
        blank_depth_mm(BOX, point, direction, far), abs=1e-5
    )
