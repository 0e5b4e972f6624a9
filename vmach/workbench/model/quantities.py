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
from vmach.workbench.model.what_if import Change, MachineChange, changed_mm

__all__ = ["Quantity", "figures_of", "quantities", "values_mm"]

#: worst places that are named, and values that they are looked for among first
_WORST, _LARGEST = 10, 5000
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
    is_signed : bool
        Whether it has a direction: material left on or cut off; else it is a size.
    """

    name: str
    label: str
    points: str
    has_models: bool = False
    is_signed: bool = True


def quantities(model: PartModel) -> tuple[Quantity, ...]:
    """All that this part can be coloured by."""
    found = [Quantity("deviation", "Predicted deviation", "surface", has_models=True)]
    if model.has_measured_part:
        found += [
            Quantity("residual", "Measured − predicted", "measured", has_models=True),
            Quantity("measured", "Measured deviation", "measured"),
        ]
    found += [
        Quantity("change", "What the sliders change", "surface"),
        Quantity("difference", "Abbe − HTM", "surface"),
        Quantity("uncertainty", "Standard uncertainty", "surface", is_signed=False),
    ]
    sources = model.surface.budget(Variant.ABBE).sources
    return (*found, *(Quantity(_SHARE + s, f"Share of {s}", "surface") for s in sources))


def values_mm(
    model: PartModel, name: str, variant: Variant, changes: Sequence[Change | MachineChange] = ()
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
        predicted = points.under(variant) + changed_mm(points, changes, variant)
        return points, points.align(points.measured_mm - predicted)
    points = model.surface
    if name == "deviation":
        return points, points.align(points.under(variant) + changed_mm(points, changes, variant))
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
    names, number = points.features
    weight = np.ones(len(points)) if points.weight is None else points.weight
    everything = _statistics(value_mm, weight, np.zeros(len(points), int), 1, tolerance_mm)
    by_feature = _statistics(value_mm, weight, number, len(names), tolerance_mm)
    return {
        "points": points.name,
        "range_um": um_from_mm(colour_range([value_mm])),
        "largest_um": um_from_mm(float(np.abs(value_mm).max(initial=0.0))),
        **everything[0],
        "features": [{"name": n, **f} for n, f in zip(names, by_feature, strict=True)],
        "worst": [_place(points, value_mm, row) for row in _worst(points, value_mm)],
    }


def _statistics(
    value_mm: np.ndarray, weight: np.ndarray, group: np.ndarray, count: int, tolerance_mm: float
) -> list[dict[str, float]]:
    """Figures of every group, of which `group` (C,) has the numbers; as the reports weight them."""
    um = um_from_mm(value_mm)
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, group, um)
    np.maximum.at(high, group, um)
    points = np.bincount(group, minlength=count)

    of_group = np.bincount(group, weight, minlength=count)
    whole = np.where(points > 0, of_group, 1.0)

    def mean(values: np.ndarray) -> np.ndarray:
        return np.bincount(group, values * weight, minlength=count) / whole

    columns = {
        "count": points,
        "rms_um": np.sqrt(mean(um**2)),
        "mean_um": mean(um),
        "low_um": np.where(points, low, 0.0),
        "high_um": np.where(points, high, 0.0),
        "outside": mean((np.abs(value_mm) > tolerance_mm).astype(float)),
    }
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    return [dict(zip(columns, row, strict=True)) for row in rows]


def _worst(points: PointSet, value_mm: np.ndarray) -> np.ndarray:
    """Rows of the worst places; they are looked for among the largest values first."""
    size, apart_mm = np.abs(value_mm), apart_on_part_mm(points.point_mm)
    if len(size) > _LARGEST:
        largest = np.sort(np.argpartition(-size, _LARGEST)[:_LARGEST])
        found = _among(points, size, largest, apart_mm)
        if len(found) == _WORST:
            return found
    return _among(points, size, np.arange(len(size)), apart_mm)


def _among(points: PointSet, size: np.ndarray, rows: np.ndarray, apart_mm: float) -> np.ndarray:
    _, number = points.features
    return rows[worst_rows(points.point_mm[rows], number[rows], size[rows], apart_mm=apart_mm,
                           count=_WORST)]  # fmt: skip


def _place(points: PointSet, value_mm: np.ndarray, row: int) -> Mapping[str, Any]:
    return {
        "row": int(row),
        "at": points.point_mm[row].tolist(),
        "normal": points.normal[row].tolist(),
        "um": float(um_from_mm(value_mm[row])),
        "feature": str(points.feature[row]),
        "line": int(points.states.line[row]),
    }
