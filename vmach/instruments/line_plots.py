"""Deviation against the position along a line, each direction of approach by itself."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from markupsafe import Markup

from vmach.instruments.drawing import against, end_of_scale
from vmach.machine import LINEAR_AXES
from vmach.measurements.instrument import Curves

__all__ = ["line_plots"]


def line_plots(
    curves: Curves, along: np.ndarray, *, unit: str = "µm"
) -> Iterator[tuple[str, Markup]]:
    """Diagrams of readings, in `unit`, along a line, the unit vector `along` (3,)."""
    is_axis = np.count_nonzero(along) == 1
    origin = 0.0 if is_axis else float((curves.path.nose_mm @ along).min())
    position = curves.path.nose_mm @ (np.abs(along) if is_axis else along) - origin
    name = f"{LINEAR_AXES[int(np.argmax(np.abs(along)))]}, mm" if is_axis else "distance, mm"
    side = np.sign(np.round(curves.path.play_side @ along, 9))
    end = end_of_scale(curves)
    for sign, words in ((1, "positions approached forwards"), (-1, "backwards")):
        rows = side == sign
        if rows.any():
            yield words, against(curves, rows, position, name, end, unit=unit)
