"""The path of a circular test round the programmed circle, its deviations far enlarged.

Source: ISO 230-4, presentation of results: both ways in one diagram, with its scale.
"""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from vmach.base.units import um_from_mm
from vmach.features.circular_test import CircularTest
from vmach.report.page.svg_plot import Frame, Plot, number_text, ticks

__all__ = ["polar_plot"]

#: of the picture, px; and how far from the programmed circle, of radius 1, the largest ring is
_SIZE, _REACH = 300.0, 0.42
_ROUND = np.linspace(0.0, 2.0 * np.pi, 181)


def polar_plot(test: CircularTest) -> Markup:
    """A diagram of both paths; rings are deviations in um."""
    radial_um = [um_from_mm(radial) for radial in test.radial_mm]
    most = max(max(float(np.abs(radial).max()) for radial in radial_um), 1e-3)
    rings = ticks(-most, most, most=4)
    enlarged = _REACH / max(most, float(np.abs(rings).max()))
    frame = Frame((-1.5, 1.5), (-1.5, 1.5), _SIZE, _SIZE, left=4, right=4, top=4, bottom=4)
    plot = Plot(frame)
    for name, x, y in ((test.plane[0], 1.5, 0.0), (test.plane[1], 0.0, 1.5)):
        plot.line(np.array([-x, x]), np.array([-y, y]), "grid")
        plot.text(float(frame.columns(x)) - 10 * (x > y), float(frame.rows(y)) + 10 * (y > x) - 3,
                  f" {name}", "label")  # fmt: skip
    for ring in rings:
        _circle(plot, 1.0 + enlarged * ring, "zero" if ring == 0 else "grid")
        place = (1.0 + enlarged * ring) * np.sqrt(0.5)
        plot.text(float(frame.columns(place)), float(frame.rows(-place)) + 4,
                  number_text(ring, signed=True), "tick")  # fmt: skip
    for kind, angle, radial in zip(("ccw", "cw"), test.angle_rad, radial_um, strict=True):
        reached = 1.0 + enlarged * np.append(radial, radial[0])
        closed = np.append(angle, angle[0])
        plot.line(reached * np.cos(closed), reached * np.sin(closed), kind)
    return plot.markup(f"{test.plane}, radius {test.radius_mm:g} mm: both paths, in um")


def _circle(plot: Plot, radius: float, kind: str) -> None:
    plot.line(radius * np.cos(_ROUND), radius * np.sin(_ROUND), kind)
