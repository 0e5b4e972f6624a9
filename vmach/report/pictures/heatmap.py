"""heatmap.png: the part coloured by its deviation, one panel a column."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure

from vmach.base.colour_ramp import COLOUR_STOPS
from vmach.base.units import um_from_mm
from vmach.files.atomic import atomic_file
from vmach.report.figures.statistics import Statistics, column_statistics, common_range_mm
from vmach.report.pictures.camera import Camera, isometric_camera, shading
from vmach.report.pictures.colours import colours_of
from vmach.report.pictures.display_mesh import vertex_normals
from vmach.report.pictures.flags import draw_flags
from vmach.report.pictures.rasterise import Visible
from vmach.report.result import Colouring, DisplayMesh, InspectedPoints, RunRecord

__all__ = ["draw_heatmap", "heatmap_png"]

_PANEL_WIDTH_INCH, _DPI = 7.2, 140
_CAPTION_INCH, _HEADING_INCH, _BAR_INCH, _MARGIN_INCH = 0.6, 0.5, 1.3, 0.1
_ARROW_INCH = 0.15  # at both ends of the colour bar
_INK, _GREY = "#1d2125", "#5c646c"


def draw_heatmap(
    path: str | Path,
    mesh: DisplayMesh,
    points: InspectedPoints,
    run: RunRecord,
    *,
    columns: Sequence[str] | None = None,
) -> None:
    """Write `heatmap_png` to a file.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    png = heatmap_png(mesh, points, run, columns=columns)
    with atomic_file(path) as temporary:
        temporary.write_bytes(png)


def heatmap_png(
    mesh: DisplayMesh,
    points: InspectedPoints,
    run: RunRecord,
    *,
    columns: Sequence[str] | None = None,
) -> bytes:
    """Draw the mesh coloured by deviation, all panels on one colour scale.

    Parameters
    ----------
    mesh : DisplayMesh
        With a colouring for each of the columns.
    points, run : InspectedPoints, RunRecord
        For the figures in the captions and flags: title, tolerance and features.
    columns : sequence of str, optional
        Names of the columns to draw; by default all but ``"none"``, a perfect machine, which is
        drawn only where it is the only one.
    """
    names = _telling_columns(points) if columns is None else list(columns)
    range_mm = common_range_mm([points[name] for name in names])
    camera = isometric_camera(mesh.vertices_mm)
    visible = Visible.of(mesh, camera, _size(camera))
    colourings = [mesh.colourings[name] for name in names]
    pictures = _pictures(colourings, mesh, camera, visible, range_mm)
    figure, panels = _figure(len(names), pictures.shape[1] / _DPI)
    for panel, name, picture in zip(panels, names, pictures, strict=True):
        panel.set_axis_off()
        panel.imshow(picture, interpolation="none", aspect="auto")
        _caption(panel, points[name].label, column_statistics(points[name], run.tolerance_mm), run)
        if name == points.primary.name:
            draw_flags(panel, run.features, camera, visible, picture.shape[1::-1])
    left, top = _MARGIN_INCH / figure.get_figwidth(), 1 - 0.34 / figure.get_figheight()
    figure.text(left, top, _plain(run.title), size=15, weight="bold", color=_INK)
    _add_colour_bar(figure, range_mm)
    png = io.BytesIO()
    figure.savefig(png, format="png", facecolor="white")
    return png.getvalue()


def _telling_columns(points: InspectedPoints) -> list[str]:
    names = [column.name for column in points.columns]
    return [name for name in names if name != "none"] or names


def _size(camera: Camera) -> tuple[int, int]:
    """Width and height of a panel's picture in pixels."""
    width = round(_PANEL_WIDTH_INCH * _DPI)
    return width, round(width * camera.height_mm / camera.width_mm)


def _pictures(
    colourings: list[Colouring],
    mesh: DisplayMesh,
    camera: Camera,
    visible: Visible,
    range_mm: float,
) -> np.ndarray:
    """(K, height, width, 4) uint8, one picture a colouring."""
    shade = shading(vertex_normals(mesh), camera)
    colours = (shade[:, None] * colours_of(c.value_mm, c.known, range_mm) for c in colourings)
    return np.stack([visible.coloured(c) for c in colours])


def _figure(count: int, panel_height_inch: float) -> tuple[Figure, list[Axes]]:
    """Panels in one or two columns, each exactly as large as its picture."""
    columns = min(count, 2)
    rows = -(-count // columns)
    pitch = panel_height_inch + _CAPTION_INCH
    width = columns * (_PANEL_WIDTH_INCH + _MARGIN_INCH) + _BAR_INCH
    height = _HEADING_INCH + rows * pitch + _MARGIN_INCH
    figure = Figure((width, height), dpi=_DPI)
    FigureCanvasAgg(figure)
    panels = []
    for i in range(count):
        left = _MARGIN_INCH + (i % columns) * (_PANEL_WIDTH_INCH + _MARGIN_INCH)
        bottom = height - _HEADING_INCH - (i // columns + 1) * pitch
        box = (left / width, bottom / height, _PANEL_WIDTH_INCH / width, panel_height_inch / height)
        panels.append(figure.add_axes(box))
    return figure, panels


def _plain(text: str) -> str:
    """Keep matplotlib from reading mathematics in a user's text."""
    return text.replace("$", r"\$")


def _caption(panel: Axes, label: str, statistics: Statistics, run: RunRecord) -> None:
    """Write the name of the column and its figures above the panel."""
    text = "no cut points"
    if statistics.count:
        low, high, rms, tolerance = (
            um_from_mm(x)
            for x in (statistics.min_mm, statistics.max_mm, statistics.rms_mm, run.tolerance_mm)
        )
        text = (
            f"RMS {rms:.3g} µm      {low:+.3g} … {high:+.3g} µm      "
            f"{100 * statistics.outside_share:.2g} % outside ±{tolerance:g} µm"
        )
    for line, style in (
        (text, {"xytext": (4, 6), "size": 10, "color": _GREY}),
        (_plain(label), {"xytext": (4, 23), "size": 12.5, "color": _INK, "weight": "bold"}),
    ):
        panel.annotate(line, (0, 1), xycoords="axes fraction", textcoords="offset points", **style)


def _add_colour_bar(figure: Figure, range_mm: float) -> None:
    range_um = um_from_mm(range_mm)
    width, height = figure.get_size_inches()
    box = (1 - 1.1 / width, 0.85 / height, 0.22 / width, 1 - 2.2 / height)
    colour_map = LinearSegmentedColormap.from_list("deviation", COLOUR_STOPS)
    bar = figure.colorbar(
        ScalarMappable(Normalize(-range_um, range_um), colour_map),
        cax=figure.add_axes(box),
        extend="both",
        extendfrac=_ARROW_INCH / (box[3] * height),
        ticks=np.linspace(-range_um, range_um, 9),
        format=lambda value, _: f"{value:+.3g}" if abs(value) > 1e-9 * range_um else "0",
    )
    bar.outline.set_visible(False)
    bar.ax.tick_params(labelsize=9, color=_GREY, labelcolor=_INK)
    bar.ax.set_title("material\nleft\n(µm)", fontsize=9, color=_INK, pad=8)
    bar.ax.set_xlabel("too much\nremoved", fontsize=9, color=_INK, labelpad=14)
