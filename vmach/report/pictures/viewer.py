"""A window on a finished result: ``vmach view DIR``."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np

from vmach.base.colour_ramp import COLOUR_STOPS, UNKNOWN_COLOUR
from vmach.base.units import um_from_mm
from vmach.errors import InputError
from vmach.report.figures.deviations_csv import read_deviations_csv
from vmach.report.figures.statistics import common_range_mm
from vmach.report.pictures.camera import TOWARDS_VIEWER
from vmach.report.pictures.display_mesh import build_display_mesh
from vmach.report.result import InspectedPoints

__all__ = ["open_viewer"]

_BAR_TITLE = "µm, positive: material left"


def open_viewer(folder: str | Path) -> None:
    """Show the part of a result folder coloured by its deviations; ``n`` shows the next column.

    Parameters
    ----------
    folder : path
        With deviations.csv, and part.stl where there is a virtual part; the points alone are
        shown where there is none.

    Raises
    ------
    InputError
        The folder holds no result, or there is no display to open a window on.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise InputError("no such folder", file=folder, accepted="an output folder of vmach run")
    points = read_deviations_csv(folder / "deviations.csv")
    if not _has_display():
        raise InputError(
            "no display to open a window on",
            file=folder,
            hint=f"open {folder / 'report.html'} in a browser; it has the same map",
        )
    _plotter(folder, points).show()


def _has_display() -> bool:
    if sys.platform.startswith("linux"):
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True


def _plotter(folder: Path, points: InspectedPoints):
    import pyvista  # late: seconds that only this command needs
    from matplotlib.colors import LinearSegmentedColormap

    surface = _coloured_surface(folder / "part.stl", points)
    names = [column.name for column in points.columns]
    range_um = um_from_mm(common_range_mm(points.columns))
    plotter = pyvista.Plotter(title=f"vmach: {folder}")

    def show(name: str) -> None:
        plotter.add_mesh(
            surface,
            scalars=name,
            name="part",
            clim=(-range_um, range_um),
            cmap=LinearSegmentedColormap.from_list("deviation", COLOUR_STOPS),
            nan_color=UNKNOWN_COLOUR,
            ambient=0.6,
            diffuse=0.4,
            point_size=8,
            copy_mesh=True,
            show_scalar_bar=False,
        )
        plotter.add_scalar_bar(_BAR_TITLE, n_labels=5, fmt="%+.3g", render=False)
        plotter.add_text(f"{name}    (n: next variant)", name="caption", font_size=11)

    def show_next() -> None:
        names.append(names.pop(0))
        plotter.remove_scalar_bar(_BAR_TITLE)
        show(names[0])

    while names[0] != points.primary.name:
        names.append(names.pop(0))
    show(names[0])
    plotter.add_key_event("n", show_next)
    plotter.add_axes()
    plotter.enable_parallel_projection()
    plotter.view_vector(TOWARDS_VIEWER, viewup=(0, 0, 1))
    return plotter


def _coloured_surface(part: Path, points: InspectedPoints):
    """The part, or the points alone, with an array of deviations in um for each column."""
    import pyvista

    if not part.is_file():
        cloud = pyvista.PolyData(points.point_mm)
        for column in points.columns:
            cloud[column.name] = np.where(column.is_cut, um_from_mm(column.deviation_mm), np.nan)
        return cloud
    solid = pyvista.read(part)
    mesh = build_display_mesh(solid.points, solid.regular_faces, points)
    surface = pyvista.PolyData.from_regular_faces(mesh.vertices_mm, mesh.triangles)
    for name, colouring in mesh.colourings.items():
        surface[name] = np.where(colouring.known, um_from_mm(colouring.value_mm), np.nan)
    return surface
