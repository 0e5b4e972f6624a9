"""Polar diagrams, one a run: the programmed circle, and deviations from it magnified."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from markupsafe import Markup

from vmach.instruments.drawing import end_of_scale
from vmach.machine import LINEAR_AXES
from vmach.measurements.instrument import Curves
from vmach.report.page.svg_plot import Frame, Plot, number_text, ticks

__all__ = ["circle_plots"]

#: of a polar diagram: its side, and the programmed circle and the room for deviations in pixels
_SIDE, _CIRCLE, _ROOM = 300.0, 92.0, 44.0


def circle_plots(curves: Curves) -> Iterator[tuple[str, Markup]]:
    """A diagram of each run, of readings with radius and centre left free in this order."""
    m = curves.measurement
    angle = np.arctan2(m.nuisance[:, 2], m.nuisance[:, 1])
    end = end_of_scale(curves)
    # the rows turn with the angle: their parts along both axes of the plane tell which these are
    turned = np.linalg.lstsq(m.nuisance[:, 1:], m.sensing, rcond=None)[0]
    axes = [LINEAR_AXES[k] for k in np.argmax(turned, axis=1)]
    for run in dict.fromkeys(m.group.tolist()):
        rows = m.group == run
        plot = _polar(end, axes)
        plot.dots(*_turned(angle[rows], curves.measured[rows] / end), "measured wide")
        for state, values in curves.predicted.items():
            plot.line(*_turned(angle[rows], values[rows] / end), state)
        yield f"{run.removesuffix('.0')} mm/min", plot.markup(f"Ballbar run {run}")


def _turned(angle: np.ndarray, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places in a polar diagram, in pixels from its centre; deviations as shares of the scale."""
    radius = _CIRCLE + _ROOM * share
    return radius * np.cos(angle), radius * np.sin(angle)


def _polar(end_um: float, axes: list[str]) -> Plot:
    """An empty polar diagram with rings that tell the size of a deviation."""
    half = _SIDE / 2
    frame = Frame((-half, half), (-half, half), width=_SIDE, height=_SIDE,
                  left=0.0, right=0.0, top=0.0, bottom=0.0)  # fmt: skip
    plot = Plot(frame)
    for value in ticks(-end_um, end_um, most=4):
        radius = _CIRCLE + _ROOM * value / end_um
        plot.shape(_ring(half, radius), "zero" if value == 0 else "grid")
        words = "programmed" if value == 0 else f"{number_text(value, signed=True)} µm"
        plot.text(half + radius * 0.707 + 2, half - radius * 0.707 - 2, words, "tick")
    plot.shape(f"M{half} 6V{_SIDE - 6}M6 {half}H{_SIDE - 6}", "grid")
    plot.text(_SIDE - 6, half - 4, f"+{axes[0]}", "label end")
    plot.text(half + 4, 14, f"+{axes[1]}", "label")
    return plot


def _ring(centre: float, radius: float) -> str:
    half = f"a{radius:.1f} {radius:.1f} 0 1 0 "
    return f"M{centre - radius:.1f} {centre}{half}{2 * radius:.1f} 0{half}{-2 * radius:.1f} 0"
