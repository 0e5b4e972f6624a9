"""What is known of one point, and of what one line of the program makes."""

from __future__ import annotations

from typing import Any

import numpy as np

from vmach.base.units import um_from_mm
from vmach.machine import Variant
from vmach.workbench.model.point_set import PointSet

__all__ = ["point_facts", "points_of_line"]

#: points of one line that are shown, at most
_MOST_SHOWN = 2000


def point_facts(points: PointSet, row: int) -> dict[str, Any]:
    """Where a point is, what made it, and the share of every error, um."""
    states, budget = points.states[np.array([row])], points.budget(Variant.ABBE)
    order = np.argsort(-np.abs(budget.share_mm[row]), kind="stable")
    facts = {
        "set": points.name,
        "row": row,
        "id": str(points.id[row]),
        "feature": str(points.feature[row]),
        "at_mm": points.point_mm[row].tolist(),
        "normal": points.normal[row].tolist(),
        "line": int(states.line[0]),
        "tool": int(states.tool[0]),
        "time_s": float(states.time_s[0]),
        "nose_mm": states.nose_mm[0].tolist(),
        "feed_mm_per_min": float(states.feed_mm_per_min[0]),
        "spindle_rpm": float(states.spindle_rpm[0]),
        "predicted_um": {
            str(v): float(um_from_mm(points.under(v)[row]))
            for v in (Variant.NONE, Variant.HTM, Variant.ABBE)
        },
        "shares": [
            {"source": budget.sources[k], "um": float(um_from_mm(budget.share_mm[row, k]))}
            for k in order
        ],
    }
    if points.measured_mm is not None and points.u_mm is not None:
        left = points.align(points.measured_mm - points.predicted_mm)
        facts["residual_um"] = float(um_from_mm(left[row]))
        facts["u_um"] = float(um_from_mm(points.u_mm[row]))
    return facts


def points_of_line(points: PointSet, line: int) -> tuple[dict[str, Any], np.ndarray]:
    """The points that a line of the program makes: figures, and places (N, 3) mm."""
    rows = np.flatnonzero(points.states.line == line)
    value = um_from_mm(points.predicted_mm[rows])
    figures: dict[str, Any] = {"line": line, "count": len(rows)}
    if len(rows):
        figures |= {
            "features": sorted(set(points.feature[rows].tolist())),
            "low_um": float(value.min()),
            "high_um": float(value.max()),
            "rms_um": float(np.sqrt(np.mean(value**2))),
        }
    step = max(1, -(-len(rows) // _MOST_SHOWN))
    return figures, points.point_mm[rows[::step]]
