"""Diagrams that several instruments share: dots are measured, lines predicted."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from vmach.measurements.instrument import Curves
from vmach.report.page.svg_plot import Frame, Plot

__all__ = ["against", "end_of_scale"]

#: half width of a 95 % interval in standard uncertainties
_WIDE = 1.96


def against(
    curves: Curves,
    rows: np.ndarray,
    value: np.ndarray,
    name: str,
    end_um: float,
    *,
    unit: str = "µm",
) -> Markup:
    """Measured dots and predicted lines over a number; the lines break between runs.

    Parameters
    ----------
    curves : Curves
    rows : (P,) bool
        Readings that are drawn.
    value : (P,) float64
        The number.
    name : str
        What it is, with its unit.
    end_um : float
        End of the scale.
    unit : str
        Of the readings, as the axis shows it.
    """
    margin = 0.02 * max(float(np.ptp(value[rows])), 1e-9)
    x = float(value[rows].min()) - margin, float(value[rows].max()) + margin
    plot = Plot(Frame(x, (-end_um, end_um), top=18.0))
    plot.y_axis(unit)
    plot.x_axis(name)
    runs = [
        _in_order(value, rows, curves.measurement.group == run)
        for run in dict.fromkeys(curves.measurement.group[rows].tolist())
    ]
    if "after" in curves.predicted and curves.open_law[rows].max() > 0.0:
        middle, wide = curves.predicted["after"], _WIDE * curves.open_law
        low, high = middle - wide, middle + wide
        plot.bands([(value[run], low[run], high[run]) for run in runs], "after")
    for state, values in curves.predicted.items():
        for run in runs:
            plot.line(value[run], values[run], state)
    plot.dots(value[rows], curves.measured[rows], "measured")
    return plot.markup(f"{curves.measurement.name} against {name}")


def _in_order(value: np.ndarray, rows: np.ndarray, own: np.ndarray) -> np.ndarray:
    """Indices of the readings in both sets, by rising value."""
    found = np.flatnonzero(rows & own)
    return found[np.argsort(value[found], kind="stable")]


def end_of_scale(curves: Curves) -> float:
    """End of the scale that all diagrams of a measurement share, um."""
    largest = max(np.abs(v).max() for v in (curves.measured, *curves.predicted.values()))
    return 1.05 * max(float(largest), 0.1)
