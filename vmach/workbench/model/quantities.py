"""What the part can be coloured by, and the figures of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vmach.base.units import um_from_mm
from vmach.errors import InputError
from vmach.machine import Variant
from vmach.report.figures.statistics import apart_on_part_mm, worst_rows
from vmach.report.pictures.colours import colour_range
from vmach.workbench.model.part_model import PartModel
from vmach.workbench.model.point_set import PointSet
from vmach.workbench.model.what_if import Change, changed_mm

__all__ = ["Quantity", "figures_of", "quantities", "values_mm"]

#: words before the name of an error source
_SHARE = "share:"


@dataclass(frozen=True)
class Quantity:
    """Something to colour the part by.

    Attributes
    ----------
    name : str
    label : str
    points : str
        Name of the set of points that it is known at.
    has_models : bool
        Whether it depends on the arms that the error model takes.
    """

    name: str
    label: str
    points: str
    has_models: bool = False


def quantities(model: PartModel) -> tuple[Quantity, ...]:
    """All that this part can be coloured by."""
    found = [Quantity("deviation", "Predicted deviation", "surface", has_models=True)]
    if model.job.measured is not None:
        found += [
            Quantity("residual", "Measured − predicted", "measured", has_models=True),
            Quantity("measured", "Measured deviation", "measured"),
        ]
    found += [
        Quantity("change", "What the sliders change", "surface"),
        Quantity("difference", "Abbe − HTM", "surface"),
        Quantity("uncertainty", "Standard uncertainty", "surface"),
    ]
    sources = model.surface.budget(Variant.ABBE).sources
    return (*found, *(Quantity(_SHARE + s, f"Share of {s}", "surface") for s in sources))


def values_mm(
    model: PartModel, name: str, variant: Variant, changes: Sequence[Change] = ()
) -> tuple[PointSet, np.ndarray]:
    """A quantity at its points: the set, and (C,) mm.

    Raises
    ------
    InputError
        There is no such quantity, or nothing was measured.
    """
    if name in ("residual", "measured"):
        points = model.point_set("measured")
        abbe = points.under(Variant.ABBE)
        if name == "measured":
            return points, abbe + points.align(points.measured_mm - abbe)
        predicted = points.under(variant) + changed_mm(points, changes)
        return points, points.align(points.measured_mm - predicted)
    points = model.surface
    if name == "deviation":
        return points, points.align(points.under(variant) + changed_mm(points, changes))
    if name == "change":
        return points, changed_mm(points, changes)
    if name == "difference":
        return points, points.under(Variant.ABBE) - points.under(Variant.HTM)
    if name == "uncertainty":
        return points, model.u_mm
    budget = points.budget(variant if variant is not Variant.NONE else Variant.ABBE)
    source = name.removeprefix(_SHARE)
    if not name.startswith(_SHARE) or source not in budget.sources:
        raise InputError(
            f"nothing to colour by is called {name!r}",
            accepted=", ".join(q.name for q in quantities(model)),
        )
    return points, budget.share_mm[:, budget.sources.index(source)]


def figures_of(points: PointSet, value_mm: np.ndarray, tolerance_mm: float) -> dict[str, Any]:
    """Figures of a quantity for the page, um: over all, by feature, the worst places, its scale."""
    order = list(dict.fromkeys(points.feature.tolist()))
    by_feature = [
        {"name": name, **_statistics(value_mm[points.feature == name], tolerance_mm)}
        for name in order
    ]
    worst = worst_rows(
        points.point_mm, points.feature, np.abs(value_mm),
        apart_mm=apart_on_part_mm(points.point_mm),
    )  # fmt: skip
    largest = float(np.abs(value_mm).max(initial=0.0))
    return {
        "points": points.name,
        "range_um": um_from_mm(colour_range([value_mm])),
        "largest_um": um_from_mm(largest),
        **_statistics(value_mm, tolerance_mm),
        "features": by_feature,
        "worst": [_place(points, value_mm, row) for row in worst],
    }


def _statistics(value_mm: np.ndarray, tolerance_mm: float) -> dict[str, float]:
    if not len(value_mm):
        return {"count": 0, "rms_um": 0.0, "mean_um": 0.0, "low_um": 0.0, "high_um": 0.0,
                "outside": 0.0}  # fmt: skip
    um = um_from_mm(value_mm)
    return {
        "count": len(um),
        "rms_um": float(np.sqrt(np.mean(um**2))),
        "mean_um": float(um.mean()),
        "low_um": float(um.min()),
        "high_um": float(um.max()),
        "outside": float(np.mean(np.abs(value_mm) > tolerance_mm)),
    }


def _place(points: PointSet, value_mm: np.ndarray, row: int) -> Mapping[str, Any]:
    return {
        "row": int(row),
        "at": points.point_mm[row].tolist(),
        "normal": points.normal[row].tolist(),
        "um": float(um_from_mm(value_mm[row])),
        "feature": str(points.feature[row]),
        "line": int(points.states.line[row]),
    }
