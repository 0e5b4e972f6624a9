"""A few draws cut anew: which points change their state, and how straight the rest is.

The draws go through the removal engine with a machine that has its corrections, every move of it.
What a law leaves open is new in every run and is not drawn here.

Source: JCGM 101:2008, 7.4 (the model evaluated for drawn input quantities).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vmach.base.stage_clock import Progress, silent
from vmach.effects import Circumstances, EffectInstance
from vmach.machine import Machine, RigidDisplacement, Variant
from vmach.nominal.points import SurfacePoints
from vmach.path.toolpath import PathStates
from vmach.prediction import Prediction, predict_surface
from vmach.uncertainty.corrections import Corrections
from vmach.uncertainty.monte_carlo import Plan, stage_random
from vmach.uncertainty.points import parameters_part
from vmach.uncertainty.tables import Cause, TableUncertainty

__all__ = ["MOST_NODES", "Recut", "recut"]

#: draws that are cut anew, and programs of so many nodes at most
_DRAWS, MOST_NODES = 8, 200_000
#: states whose causes are looked at together; a thousand numbers each
_BATCH = 4000
#: no stage of the other draws has this number, so that these are draws of their own
_STAGE = 2**31


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


@dataclass(frozen=True)
class _DrawnTables:
    """The corrections of a machine's tables in one draw, as something that acts on the tool."""

    machine: Machine
    variant: Variant
    tables: TableUncertainty
    seed: tuple[int, int]
    label: str = "corrections of the tables"

    def displacement(self, states: PathStates) -> RigidDisplacement:
        """Rigid motion of the tool by the corrections."""
        total = RigidDisplacement.zero(len(states))
        for start in range(0, len(states), _BATCH):
            rows = slice(start, start + _BATCH)
            for moved in self._moved(states.nose_mm[rows], states.tool_mm[rows]):
                total.shift_mm[rows] += moved.shift_mm
                total.tilt_rad[rows] += moved.tilt_rad
        return total

    def _moved(self, nose_mm: np.ndarray, tool_mm: np.ndarray) -> Iterator[RigidDisplacement]:
        random = stage_random(*self.seed)  # the same corrections wherever they are asked for
        freedom: dict[str, float] = {}
        for cause in self.tables.causes(self.machine, nose_mm, tool_mm, self.variant):
            drawn = random.standard_normal(cause.size.shape[1])
            yield cause.moved(drawn * _widening(cause, freedom, self.seed))

    def at_surface(self, states: PathStates) -> np.ndarray:
        """Nothing: the whole tool moves."""
        return np.zeros((len(states), 3))

    def uncertainty_patterns(self, states: PathStates) -> np.ndarray:
        """Nothing is left open once it is drawn."""
        return np.zeros((len(states), 3, 0))


def _widening(cause: Cause, known: dict[str, float], seed: tuple[int, int]) -> float:
    """Factor of all corrections of a pool in one draw: its t-distribution."""
    freedom = cause.pool.degrees_of_freedom
    if not np.isfinite(freedom):
        return 1.0
    if cause.pool.name not in known:
        random = stage_random(seed[0], seed[1] + _STAGE + len(known))
        known[cause.pool.name] = float(np.sqrt(freedom / random.chisquare(freedom)))
    return known[cause.pool.name]


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
        seed = (plan.seed, _STAGE + 16 * draw)
        acting = _DrawnTables(machine, prediction.variant, tables, seed)
        steps = [_steps(e, seed, k) for k, e in enumerate(prediction.effects)]
        effects = [e.with_drawn(d) for e, d in zip(prediction.effects, steps, strict=True)]
        found = predict_surface(preparation, points, prediction.variant, (*effects, acting))
        changed += found.edges.status != prediction.edges.status
        apart = max(apart, _apart(prediction, found, steps, acting))
        progress("cut anew", draw + 1, _DRAWS)
    return Recut(_DRAWS, changed, apart)


def _steps(effect: EffectInstance, seed: tuple[int, int], number: int) -> np.ndarray:
    """Corrections of an effect's parameters in one draw, in their u; none beyond its bounds."""
    random = stage_random(seed[0], seed[1] + 2 * _STAGE + number)
    steps = random.standard_normal(len(effect.one_sigma))
    drawn = effect.with_drawn(steps)
    for p in effect.effect.parameters:
        value = np.asarray(drawn.parameters.get(p.name, p.usual), dtype=float)
        if not ((value >= p.low) & (value <= p.high)).all():
            return np.zeros_like(steps)
    return steps


def _apart(
    before: Prediction, after: Prediction, steps: list[np.ndarray], acting: _DrawnTables
) -> float:
    """Largest difference of the new cut to what the draws make of the same corrections."""
    both = before.is_cut & after.is_cut
    if not both.any():
        return 0.0
    states = before.states[both[before.is_cut]]
    normals = before.normals[both]
    path = Circumstances(states, before.preparation.job, before.variant)
    moved = states.seen_mm(acting.displacement(states))
    expected = before.deviation_mm[both] + np.einsum("ij,ij->i", normals, moved)
    for effect, drawn in zip(before.effects, steps, strict=True):
        part = Corrections.of([parameters_part(effect, path, normals)], len(states))
        expected += part.values_mm(drawn[:, None])[:, 0]
    return float(np.abs(after.deviation_mm[both] - expected).max())
