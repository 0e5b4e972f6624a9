"""Pictures of volumetric accuracy: cones, histogram, maps, errors along a profile; PNG bytes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO

import numpy as np
from matplotlib import colormaps, rcParams, style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from vmach.base.units import um_from_mm
from vmach.machine import Machine, Variant
from vmach.volumetric.comparison import Comparison
from vmach.volumetric.cones import SIDES, cone_mesh, cone_step_mm
from vmach.volumetric.field import ErrorField
from vmach.volumetric.histogram import difference_histogram
from vmach.volumetric.profile import ProfileErrors
from vmach.volumetric.volumetric import assess

__all__ = [
    "accuracy_pictures",
    "dark_pictures",
    "draw_cones",
    "draw_histogram",
    "draw_maps",
    "draw_profile",
]

#: of a dark page, as its style has it
_DARK_PAPER = "#14181d"
_COLOURS = "viridis"
#: told apart by every common kind of colour vision
_AXES = {"X": "#0072b2", "Y": "#d55e00", "Z": "#009e73"}


@contextmanager
def dark_pictures() -> Iterator[None]:
    """What is drawn within is for a dark page."""
    paper = {f"{part}.facecolor": _DARK_PAPER for part in ("figure", "axes", "savefig")}
    with style.context(["dark_background", paper]):
        yield


def accuracy_pictures(
    machine: Machine,
    field: ErrorField,
    coarse: ErrorField,
    comparison: Comparison | None,
    *,
    profile: ProfileErrors | None,
    model: Variant,
) -> dict[str, bytes]:
    """Every picture of a machine's accuracy, by file name, PNG; cones are drawn of `coarse`."""
    largest = assess(field).largest_difference_mm
    edges, counts, _ = difference_histogram(field.error_mm, largest)
    pictures = {
        "histogram.png": draw_histogram(field.magnitude_mm, edges, counts, largest_mm=largest),
        "cones.png": draw_cones(coarse, title=f"{machine.name}, arms: {model}"),
    }
    if comparison is not None:
        pictures["htm_abbe.png"] = draw_maps(comparison, title=machine.name)
    if profile is not None:
        pictures["profile.png"] = draw_profile(
            profile.distance_mm, profile.error_mm, title="profile"
        )
    return pictures


def draw_cones(field: ErrorField, *, title: str) -> bytes:
    """A cone at every grid point, along the error vector; size and colour by its length.

    Parameters
    ----------
    field : ErrorField
        A coarse one (12 x 8 x 6): every cone is drawn.
    title : str
    """
    figure, axes = _space(title)
    magnitude_um = um_from_mm(field.magnitude_mm)
    scale = Normalize(0.0, max(magnitude_um.max(), 1e-9))
    step = cone_step_mm(field.volume)
    vertices, triangles = cone_mesh(field)
    colours = np.repeat(colormaps[_COLOURS](scale(magnitude_um)), 2 * SIDES, axis=0)
    axes.add_collection3d(Poly3DCollection(vertices[triangles], facecolors=colours, linewidths=0))
    low, high = field.volume.low_mm - 0.5 * step, field.volume.high_mm + 0.5 * step
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    for name in "xyz":
        getattr(axes, f"set_{name}label")(f"{name.upper()}, mm", labelpad=10)
    axes.set_box_aspect(high - low)
    figure.colorbar(
        ScalarMappable(scale, _COLOURS), ax=axes, shrink=0.7, label="error of the tool tip, µm"
    )
    return _png(figure)


def _space(title: str):
    figure = Figure(figsize=(9.0, 6.0), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(projection="3d")
    axes.set_title(title)
    return figure, axes


def draw_histogram(
    magnitude_mm: np.ndarray, edges_mm: np.ndarray, counts: np.ndarray, *, largest_mm: float
) -> bytes:
    """Lengths of error vectors, (P,) mm, and of the differences of all pairs, (B,) counts; PNG."""
    figure = Figure(figsize=(10.0, 4.2), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    one, pairs = figure.subplots(1, 2)
    one.hist(um_from_mm(magnitude_mm), bins=50, color="#1f5fa8")
    one.set(xlabel="error of the tool tip, µm", ylabel="grid points", title="at one point")
    pairs.bar(um_from_mm(edges_mm[:-1]), counts, width=np.diff(um_from_mm(edges_mm)), align="edge",
              color="#c44e24")  # fmt: skip
    pairs.axvline(um_from_mm(largest_mm), color=rcParams["text.color"], lw=1.0, ls="--")
    pairs.set(xlabel="difference of errors, µm", ylabel="pairs of points",
              title=f"between two points, at most {um_from_mm(largest_mm):.1f} µm")  # fmt: skip
    return _png(figure)


def draw_maps(comparison: Comparison, *, title: str) -> bytes:
    """Length of the error in three planes Z = const, conventional against Abbe-consistent."""
    figure = Figure(figsize=(11.0, 5.2), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    fields = (("conventional HTM", comparison.htm), ("Abbe-consistent", comparison.abbe))
    largest_um = um_from_mm(max(field.magnitude_mm.max() for _, field in fields))
    x, y, z = comparison.htm.volume.coordinates_mm
    levels = np.unique(np.linspace(0, len(z) - 1, 3).astype(int))
    axes = figure.subplots(2, len(levels), squeeze=False, sharex=True, sharey=True)
    picture = None
    for row, (name, field) in zip(axes, fields, strict=True):
        magnitude_um = um_from_mm(field.magnitude_mm).reshape(field.volume.counts)
        for plot, level in zip(row, levels, strict=True):
            picture = plot.pcolormesh(
                x, y, magnitude_um[:, :, level].T, shading="nearest", vmin=0.0,
                vmax=max(largest_um, 1e-9), cmap=_COLOURS,
            )  # fmt: skip
            plot.set_title(f"{name}, Z = {z[level]:.0f} mm", fontsize=9)
            plot.set_aspect("equal", adjustable="box")
    figure.supxlabel("X, mm")
    figure.supylabel("Y, mm")
    figure.suptitle(
        f"{title}: mean {um_from_mm(comparison.mean_htm_mm):.1f} µm against "
        f"{um_from_mm(comparison.mean_abbe_mm):.1f} µm, {comparison.in_words}\n"
        "(this machine with these set-ups; the size is no constant of the method)",
        fontsize=10,
    )
    figure.colorbar(picture, ax=axes, shrink=0.8, label="error of the tool tip, µm")
    return _png(figure)


def draw_profile(distance_mm: np.ndarray, error_mm: np.ndarray, *, title: str) -> bytes:
    """Errors in X, Y, Z, (P, 3) mm, and their length along a path, (P,) mm; PNG."""
    figure = Figure(figsize=(9.0, 4.4), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    for column, name in enumerate("XYZ"):
        shown_um = um_from_mm(error_mm[:, column])
        axes.plot(distance_mm, shown_um, lw=1.2, color=_AXES[name], label=name)
    length = np.linalg.norm(error_mm, axis=1)
    axes.plot(distance_mm, um_from_mm(length), "--", color=rcParams["text.color"], lw=1.0,
              label="length")  # fmt: skip
    axes.set(title=title, xlabel="distance along the path, mm", ylabel="error of the tool tip, µm")
    axes.grid(alpha=0.3)
    axes.legend(ncols=4, fontsize=8)
    return _png(figure)


def _png(figure: Figure) -> bytes:
    stream = BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None})
    return stream.getvalue()
