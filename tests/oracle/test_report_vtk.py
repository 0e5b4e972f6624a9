"""Two programs that share no drawing code, VTK and the rasteriser, make the same picture."""

import numpy as np
import pytest

from tests.report_case import block, points
from vmach.report import build_display_mesh
from vmach.report.pictures.camera import isometric_camera
from vmach.report.pictures.colours import colours_of
from vmach.report.pictures.rasterise import rasterise
from vmach.report.pictures.vtk_picture import vtk_pictures


def test_rasteriser_and_vtk_agree():
    mesh = build_display_mesh(*block(), points(2000))
    colouring = mesh.colourings["abbe"]
    colours = colours_of(colouring.value_mm, colouring.known, 6e-3)
    camera = isometric_camera(mesh.vertices_mm)
    size = (480, round(480 * camera.height_mm / camera.width_mm))
    pictures = vtk_pictures(mesh, colours[None], camera, size)
    if pictures is None:
        pytest.skip("VTK has no off-screen graphics here")
    own = rasterise(mesh, colours, camera, size).astype(int)
    vtk = pictures[0].astype(int)
    covered = (own[..., 3] == 255) & (vtk[..., 3] == 255)
    assert abs((own[..., 3] > 127).mean() - (vtk[..., 3] > 127).mean()) < 0.01
    difference = np.abs(own - vtk)[covered][:, :3].max(axis=1)
    assert np.median(difference) <= 2
    assert (difference > 12).mean() < 0.03  # along the outlines, drawn a pixel wider by VTK
