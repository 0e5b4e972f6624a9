"""A small program on a small machine, on which an effect of a user's own is tried."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from vmach.job import read_job
from vmach.path.circumstances import Circumstances
from vmach.path.toolpath import PathStates

__all__ = ["trial_path"]

_JOB = Path(__file__).parent / "trial"


@lru_cache(maxsize=1)
def trial_path() -> Circumstances:
    """States along two pockets, cut with two tools in two set-ups, each on a wall or a floor.

    Walls stand to the left of the motion; where there is none across Z, a floor is cut.
    """
    from vmach.path.preparation import prepare  # late: it loads the control

    job = read_job(_JOB)
    nodes = prepare(job).path.nodes
    motion = nodes.velocity_mm_per_s
    left = np.column_stack([-motion[:, 1], motion[:, 0], np.zeros(len(nodes))])
    length = np.linalg.norm(left, axis=1, keepdims=True)
    is_wall = (length[:, 0] > 1e-9) & (np.arange(len(nodes)) % 4 > 0)
    up = np.tile([0.0, 0.0, 1.0], (len(nodes), 1))
    normal = np.where(is_wall[:, None], left / np.maximum(length, 1e-9), up)
    radius = np.array([job.tools[number].diameter_mm / 2 for number in nodes.tool])
    height = np.linspace(0.0, 6.0, len(nodes)) * is_wall
    contact = np.column_stack([-radius[:, None] * normal[:, :2], height])
    states = PathStates(
        nodes.moves, nodes.tool_lengths_mm, nodes.move, nodes.parameter, contact, normal
    )
    return Circumstances(states, job)
