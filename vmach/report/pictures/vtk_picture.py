"""A picture of a coloured mesh drawn by VTK off screen, in a process of its own.

Where VTK finds no graphics library it may abort instead of raising, so it never runs inside
the program: `vtk_pictures` starts `vtk_worker.py` as a script and takes what it leaves.
"""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from vmach.report.pictures.camera import Camera
from vmach.report.pictures.display_mesh import sharp_edges
from vmach.report.result import DisplayMesh

__all__ = ["INSTALL_HINT", "vtk_pictures"]

INSTALL_HINT = "sudo apt-get install libegl1 libgl1-mesa-dri libx11-6"
_LIBRARIES = ("libEGL.so.1", "libX11.so.6")
_TIME_LIMIT_S = 120
_WORKER = Path(__file__).with_name("vtk_worker.py")


def vtk_pictures(
    mesh: DisplayMesh, colours: np.ndarray, camera: Camera, size: tuple[int, int]
) -> np.ndarray | None:
    """Draw like `vmach.report.pictures.rasterise.rasterise`, several pictures of one mesh at once.

    Parameters
    ----------
    mesh : DisplayMesh
    colours : (K, V, 3) float
        One set of vertex colours a picture.
    camera : Camera
    size : (int, int)

    Returns
    -------
    (K, height, width, 4) uint8, or None where VTK cannot draw
    """
    if not all(_loads(library) for library in _LIBRARIES):
        return None
    with tempfile.TemporaryDirectory() as folder:
        scene, picture = Path(folder, "scene.npz"), Path(folder, "picture.npy")
        np.savez(
            scene,
            vertices_mm=mesh.vertices_mm,
            triangles=mesh.triangles,
            edges=sharp_edges(mesh),
            colours=colours,
            axes=camera.axes,
            centre_mm=camera.centre_mm,
            height_mm=camera.height_mm,
            size=size,
        )
        try:
            subprocess.run(
                [sys.executable, "-P", _WORKER, scene, picture],
                capture_output=True,
                check=True,
                timeout=_TIME_LIMIT_S,
                env=os.environ | {"PYVISTA_OFF_SCREEN": "true"},
            )
        except (subprocess.SubprocessError, OSError):
            return None
        return np.load(picture) if picture.exists() else None


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
