"""The tool along the program: where it is, how far off, when, on which line."""

from __future__ import annotations

from typing import Any

import numpy as np

from gcode import MoveKind
from vmach.base.units import um_from_mm
from vmach.effects import Circumstances
from vmach.machine import Variant
from vmach.prediction import displacement_of
from vmach.workbench.model.part_model import PartModel
from vmach.workbench.model.warmth import warm_states

__all__ = ["playback"]

#: nodes that are sent, at most
_MOST_NODES = 120_000
#: columns of a node
_COLUMNS = ("time_s", "x_mm", "y_mm", "z_mm", "dx_um", "dy_um", "dz_um", "line", "tool", "feed",
            "rpm")  # fmt: skip
#: and of each body that warms
_WARMTH = "warmth:{name}"


def playback(model: PartModel) -> tuple[dict[str, Any], np.ndarray]:
    """Nodes of the path: facts about them, and a row each, (K, 11 and one a warm body) float32.

    Places are those of the tip in workpiece coordinates. The feed of a rapid move is 0. Warmth is
    a share of what `WarmState.reference` says.
    """
    preparation = model.preparation
    nodes = preparation.path.nodes
    step = max(1, -(-len(nodes) // _MOST_NODES))
    nodes = nodes[np.arange(0, len(nodes), step)]
    moved = displacement_of(preparation, nodes, Variant.ABBE, model.effects)
    bodies = warm_states(model, Circumstances(nodes, model.job)) if len(nodes) else []
    rapid = nodes.moves.kind[nodes.move] == MoveKind.RAPID
    rows = np.column_stack([
        nodes.time_s,
        nodes.nose_mm + nodes.tool_mm - preparation.zero_mm,
        um_from_mm(moved.shift_mm),
        nodes.line, nodes.tool,
        np.where(rapid, 0.0, nodes.feed_mm_per_min),
        nodes.spindle_rpm,
        *(body.warmth for body in bodies),
    ])  # fmt: skip
    job = model.job
    facts = {
        "columns": [*_COLUMNS, *(_WARMTH.format(name=body.name) for body in bodies)],
        "bodies": [body.record() for body in bodies],
        "count": len(rows),
        "duration_s": float(nodes.time_s[-1]) if len(rows) else 0.0,
        "zero_mm": preparation.zero_mm.tolist(),
        "tools": {
            str(k): {"diameter_mm": tool.diameter_mm, "length_mm": tool.length_mm}
            for k, tool in job.tools.items()
        },
        "largest_um": float(np.linalg.norm(rows[:, 4:7], axis=1).max(initial=0.0)),
    }
    return facts, rows.astype(np.float32)
