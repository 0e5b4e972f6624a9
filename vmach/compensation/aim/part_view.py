"""The part that a written program cuts, seen at points of its surface.

Source: the prediction of `vmach.prediction`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vmach.compensation.model import TipModel
from vmach.compensation.written_run import WrittenRun
from vmach.machine import Variant
from vmach.nominal.points import SurfacePoints
from vmach.path.preparation import Preparation
from vmach.path.toolpath import PathStates
from vmach.prediction import ActingEffect, Prediction, displacement_of, predict

__all__ = ["PartDeviation", "PartView"]

#: norm of the deviations by which programs are compared
_NORM = 12
#: so many points that are cut tell enough of a node of the path: a mill of 20 mm makes 66 of them
#: at the default spacing, one of half a metre 1,700
_POINTS_A_NODE = 100


@dataclass(frozen=True)
class PartDeviation:
    """Deviation of surface points, and what made them.

    Attributes
    ----------
    row : (Q,) int64
        Rows of the points that are cut at feed, or where a rapid takes the tool away from a cut.
    error_mm : (Q,) float64
        Along the outward normal, beyond that of the perfect program.
    tip_right_mm : (Q,) float64
        What it would be with the tool's tip in place: the share of the tool's tilt, and of the
        effects that act at the cutting edge.
    move : (Q,) int64
        Nominal moves.
    parameter : (Q,) float64
        Places on them.
    """

    row: np.ndarray
    error_mm: np.ndarray
    tip_right_mm: np.ndarray
    move: np.ndarray
    parameter: np.ndarray

    def taken(self, rows: np.ndarray) -> PartDeviation:
        """Some of the points, rows (R,) of them."""
        return PartDeviation(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))

    @property
    def largest_mm(self) -> float:
        """Largest size; 0 without points."""
        return float(np.abs(self.error_mm).max(initial=0.0))

    @property
    def mean_mm(self) -> float:
        """Mean size; 0 without points."""
        return float(np.abs(self.error_mm).mean()) if len(self.error_mm) else 0.0

    @property
    def norm_mm(self) -> float:
        """Mean that the large deviations govern."""
        if not self.largest_mm:
            return 0.0
        share = (np.abs(self.error_mm) / self.largest_mm) ** _NORM
        return self.largest_mm * float(share.mean()) ** (1.0 / _NORM)


class PartView:
    """Looks at the same points of every program, at some of them where they are very many.

    Parameters
    ----------
    preparation : Preparation
        The nominal program.
    model : TipModel
    points : SurfacePoints
    """

    def __init__(self, preparation: Preparation, model: TipModel, points: SurfacePoints) -> None:
        self.model, self.points = model, points
        everywhere = np.arange(len(points.point_mm))
        perfect = self._predicted(preparation, everywhere, Variant.NONE, ())
        made = np.flatnonzero(perfect.is_cut)
        most = _POINTS_A_NODE * len(preparation.path.nodes.move)
        self.made = made[:: max(math.ceil(len(made) / most), 1)]
        self.perfect_mm = perfect.deviation_mm[self.made]

    def deviation(self, run: WrittenRun) -> PartDeviation:
        """What a written program leaves beyond the perfect one."""
        found = self._predicted(run.again, self.made, self.model.variant, self.model.effects)
        cut = np.flatnonzero(found.is_cut)
        piece = np.full(len(run.again.path.nodes.moves), -1)
        piece[run.row] = run.written
        piece = piece[found.states.move]
        start, end = run.plan.first[piece], run.plan.last[piece]
        known = (piece >= 0) & _made_at_feed(found.states)
        beside = self._with_tip_right(run.again, found)
        return PartDeviation(
            row=self.made[cut][known],
            error_mm=(found.deviation_mm - self.perfect_mm)[cut][known],
            tip_right_mm=beside[known],
            move=run.plan.move[piece][known],
            parameter=(start + found.states.parameter * (end - start))[known],
        )

    def _with_tip_right(self, preparation: Preparation, found: Prediction) -> np.ndarray:
        """Deviations that tilt and effects at the cutting edge make at the contacts, mm."""
        model, states = self.model, found.states
        tool = displacement_of(preparation, states, model.variant, model.effects)
        moved = np.cross(tool.tilt_rad, states.contact_mm)
        for effect in model.effects:
            moved = moved + effect.at_surface(states)
        return np.einsum("ij,ij->i", moved, states.normal)

    def _predicted(
        self, preparation: Preparation, rows: np.ndarray, variant: Variant,
        effects: Sequence[ActingEffect],
    ) -> Prediction:  # fmt: skip
        return predict(preparation, self.points.point_mm[rows], self.points.normal[rows],
                       variant=variant, effects=effects)  # fmt: skip


def _made_at_feed(states: PathStates) -> np.ndarray:
    """States at feed, and at the start of rapids that follow a cut by the same tool, (P,) bool."""
    moves, move = states.moves, states.move
    feed = moves.at_feed
    before = np.maximum(move - 1, 0)
    leaves = (states.parameter == 0.0) & feed[before] & (moves.tool[before] == moves.tool[move])
    return feed[move] | leaves
