"""Two programs that share no drawing code, VTK and the rasteriser, make the same picture."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.report_case import block, points
from vmach.report import build_display_mesh
from vmach.report.pictures.camera import isometric_camera
from vmach.report.pictures.colours import colours_of
from vmach.report.pictures.display_mesh import sharp_edges
from vmach.report.pictures.rasterise import rasterise

WORKER = Path(__file__).with_name("vtk_worker.py")


def vtk_picture(mesh, colours, camera, size, *, folder):
    """(height, width, 4) uint8, or None where VTK cannot draw."""
    scene, picture = folder / "scene.npz", folder / "picture.npy"
    np.savez(
        scene,
        vertices_mm=mesh.vertices_mm,
        triangles=mesh.triangles,
        edges=sharp_edges(mesh),
        colours=colours[None],
        axes=camera.axes,
        centre_mm=camera.centre_mm,
        height_mm=camera.height_mm,
        size=size,
    )
    command = [sys.executable, "-P", WORKER, scene, picture]
    environment = os.environ | {"PYVISTA_OFF_SCREEN": "true"}
    subprocess.run(command, capture_output=True, timeout=120, env=environment)
    return np.load(picture)[0] if picture.exists() else None


def test_rasteriser_and_vtk_agree(tmp_path):
    mesh = build_display_mesh(*block(), points(2000))
    colouring = mesh.colourings["abbe"]
    colours = colours_of(colouring.value_mm, colouring.known, 6e-3)
    camera = isometric_camera(mesh.vertices_mm)
    size = (480, round(480 * camera.height_mm / camera.width_mm))
    vtk = vtk_picture(mesh, colours, camera, size, folder=tmp_path)
    if vtk is None:
        pytest.skip("VTK has no off-screen graphics here")
    own = rasterise(mesh, colours, camera, size).astype(int)
    vtk = vtk.astype(int)
    covered = (own[..., 3] == 255) & (vtk[..., 3] == 255)
    assert abs((own[..., 3] > 127).mean() - (vtk[..., 3] > 127).mean()) < 0.01
    difference = np.abs(own - vtk)[covered][:, :3].max(axis=1)
    assert np.median(difference) <= 2
    assert (difference > 12).mean() < 0.03  # along the outlines, drawn a pixel wider by VTK
