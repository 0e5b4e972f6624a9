"""Residuals against every covariate: one small diagram each, the clearest dependence first."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from vmach.base.units import um_from_mm
from vmach.diagnosis.residuals import Residuals
from vmach.diagnosis.residuals.covariates import Covariate, covariates
from vmach.diagnosis.residuals.where_it_fails import Chance, chance_of
from vmach.report.page.svg_plot import Frame, Plot, ticks
from vmach.report.pictures.colours import colour_range

__all__ = ["ClassMeans", "Panel", "covariate_panels"]

#: half width of a 95 % interval in standard uncertainties
_WIDE = 1.96
#: dots of one colour in a diagram, and classes in a list
_MOST_DOTS, _MOST_ROWS = 1000, 9
_ROW, _NAMES, _LETTERS = 22.0, 190.0, 29
#: what stands for long words beside a row
_SHORT = (
    (", surfaces facing", " · facing"), (", readings along", " · along"),
    (", diameters", " · diameters"), ("surfaces ", ""), ("readings ", ""), ("after ", ""),
)  # fmt: skip
#: of classes that cannot differ
_CERTAIN = Chance(1.0, -np.inf)


@dataclass(frozen=True)
class ClassMeans:
    """Mean residual of each class of readings, (c,) mm, and its standard uncertainty."""

    mean_mm: np.ndarray
    u_mm: np.ndarray

    @property
    def clear(self) -> np.ndarray:
        """How many standard uncertainties each mean lies from zero, (c,)."""
        return np.abs(self.mean_mm) / self.u_mm

    @property
    def bars_um(self) -> np.ndarray:
        """Means and half widths of their 95 % intervals, (2, c)."""
        return um_from_mm(np.stack([self.mean_mm, _WIDE * self.u_mm]))


@dataclass(frozen=True)
class Panel:
    """How the residual depends on one covariate.

    Attributes
    ----------
    covariate : Covariate
    chance : dict of str to Chance
        How often noise alone makes the classes differ like this, "before" and, where effects were
        fitted, "after"; always where what is free takes up every difference.
    means : dict of str to ClassMeans
        Likewise.
    svg : Markup
    """

    covariate: Covariate
    chance: dict[str, Chance]
    means: dict[str, ClassMeans]
    svg: Markup

    @property
    def hidden_rows(self) -> int:
        """Classes that the picture has no room for."""
        return max(len(self.covariate) - _MOST_ROWS, 0) if self.covariate.value is None else 0


def covariate_panels(residuals: Residuals) -> list[Panel]:
    """A panel for every covariate, the least likely to be chance first."""
    end_um = um_from_mm(colour_range([residuals.of(state) for state in residuals.states]))
    panels = [_panel(residuals, covariate, end_um) for covariate in covariates(residuals.survey)]
    return sorted(panels, key=lambda panel: -panel.chance["before"].deviate)


def _panel(residuals: Residuals, covariate: Covariate, end_um: float) -> Panel:
    means = {state: _class_means(residuals, covariate, state) for state in residuals.states}
    draw = _rows_of_classes if covariate.value is None else _against_value
    plot = draw(residuals, covariate, means, end_um)
    return Panel(
        covariate=covariate,
        chance={state: _chance(residuals, covariate, state) for state in residuals.states},
        means=means,
        svg=plot.markup(f"Measured minus predicted against {covariate.title}"),
    )


def _chance(residuals: Residuals, covariate: Covariate, state: str) -> Chance:
    after = state == "after"
    white = residuals.white(residuals.survey.residual_mm, after=after)
    return chance_of(white, residuals.white(covariate.is_in, after=after)) or _CERTAIN


def _class_means(residuals: Residuals, covariate: Covariate, state: str) -> ClassMeans:
    weights = (covariate.is_in / covariate.counts).T
    u_mm = residuals.class_u_mm(weights, after=state == "after")
    return ClassMeans(weights @ residuals.of(state), u_mm)


def _against_value(
    residuals: Residuals, covariate: Covariate, means: dict[str, ClassMeans], end_um: float
) -> Plot:
    """The residual over a number: light dots, and the mean of every zone."""
    value = covariate.value
    assert value is not None
    margin = 0.02 * max(np.ptp(value), 1e-9)
    x = (float(value.min()) - margin, float(value.max()) + margin)
    plot = Plot(Frame(x, (-end_um, end_um), top=18.0))
    plot.y_axis("µm")
    plot.x_axis(covariate.title)
    some = _some(len(value))
    for state in means:
        plot.dots(value[some], um_from_mm(residuals.of(state)[some]), state)
    middle = plot.frame.columns(covariate.means(value))
    for (state, found), shift in zip(means.items(), _apart(means, 5.0), strict=True):
        for at, mean, half in zip(middle, *found.bars_um, strict=True):
            plot.error_bar(at + shift, mean, half, state, along="y")
    return plot


def _rows_of_classes(
    residuals: Residuals, covariate: Covariate, means: dict[str, ClassMeans], end_um: float
) -> Plot:
    """A row for each class, those first whose mean is the least likely to be noise."""
    shown = np.argsort(-means["before"].clear, kind="stable")[:_MOST_ROWS]
    rows = len(shown)
    frame = Frame(
        (-end_um, end_um), (rows, 0.0), height=44.0 + _ROW * rows, left=_NAMES, top=6.0, bottom=38.0
    )
    plot = Plot(frame)
    plot.x_axis("measured − predicted, µm", ticks(-end_um, end_um, most=5), zero="zero")
    drawn = np.isin(np.arange(len(covariate.number)), _some(len(covariate.number)))
    for row, number in enumerate(shown.tolist()):
        words, count = covariate.words[number], covariate.counts[number]
        middle = float(frame.rows(row + 0.5))
        plot.text(_NAMES - 8, middle + 4, _shortened(words), "name end", title=f"{words} ({count})")
        own = drawn & (covariate.number == number)
        for (state, found), shift in zip(means.items(), _apart(means, 0.36), strict=True):
            place = row + 0.5 + shift
            plot.dots(um_from_mm(residuals.of(state)[own]), place, state)
            mean, half = found.bars_um[:, number]
            plot.error_bar(float(frame.rows(place)), mean, half, state, along="x")
    return plot


def _apart(means: dict[str, ClassMeans], distance: float) -> np.ndarray:
    """Shifts that keep the marks of several states from covering each other."""
    return distance * (np.arange(len(means)) - 0.5 * (len(means) - 1))


def _some(count: int) -> np.ndarray:
    """Indices of at most so many readings as a diagram can show, evenly through the list."""
    return np.linspace(0, count - 1, min(count, _MOST_DOTS)).round().astype(int)


def _shortened(words: str) -> str:
    """What fits beside a row."""
    for long, short in _SHORT:
        words = words.replace(long, short)
    words = words.removeprefix("feature ")
    if len(words) > _LETTERS:
        words = words.split(" of ")[0]  # a feature without its file
    return words if len(words) <= _LETTERS else words[:12] + "…" + words[13 - _LETTERS :]
