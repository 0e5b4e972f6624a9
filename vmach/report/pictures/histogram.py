"""How often each deviation occurs, one histogram a column on a common axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vmach.report.pictures.colours import colour_range, colours_of, nice_ceiling
from vmach.report.result import Column

__all__ = ["Histogram", "histograms"]

_BINS = 80


@dataclass(frozen=True)
class Histogram:
    """Counts of one column in bins of equal width from -end to +end.

    Attributes
    ----------
    name, label : str
        Of the column.
    end_mm : float
        Half width of the axis. The outermost bins also hold what is beyond.
    counts : (80,) int
    colours : list of str
        CSS colour of each bin, the one that the middle of the bin has in the heat map.
    """

    name: str
    label: str
    end_mm: float
    counts: np.ndarray
    colours: list[str]


def histograms(columns: Sequence[Column]) -> list[Histogram]:
    """Return the histograms of the cut points of columns, on one axis."""
    values = [column.deviation_mm[column.is_cut] for column in columns]
    range_mm = colour_range(values)
    largest = max([range_mm, *(np.abs(v).max() for v in values if v.size)])
    end = min(nice_ceiling(largest), 2 * range_mm)
    edges = np.linspace(-end, end, _BINS + 1)
    middle = 0.5 * (edges[1:] + edges[:-1])
    rgb = np.round(255 * colours_of(middle, np.ones(_BINS, bool), range_mm)).astype(int)
    colours = ["#{:02x}{:02x}{:02x}".format(*colour) for colour in rgb.tolist()]
    return [
        Histogram(
            column.name,
            column.label,
            end,
            np.histogram(np.clip(value, -end, end), edges)[0],
            colours,
        )
        for column, value in zip(columns, values, strict=True)
    ]
