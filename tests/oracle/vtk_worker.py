"""A mesh drawn by VTK, in a process of its own: where it finds no graphics it may abort."""

from __future__ import annotations

import sys

import numpy as np
import pyvista

__all__: list[str] = []


def _draw(scene_path: str, picture_path: str) -> None:
    scene = np.load(scene_path)
    _, up, towards = scene["axes"]
    vertices, centre, height = scene["vertices_mm"], scene["centre_mm"], float(scene["height_mm"])
    mesh = pyvista.PolyData.from_regular_faces(vertices, scene["triangles"])
    outline = pyvista.PolyData(
        vertices + 1e-3 * height * towards,
        lines=np.insert(scene["edges"], 0, 2, axis=1).ravel(),
    )
    plotter = pyvista.Plotter(off_screen=True, window_size=scene["size"].tolist())
    plotter.enable_anti_aliasing("ssaa")
    plotter.add_mesh(outline, color="#2a2e33", line_width=1.5, lighting=False)
    plotter.enable_parallel_projection()
    plotter.camera_position = [centre + 10 * height * towards, centre, up]
    plotter.camera.parallel_scale = height / 2
    pictures = []
    for colours in scene["colours"]:
        rgb = np.round(255 * colours).astype(np.uint8)
        plotter.add_mesh(mesh, scalars=rgb, rgb=True, lighting=False, name="part")
        plotter.reset_camera_clipping_range()
        pictures.append(plotter.screenshot(transparent_background=True, return_img=True))
    np.save(picture_path, np.stack(pictures))


if __name__ == "__main__":
    _draw(*sys.argv[1:])
