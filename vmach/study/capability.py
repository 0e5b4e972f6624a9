"""Performance of the drawn parts of a study: Pp and Ppk of everything that a drawing asks for.

The figures are those of the general geometrical method: quantiles, whatever the distribution.
They are named Pp and Ppk, not Cp and Cpk: nobody has shown that a process is stable. What scatters
are the draws of the study. That is what is not known of a machine, and no series of real parts.

Source: ISO 22514-2, performance and capability indices for any distribution by its quantiles at
0.135 %, 50 % and 99.865 %; Hyndman and Fan (1996), sample quantiles, definition 8.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from vmach.features.drawing.callout import read_callout
from vmach.features.evaluation import Requirement
from vmach.study.results import ResultFolder
from vmach.study.study import Study
from vmach.study.task import PREDICT

__all__ = ["FEWEST_DRAWS", "Performance", "performance", "study_performance"]

#: probabilities of the quantiles: 3 standard deviations either way of a normal distribution
_PROBABILITIES = (0.00135, 0.5, 0.99865)
#: fewer draws hold hardly one beyond the outer quantiles
FEWEST_DRAWS = 1000


@dataclass(frozen=True)
class Performance:
    """Indices of n values.

    Attributes
    ----------
    draws : int
    low, middle, high : float
        Quantiles at 0.135 %, 50 % and 99.865 %, in the unit of the values.
    Pp, Ppk : float or None
        None with too few draws, without scatter, and Pp without one of the two limits.
    """

    draws: int
    low: float
    middle: float
    high: float
    Pp: float | None
    Ppk: float | None


def performance(values: np.ndarray, lower: float | None, upper: float | None) -> Performance:
    """Indices of some values.

    Parameters
    ----------
    values : (n,) float64
    lower, upper : float or None
        Limits, in the unit of the values; None where there is none.
    """
    low, middle, high = np.quantile(values, _PROBABILITIES, method="median_unbiased").tolist()
    Pp = Ppk = None
    if len(values) >= FEWEST_DRAWS and low < middle < high:
        sides = [(upper - middle) / (high - middle)] if upper is not None else []
        sides += [(middle - lower) / (middle - low)] if lower is not None else []
        Ppk = min(sides, default=None)
        if upper is not None and lower is not None:
            Pp = (upper - lower) / (high - low)
    return Performance(len(values), low, middle, high, Pp, Ppk)


def study_performance(study: Study, folder: ResultFolder) -> Iterator[dict[str, Any]]:
    """Figures of every value of a drawing, over the draws of each combination of other values.

    Lengths in mm. Nothing where cases have no draws, no values of a drawing, or no results yet.

    Parameters
    ----------
    study : Study
    folder : ResultFolder
    """
    if study.task.name != PREDICT:
        return
    done = folder.done()
    found: dict[tuple[Any, ...], list[float]] = {}
    count: Counter[tuple[Any, ...]] = Counter()
    for case in study.cases:
        if "draw" not in case.values or case.key not in done:
            return
        others = tuple((k, v) for k, v in case.values.items() if k != "draw")
        count[others] += 1
        for feature, values in folder.read(case)["result"].get("value_mm", {}).items():
            for callout, value in values.items():
                found.setdefault((others, feature, callout), []).append(value)
    for (others, feature, callout), values in found.items():
        known = np.array([value for value in values if value is not None], float)
        if not known.size:
            continue
        text = callout.removesuffix(", smallest").removesuffix(", largest")
        lower, upper = Requirement(feature, read_callout(text)).limits_mm
        least = lower if np.isfinite(lower) else None
        own = performance(known, least, upper)
        yield {
            "case": dict(others), "feature": feature, "callout": callout,
            "lower_mm": least, "upper_mm": upper, "draws": own.draws,
            "not_cut": count[others] - own.draws,
            "quantiles_mm": [round(x, 9) for x in (own.low, own.middle, own.high)],
            "Pp": own.Pp, "Ppk": own.Ppk,
        }  # fmt: skip
