"""Meshes for display: refined without changing the shape, coloured without bleeding over edges."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from tests.report_case import block, field_mm, points
from vmach.report import Column, DisplayMesh, build_display_mesh, interpolate_to_mesh
from vmach.report.pictures.display_mesh import sharp_edges, vertex_normals


def solid(mesh: DisplayMesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices_mm, mesh.triangles)  # merges the repeated vertices


def test_refined_block_is_the_same_closed_solid():
    mesh = build_display_mesh(*block(), points())
    assert 1000 < len(mesh.triangles) <= 100_000
    assert solid(mesh).is_watertight
    assert solid(mesh).volume == pytest.approx(24_000)
    assert solid(mesh).area == pytest.approx(5_200)


def test_sharp_edges_of_the_block_are_its_twelve_edges():
    mesh = build_display_mesh(*block(), points())
    ends = mesh.vertices_mm[sharp_edges(mesh)]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    assert length == pytest.approx(2 * 4 * (40 + 30 + 20))  # each belongs to two faces
    normals = np.unique(np.round(vertex_normals(mesh), 12), axis=0)
    assert len(normals) == 6


def test_a_smooth_surface_is_not_split():
    ball = trimesh.creation.icosphere(subdivisions=3, radius=10)
    mesh = build_display_mesh(ball.vertices, ball.faces, points(50))
    assert len(sharp_edges(mesh)) == 0
    assert len(mesh.vertices_mm) == len(solid(mesh).vertices)


def test_limit_on_triangles_holds_both_ways():
    assert len(build_display_mesh(*block(), points(), max_triangles=400).triangles) <= 400
    ball = trimesh.creation.icosphere(subdivisions=5, radius=10)
    thinned = build_display_mesh(ball.vertices, ball.faces, points(50), max_triangles=5_000)
    assert 4_000 < len(thinned.triangles) <= 5_000
    assert solid(thinned).volume == pytest.approx(4 / 3 * np.pi * 1000, rel=0.01)


def test_repeated_vertices_as_in_an_stl_file_are_welded():
    vertices, triangles = block()
    loose = vertices[triangles].reshape(-1, 3)
    mesh = build_display_mesh(loose, np.arange(36).reshape(-1, 3), points())
    assert solid(mesh).is_watertight


def test_interpolated_colours_follow_the_field_up_to_the_edges():
    case = points(4000)
    mesh = build_display_mesh(*block(), case)
    colouring = mesh.colourings["measured"]
    expected = field_mm(mesh.vertices_mm, vertex_normals(mesh))
    assert colouring.known.all()
    assert np.abs(colouring.value_mm - expected).max() < 2e-4  # faces differ by 1e-3 and more


def test_uncut_faces_stay_unknown():
    mesh = build_display_mesh(*block(), points(4000))
    colouring = mesh.colourings["abbe"]
    underside = vertex_normals(mesh)[:, 2] < -0.5
    assert not colouring.known[underside].any()
    assert (colouring.value_mm[underside] == 0).all()
    assert colouring.known[~underside].mean() > 0.99  # but for three points gouged away


def test_no_points_colour_nothing():
    mesh = DisplayMesh(*block())
    empty = points(0)
    assert not interpolate_to_mesh(empty, np.zeros(0), mesh).known.any()
    assert not build_display_mesh(*block(), empty).colourings["abbe"].known.any()


def test_a_parallel_step_without_points_stays_unknown():
    upper = trimesh.creation.box(bounds=[(-10, -10, 0), (10, 10, 5)])
    lower = trimesh.creation.box(bounds=[(-20, -20, -5), (20, 20, 0)])
    part = trimesh.boolean.union([upper, lower], engine="manifold")
    place = [(x, y, 5.0) for x in np.linspace(-9, 9, 10) for y in np.linspace(-9, 9, 10)]
    top = replace(
        points(100),
        point_mm=np.array(place),
        normal=np.tile([0.0, 0.0, 1.0], (100, 1)),
        columns=(Column("abbe", "Abbe", np.full(100, 1e-3), np.full(100, "cut")),),
    )
    mesh = build_display_mesh(part.vertices, part.faces, top)
    known = mesh.colourings["abbe"].known
    faces_up = vertex_normals(mesh)[:, 2] > 0.9
    height = mesh.vertices_mm[:, 2]
    assert known[faces_up & (height > 4.9)].all()
    assert not known[faces_up & (height < 0.1)].any()
