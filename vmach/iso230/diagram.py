"""The usual diagram of ISO 230-2: means of both directions, two standard deviations, A and E.

Source: ISO 230-2:2014, presentation of results.
"""

from __future__ import annotations

from io import BytesIO

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from vmach.base.units import with_micro_sign
from vmach.iso230.evaluation import Evaluation

__all__ = ["draw_evaluation"]

_FORWARD, _BACKWARD, _MEAN = "#1f5fa8", "#c44e24", "#555555"


def draw_evaluation(
    result: Evaluation, *, title: str, unit: str, factor: float, position_unit: str = "mm"
) -> bytes:
    """Draw the diagram of one axis.

    Parameters
    ----------
    result : Evaluation
    title : str
    unit : str
        Of the vertical axis.
    factor : float
        From the unit of the evaluation to `unit`.
    position_unit : str
        Of the target positions.

    Returns
    -------
    bytes
        A PNG picture.
    """
    unit = with_micro_sign(unit)
    figure = Figure(figsize=(9.0, 5.2), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    x = result.runs.position_mm
    sides = (
        ("forward", _FORWARD, ">", result.runs.forward, result.mean_forward, result.s_forward),
        ("backward", _BACKWARD, "<", result.runs.backward, result.mean_backward, result.s_backward),
    )
    for name, colour, marker, readings, mean, s in sides:
        axes.plot(x, factor * readings.T, ".", ms=3, color=colour, alpha=0.4)
        axes.plot(
            x, factor * mean, marker=marker, ms=5, lw=1.4, color=colour, label=f"{name}, mean"
        )
        if s is not None:
            low, high = factor * (mean - 2 * s), factor * (mean + 2 * s)
            axes.fill_between(x, low, high, color=colour, alpha=0.13, lw=0, label=f"{name}, ±2s")
    middle = 0.5 * (result.mean_forward + result.mean_backward)
    axes.plot(x, factor * middle, "--", lw=1.0, color=_MEAN, label="mean of both")
    _mark_ranges(axes, result, factor)
    axes.set(title=title, xlabel=f"target position, {position_unit}", ylabel=f"deviation, {unit}")
    axes.text(
        1.01, 0.5, _figures_text(result, unit, factor), transform=axes.transAxes, va="center",
        family="monospace", fontsize=9,
    )  # fmt: skip
    axes.grid(alpha=0.3)
    figure.legend(fontsize=8, ncols=5, loc="outside lower center")
    stream = BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None})
    return stream.getvalue()


def _mark_ranges(axes: Axes, result: Evaluation, factor: float) -> None:
    """Lines at both ends of E, and of A where there are runs enough."""
    styles = {"E": (_MEAN, 0.8, ":"), "A": ("black", 0.9, "-.")}
    for name, ends in result.ends().items():
        colour, width, dashes = styles[name]
        for end in ends:
            axes.axhline(factor * end, color=colour, lw=width, ls=dashes)


def _figures_text(result: Evaluation, unit: str, factor: float) -> str:
    values = result.figures()
    rows = [
        f"{name:<10} {'-' if value is None else format(round(factor * value, 4), '8.2f')}"
        for name, value in values.items()
    ]
    return "\n".join([f"ISO 230-2, {unit}", *rows, "", "-.-  range A", "...  range E"])
