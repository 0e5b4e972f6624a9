"""Readings of instruments the way each is usually drawn: measured, predicted before and after."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from vmach.base.units import um_from_mm
from vmach.diagnosis.residuals import Residuals
from vmach.effects import Circumstances
from vmach.machine import LINEAR_AXES
from vmach.measurements import Measurement
from vmach.report.page.svg_plot import Frame, Plot, number_text, ticks

__all__ = ["InstrumentPicture", "instrument_pictures"]

_TITLES = {
    "ballbar": "Ballbar",
    "laser": "Laser line",
    "diagonal": "Diagonal",
    "drift": "Drift test",
    "tip": "Tool tip in the work space",
}
#: half width of a 95 % interval in standard uncertainties
_WIDE = 1.96
#: of a polar diagram: its side, and the programmed circle and the room for deviations in pixels
_SIDE, _CIRCLE, _ROOM = 300.0, 92.0, 44.0


@dataclass(frozen=True)
class InstrumentPicture:
    """Diagrams of one measurement, each with a title."""

    kind: str
    title: str
    note: str
    plots: tuple[tuple[str, Markup], ...]


@dataclass(frozen=True)
class _Curves:
    """Readings of one measurement in um, (P,) each: predictions by "before" and "after".

    `open_law` is the standard uncertainty that the effects' laws leave.
    """

    measurement: Measurement
    path: Circumstances
    measured: np.ndarray
    predicted: dict[str, np.ndarray]
    open_law: np.ndarray


def instrument_pictures(residuals: Residuals) -> list[InstrumentPicture]:
    """A picture for every measurement that is not of a part.

    Of each curve the zero, centre or pose that the instrument leaves free is taken off.
    """
    found = []
    for curves in _curves(residuals):
        m = curves.measurement
        if m.kind in _DRAWERS:
            plots = tuple(_DRAWERS[m.kind](curves))
            found.append(
                InstrumentPicture(m.kind, f"{_TITLES[m.kind]}: {m.name}", _note(curves), plots)
            )
    return found


def _curves(residuals: Residuals) -> Iterator[_Curves]:
    survey = residuals.survey
    measured = residuals.aligned(np.concatenate([m.measured_mm for m in survey.measurements]))
    for measurement, path, own in zip(survey.measurements, survey.paths, survey.rows, strict=True):
        predicted = {
            state: um_from_mm(measured[own] - residuals.of(state)[own])
            for state in residuals.states
        }
        open_law = um_from_mm(residuals.open_mm[own])
        yield _Curves(measurement, path, um_from_mm(measured[own]), predicted, open_law)


def _note(curves: _Curves) -> str:
    """What is taken off each curve, and what a band is."""
    measurement = curves.measurement
    tip = "pose" if measurement.nuisance.shape[1] > 3 else "offset"
    free = {"ballbar": "radius and centre", "tip": f"{tip} of the instrument"}
    fitted = f"{free.get(measurement.kind, 'zero')} of each curve fitted"
    has_band = measurement.kind in ("laser", "diagonal", "drift") and curves.open_law.max() > 0.0
    return f"{fitted}; band: 95 % of what the effects' laws leave open" if has_band else fitted


def _ballbar(curves: _Curves) -> Iterator[tuple[str, Markup]]:
    """Polar diagrams, one a run: the programmed circle, and deviations from it magnified."""
    m = curves.measurement
    angle = np.arctan2(m.nuisance[:, 2], m.nuisance[:, 1])
    end = _end(curves)
    # the rows turn with the angle: their parts along both axes of the plane tell which these are
    turned = np.linalg.lstsq(m.nuisance[:, 1:], m.sensing, rcond=None)[0]
    axes = [LINEAR_AXES[k] for k in np.argmax(turned, axis=1)]
    for run in dict.fromkeys(m.group.tolist()):
        rows = m.group == run
        plot = _polar(end, axes)
        plot.dots(*_turned(angle[rows], curves.measured[rows] / end), "measured")
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


def _line(curves: _Curves) -> Iterator[tuple[str, Markup]]:
    """Deviation against position, each direction of approach by itself."""
    m = curves.measurement
    along = m.sensing[0]
    is_axis = np.count_nonzero(along) == 1
    origin = 0.0 if is_axis else float((curves.path.nose_mm @ along).min())
    position = curves.path.nose_mm @ (np.abs(along) if is_axis else along) - origin
    name = f"{LINEAR_AXES[int(np.argmax(np.abs(along)))]}, mm" if is_axis else "distance, mm"
    side = np.sign(np.round(curves.path.play_side @ along, 9))
    end = _end(curves)
    for sign, words in ((1, "positions approached forwards"), (-1, "backwards")):
        rows = side == sign
        if rows.any():
            yield words, _against(curves, rows, position, name, end)


def _drift(curves: _Curves) -> Iterator[tuple[str, Markup]]:
    """Each direction against time."""
    minutes, end = curves.path.time_s / 60, _end(curves)
    for k, axis in enumerate(LINEAR_AXES):
        rows = curves.measurement.sensing[:, k] > 0.5
        yield f"tool tip in {axis}", _against(curves, rows, minutes, "time, min", end)


def _against(
    curves: _Curves, rows: np.ndarray, value: np.ndarray, name: str, end_um: float
) -> Markup:
    """Measured dots and predicted lines over a number; the lines break between runs."""
    margin = 0.02 * max(float(np.ptp(value[rows])), 1e-9)
    x = float(value[rows].min()) - margin, float(value[rows].max()) + margin
    plot = Plot(Frame(x, (-end_um, end_um), top=18.0))
    plot.y_axis("µm")
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


def _tip(curves: _Curves) -> Iterator[tuple[str, Markup]]:
    """Measured against predicted, by component: on the diagonal they agree."""
    end = _end(curves)
    for k, axis in enumerate(LINEAR_AXES):
        rows = curves.measurement.sensing[:, k] > 0.5
        frame = Frame((-end, end), (-end, end), width=300.0, height=300.0, top=18.0)
        plot = Plot(frame)
        plot.y_axis("measured, µm")
        plot.x_axis("predicted, µm", ticks(-end, end, most=5))
        plot.line(np.array([-end, end]), np.array([-end, end]), "diagonal")
        for state, values in curves.predicted.items():
            plot.dots(values[rows], curves.measured[rows], state)
        yield f"component {axis}", plot.markup(f"Measured against predicted, component {axis}")


def _end(curves: _Curves) -> float:
    """End of the scale that all diagrams of a measurement share."""
    largest = max(np.abs(v).max() for v in (curves.measured, *curves.predicted.values()))
    return 1.05 * max(float(largest), 0.1)


_DRAWERS: dict[str, Callable[[_Curves], Iterator[tuple[str, Markup]]]] = {
    "ballbar": _ballbar,
    "laser": _line,
    "diagonal": _line,
    "drift": _drift,
    "tip": _tip,
}
