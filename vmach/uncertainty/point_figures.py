"""The uncertainty of predicted points as columns of a table and as figures for programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vmach.base.note import Kind, Note
from vmach.base.stage_clock import Progress, silent
from vmach.base.units import um_from_mm
from vmach.files.csv_table import Cells, fixed, whole, words
from vmach.nominal.points import SurfacePoints
from vmach.prediction import Prediction
from vmach.uncertainty.monte_carlo import Drawn, Plan
from vmach.uncertainty.points import PointsDrawn, draw_points
from vmach.uncertainty.recut import MOST_NODES, Recut, recut

__all__ = ["PointUncertainty", "plan_figures", "point_uncertainty"]

#: contributors that are listed
_LISTED = 12


@dataclass(frozen=True)
class PointUncertainty:
    """What a Monte Carlo calculation adds to a prediction.

    Attributes
    ----------
    columns : mapping of name to Cells
        A row a point.
    figures : dict
        For JSON.
    notes : tuple of Note
    sentence : str
    """

    columns: dict[str, Cells]
    figures: dict[str, Any]
    notes: tuple[Note, ...]
    sentence: str


def point_uncertainty(
    points: SurfacePoints, prediction: Prediction, plan: Plan, *, progress: Progress = silent
) -> PointUncertainty:
    """Draw the corrections of a prediction, and cut a few draws anew."""
    found = draw_points(prediction, plan, progress=progress)
    again = recut(points, prediction, plan, progress=progress)
    return PointUncertainty(
        drawn_columns(found, prediction.is_cut, again),
        drawn_figures(found, again),
        drawn_notes(found, again, points.id),
        interval_text(plan, found.drawn),
    )


def drawn_columns(found: PointsDrawn, cut: np.ndarray, again: Recut | None) -> dict[str, Cells]:
    """Columns of a table with a row a point; empty where no tool made the surface.

    Parameters
    ----------
    found : PointsDrawn
    cut : (P,) bool
        Points that were cut.
    again : Recut or None
    """

    def spread(values: np.ndarray) -> np.ndarray:
        full = np.zeros(len(cut), values.dtype)
        full[cut] = values
        return full

    drawn = found.drawn
    columns = {
        name: fixed(spread(um_from_mm(values)), 4, shown=cut)
        for name, values in (
            ("u_drawn_um", drawn.u),
            ("low_um", drawn.low),
            ("high_um", drawn.high),
        )
    }
    if again is not None:
        columns["state_changes"] = whole(again.changed)
    labels = np.full(len(cut), "", dtype=object)
    labels[cut] = found.largest()
    return columns | {"largest_contributor": words(labels.tolist())}


def drawn_figures(found: PointsDrawn, again: Recut | None) -> dict[str, Any]:
    """The figures of a Monte Carlo calculation, as they stand in the JSON."""
    return {
        **plan_figures(found.plan, found.drawn),
        "contributors_percent": {
            label: round(100.0 * share, 2) for label, share in found.ranked()[:_LISTED]
        },
        "cut_anew": None if again is None else {
            "draws": again.draws,
            "points_that_changed_state": int((again.changed > 0).sum()),
            "largest_difference_to_straight_um": round(um_from_mm(again.not_straight_mm), 6),
        },
    }  # fmt: skip


def plan_figures(plan: Plan, drawn: Drawn) -> dict[str, Any]:
    """How it was drawn, whether it stands, and whether first order is confirmed."""
    return {
        "method": "monte-carlo",
        "coverage": plan.coverage,
        "digits": plan.digits,
        "seed": plan.seed,
        "draws": int(drawn.draws.max(initial=0)),
        "stand": int(drawn.stands.sum()),
        "do_not_stand": int((~drawn.stands).sum()),
        "first_order": {
            "confirmed": int((drawn.agrees == 1).sum()),
            "refuted": int((drawn.agrees == 0).sum()),
            "too_few_draws": int((drawn.agrees == -1).sum()),
        },
    }


def drawn_notes(
    found: PointsDrawn, again: Recut | None, ids: Sequence[str] | np.ndarray
) -> tuple[Note, ...]:
    """What to know before trusting the intervals."""
    said, drawn = [], found.drawn
    open_ = int((~drawn.stands).sum())
    if open_:
        said.append(f"{open_} of {len(drawn.stands)} intervals do not stand after "
                    f"{int(drawn.draws.max())} draws; --draws allows more")  # fmt: skip
    refuted = int((drawn.agrees == 0).sum())
    if refuted:
        said.append(f"first order (u_um) is refuted at {refuted} of {len(drawn.stands)} points: "
                    "take the drawn intervals there")  # fmt: skip
    if again is None:
        said.append(f"no draw was cut anew: that needs an error model and a program of at most "
                    f"{MOST_NODES} nodes")  # fmt: skip
    elif again.changed.any():
        which = np.asarray(ids)[again.changed > 0]
        named = ", ".join(which[:5]) + (" ..." if len(which) > 5 else "")
        said.append(f"{len(which)} points change their state in some of {again.draws} draws cut "
                    f"anew ({named}): their intervals hold only where they are cut")  # fmt: skip
    return tuple(Note.plain(Kind.UNCERTAINTY, text) for text in said)


def interval_text(plan: Plan, drawn: Drawn) -> str:
    """One sentence on the intervals."""
    if not len(drawn.u):
        return "no point was cut, so that there is no interval"
    width = um_from_mm(drawn.high - drawn.low)
    return (f"{100 * plan.coverage:g} % intervals from {int(drawn.draws.max(initial=0))} draws: "
            f"{width.min():.2f} to {width.max():.2f} um wide")  # fmt: skip
