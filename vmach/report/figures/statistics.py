"""Figures that describe one column of deviations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vmach.report.pictures.colours import colour_range, nice_ceiling
from vmach.report.result import STATUSES, Column, InspectedPoints

__all__ = [
    "Statistics",
    "apart_on_part_mm",
    "column_statistics",
    "common_range_mm",
    "feature_statistics",
    "worst_apart_mm",
    "worst_places",
    "worst_rows",
]

#: share of the part's size that two worst places of one feature are apart
_APART = 0.05


@dataclass(frozen=True)
class Statistics:
    """Statistics over the cut points; lengths in mm, NaN where there is no cut point.

    Attributes
    ----------
    count : int
        Cut points, the ones that the other figures are over.
    status_counts : dict
        Number of all points by status.
    mean_mm, rms_mm, min_mm, max_mm : float
        `rms_mm` is about zero, not about the mean. It and the mean count points by their weight.
    outside_count : int
        Cut points with abs(deviation) above the tolerance.
    outside_share : float
        Share of the cut points outside the tolerance by weight, 0 to 1; NaN without cut points.
    """

    count: int
    status_counts: dict[str, int]
    mean_mm: float
    rms_mm: float
    min_mm: float
    max_mm: float
    outside_count: int
    outside_share: float

    @property
    def peak_to_valley_mm(self) -> float:
        """Largest minus smallest deviation."""
        return self.max_mm - self.min_mm


def column_statistics(
    column: Column, tolerance_mm: float, *, among: np.ndarray | None = None
) -> Statistics:
    """Return the statistics of a column, optionally `among` (P,) bool points only."""
    chosen = np.ones(len(column.status), bool) if among is None else among
    status = column.status[chosen]
    cut = chosen & column.is_cut
    deviation = column.deviation_mm[cut]
    weight = None if column.weight is None else column.weight[cut]
    outside = np.abs(deviation) > tolerance_mm
    mean = rms = low = high = share = np.nan
    if deviation.size:
        mean, square, share = (
            np.average(values, weights=weight) for values in (deviation, deviation**2, outside)
        )
        rms, low, high = np.sqrt(square), deviation.min(), deviation.max()
    return Statistics(
        count=deviation.size,
        status_counts={name: int((status == name).sum()) for name in STATUSES},
        mean_mm=float(mean),
        rms_mm=float(rms),
        min_mm=float(low),
        max_mm=float(high),
        outside_count=int(outside.sum()),
        outside_share=float(share),
    )


def feature_statistics(
    points: InspectedPoints, column: Column, tolerance_mm: float
) -> dict[str, Statistics]:
    """Return the statistics of a column by feature, in order of first appearance."""
    names, first = np.unique(points.feature, return_index=True)
    return {
        str(name): column_statistics(column, tolerance_mm, among=points.feature == name)
        for name in names[np.argsort(first)]
    }


def worst_apart_mm(points: InspectedPoints) -> float:
    """Distance that two worst places of one feature keep: a round 5 % of the part's size."""
    return apart_on_part_mm(points.point_mm)


def apart_on_part_mm(point_mm: np.ndarray) -> float:
    """The same of points (P, 3) all over a part."""
    size_mm = np.linalg.norm(np.ptp(point_mm, axis=0)) if len(point_mm) else 0.0
    return nice_ceiling(max(_APART * float(size_mm), 1e-6))


def worst_places(points: InspectedPoints, column: Column, count: int = 10) -> np.ndarray:
    """Indices, (N,), of the worst places of the part, worst first, at most `count`.

    A place is the cut point of largest abs(deviation) among its neighbours: points of its feature
    within `worst_apart_mm` are not named beside it. Ties keep the order of the points, so that the
    answer is the same on every run.
    """
    cut = np.flatnonzero(column.is_cut)
    size_mm = np.abs(column.deviation_mm[cut])
    rows = worst_rows(
        points.point_mm[cut], points.feature[cut], size_mm, apart_mm=worst_apart_mm(points),
        count=count,
    )  # fmt: skip
    return cut[rows]


def worst_rows(
    point_mm: np.ndarray, feature: np.ndarray, size_mm: np.ndarray, *, apart_mm: float,
    count: int = 10,
) -> np.ndarray:  # fmt: skip
    """The same of points (C, 3) of features (C,) with sizes (C,), all of which count."""
    left, chosen = np.argsort(-size_mm, kind="stable"), []
    while left.size and len(chosen) < count:
        worst = left[0]
        chosen.append(worst)
        away_mm = np.linalg.norm(point_mm[left] - point_mm[worst], axis=1)
        near = (feature[left] == feature[worst]) & (away_mm <= apart_mm)
        left = left[~near]
    return np.array(chosen, dtype=np.int64)


def common_range_mm(columns: Sequence[Column]) -> float:
    """Return the end of the colour scale that columns share."""
    return colour_range([column.deviation_mm[column.is_cut] for column in columns])
