"""A few draws cut anew: which points change their state, and how straight the rest is.

The draws go through the removal engine with a machine that has its corrections, every move of it.
What a law leaves open is new in every run and is not drawn here.

Source: JCGM 101:2008, 7.4 (the model evaluated for drawn input quantities).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.base.stage_clock import Progress, silent
from vmach.effects import Circumstances
from vmach.effects.correlated import acting_together
from vmach.machine import Variant
from vmach.nominal.points import SurfacePoints
from vmach.path.touched_zero import relative_to_zero
from vmach.prediction import Prediction, predict_surface
from vmach.uncertainty.corrections import Corrections
from vmach.uncertainty.drawn_machine import DrawnTables, drawn_steps
from vmach.uncertainty.monte_carlo import Plan
from vmach.uncertainty.points import parameters_part
from vmach.uncertainty.tables import TableUncertainty

__all__ = ["MOST_NODES", "Recut", "recut"]

#: draws that are cut anew, and programs of so many nodes at most
_DRAWS, MOST_NODES = 8, 200_000


@dataclass(frozen=True)
class Recut:
    """What happened to P points when a few draws were cut anew.

    Attributes
    ----------
    draws : int
    changed : (P,) int64
        In how many of the draws the point had another state (cut, uncut, gouged away).
    not_straight_mm : float
        Largest difference to what the other draws take for the same corrections: first order,
        and the second of the effects' parameters. Of the points that were cut in both.
    """

    draws: int
    changed: np.ndarray
    not_straight_mm: float


def recut(
    points: SurfacePoints, prediction: Prediction, plan: Plan, *, progress: Progress = silent
) -> Recut | None:
    """Cut a few draws anew; None for a program of more than `MOST_NODES` nodes.

    Parameters
    ----------
    points : SurfacePoints
    prediction : Prediction
        Of these points, without corrections.
    plan : Plan
        For its seed.
    progress : Progress
    """
    preparation = prediction.preparation
    if len(preparation.path.nodes) > MOST_NODES or prediction.variant is Variant.NONE:
        return None
    machine = preparation.job.machine
    tables = TableUncertainty.of(machine)
    changed, apart = np.zeros(len(points), dtype=np.int64), 0.0
    for draw in range(_DRAWS):
        entropy = (plan.seed, draw)
        acting = DrawnTables(machine, prediction.variant, tables, entropy)
        steps = drawn_steps(prediction.effects, entropy)
        effects = [e.with_drawn(d) for e, d in zip(prediction.effects, steps, strict=True)]
        found = predict_surface(preparation, points, prediction.variant, (*effects, acting))
        changed += found.edges.status != prediction.edges.status
        apart = max(apart, _apart(prediction, found, steps, acting))
        progress("cut anew", draw + 1, _DRAWS)
    return Recut(_DRAWS, changed, apart)


def _apart(
    before: Prediction, after: Prediction, steps: list[np.ndarray], acting: DrawnTables
) -> float:
    """Largest difference of the new cut to what the draws make of the same corrections."""
    both = before.is_cut & after.is_cut
    if not both.any():
        return 0.0
    states = before.states[both[before.is_cut]]
    normals = before.normals[both]
    path = Circumstances(states, before.preparation.job, before.variant)
    moved = states.seen_mm(relative_to_zero(path.job, states, acting.displacement))
    expected = before.deviation_mm[both] + np.einsum("ij,ij->i", normals, moved)
    drawn_of = {id(effect): drawn for effect, drawn in zip(before.effects, steps, strict=True)}
    for group in acting_together(before.effects):
        drawn = drawn_of[id(group[0])]
        part = Corrections.of([parameters_part(group, path, normals)], len(states), has_all=True)
        expected += part.values_mm(drawn[:, None])[:, 0]
    return float(np.abs(after.deviation_mm[both] - expected).max())
