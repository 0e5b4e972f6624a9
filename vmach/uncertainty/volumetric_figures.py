"""The uncertainty of volumetric figures, for JSON and for people."""

from __future__ import annotations

from typing import Any

from vmach.base.units import um_from_mm
from vmach.uncertainty.point_figures import plan_figures
from vmach.uncertainty.volumetric import FIGURES, AccuracyDrawn

__all__ = ["accuracy_drawn_figures"]

#: contributors that are listed
_LISTED = 12


def accuracy_drawn_figures(found: AccuracyDrawn) -> dict[str, Any]:
    """The figures of a Monte Carlo calculation, as they stand in ``accuracy.json``."""
    drawn = found.drawn

    def um(value: float) -> float:
        return round(um_from_mm(float(value)), 3)

    return {
        **plan_figures(found.plan, drawn),
        "figures": {
            f"{name}_um": {
                "stated_um": um(found.stated_mm[k]), "mean_um": um(drawn.mean[k]),
                "u_um": um(drawn.u[k]), "low_um": um(drawn.low[k]), "high_um": um(drawn.high[k]),
            }
            for k, name in enumerate(FIGURES)
        },
        "contributors_percent": {
            label: round(100.0 * share, 2)
            for label, share in list(found.share.items())[:_LISTED]
        },
        "candidates": found.candidates,
        "missed_um": um(found.missed_mm),
    }  # fmt: skip
