"""Points that are looked at together: on the nominal surface, or where the part was measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from vmach.effects import Circumstances, EffectInstance
from vmach.job import Job
from vmach.machine import Variant
from vmach.path.toolpath import PathStates
from vmach.prediction.error_budget import ErrorBudget, budget_at
from vmach.report import DisplayMesh
from vmach.report.pictures.display_mesh import Interpolation, Neighbours

__all__ = ["PointSet"]

#: a point is looked for on faces within this angle of the one that was clicked: 45 degrees
_COSINE = 0.7
#: nearest points to look among for one on such a face
_NEAREST = 64


@dataclass(frozen=True)
class PointSet:
    """C points that a tool cut, and how it made each.

    Attributes
    ----------
    name : str
        "surface" or "measured".
    id, feature : (C,) str
    point_mm, normal : (C, 3) float64
        Nominal point and outward normal, workpiece coordinates.
    states : PathStates
        C states, with contacts and normals.
    predicted_mm : (C,) float64
        By the job as it is, with Abbe-consistent arms, without alignment.
    align : callable
        Takes off (C,) mm what the alignment takes up.
    job : Job
    effects : tuple of EffectInstance
        Those of the job.
    measured_mm, u_mm : (C,) float64, optional
        Measured deviations and their standard uncertainty.
    weight : (C,) float64, optional
        How much each point counts in means and shares; 1 for all without it.
    bare : tuple of (B, 3) float64
        Points that no tool cut and their normals; nothing is shown near them.
    kept : dict
        What was found of the points already.
    """

    name: str
    id: np.ndarray
    feature: np.ndarray
    point_mm: np.ndarray
    normal: np.ndarray
    states: PathStates
    predicted_mm: np.ndarray
    align: Callable[[np.ndarray], np.ndarray]
    job: Job
    effects: tuple[EffectInstance, ...]
    measured_mm: np.ndarray | None = None
    u_mm: np.ndarray | None = None
    weight: np.ndarray | None = None
    bare: tuple[np.ndarray, np.ndarray] = (np.zeros((0, 3)), np.zeros((0, 3)))
    kept: dict = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.id)

    def only(self, rows: np.ndarray) -> PointSet:
        """Some of the points, `rows` (C,) bool; what was aligned over all of them stays so."""
        some = {name: getattr(self, name) for name in ("measured_mm", "u_mm", "weight")}
        return replace(
            self, id=self.id[rows], feature=self.feature[rows], point_mm=self.point_mm[rows],
            normal=self.normal[rows], states=self.states[rows],
            predicted_mm=self.predicted_mm[rows], kept={},
            **{name: None if value is None else value[rows] for name, value in some.items()},
        )  # fmt: skip

    @cached_property
    def path(self) -> Circumstances:
        """What effects may depend on at the points."""
        return Circumstances(self.states, self.job)

    @cached_property
    def features(self) -> tuple[list[str], np.ndarray]:
        """Names of the features, in the order in which they appear, and the number of each point's.

        The second is (C,) int.
        """
        names, first, number = np.unique(self.feature, return_index=True, return_inverse=True)
        order = np.argsort(first)
        rank = np.empty(len(order), int)
        rank[order] = np.arange(len(order))
        return names[order].tolist(), rank[number]

    def on_mesh(self, mesh: DisplayMesh) -> Interpolation:
        """From values of the points to the vertices of a mesh."""
        points = np.vstack([self.point_mm, self.bare[0]])
        normals = np.vstack([self.normal, self.bare[1]])
        has_value = np.arange(len(points)) < len(self)
        found = Neighbours.of(points, normals, mesh).interpolation(has_value=has_value)
        return Interpolation(found.matrix[:, : len(self)].tocsr(), found.known)

    def budget(self, variant: Variant) -> ErrorBudget:
        """Shares of every source with the arms of a variant, (C, B) mm."""
        if variant not in self.kept:
            self.kept[variant] = budget_at(
                self.states, self.normal, self.predicted_mm, job=self.job,
                variant=variant, effects=self.effects,
            )  # fmt: skip
        return self.kept[variant]

    def under(self, variant: Variant) -> np.ndarray:
        """Predicted deviation (C,) mm with the arms of a variant, to first order."""
        abbe = self.budget(Variant.ABBE)
        if variant is Variant.ABBE:
            return self.predicted_mm
        if variant is Variant.NONE:
            return abbe.share_mm[:, 0]
        other = self.budget(variant).share_mm[:, 1:].sum(axis=1)
        return abbe.share_mm[:, 0] + other

    def moved_by(self, effect: EffectInstance) -> np.ndarray:
        """What an effect does to the deviations, (C,) mm.

        It is proportional to its amplitudes: those are multiplied, and the law is asked anew only
        where an inner parameter differs.
        """
        amplitudes, inner_ones = effect.effect.amplitudes, effect.effect.inner_parameters
        if len(amplitudes) + len(inner_ones) < len(effect.effect.parameters):  # some hide
            return self._displaced(effect, effect.parameters)
        inner = {p.name: effect.parameters[p.name] for p in inner_ones}
        key = (effect.effect.name, effect.target, tuple(inner.items()))
        if key not in self.kept:
            self.kept[key] = np.column_stack([
                self._displaced(effect, inner | {p.name: p.usual * (p is one) for p in amplitudes})
                for one in amplitudes
            ])  # fmt: skip
        size = [effect.parameters[p.name] / p.usual for p in amplitudes]
        return self.kept[key] @ np.array(size)

    def _displaced(self, effect: EffectInstance, parameters: Mapping) -> np.ndarray:
        return np.einsum("ij,ij->i", effect.at(self.path, parameters), self.normal)

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.point_mm)

    def nearest(self, place_mm: np.ndarray, normal: np.ndarray) -> int | None:
        """The point nearest to a place, (3,), on a face of its direction; None where none is."""
        if not len(self):
            return None
        _, rows = self._tree.query(place_mm, k=min(_NEAREST, len(self)))
        rows = np.atleast_1d(rows)
        alike = rows[self.normal[rows] @ normal > _COSINE]
        if len(alike):
            return int(alike[0])
        rows = np.flatnonzero(self.normal @ normal > _COSINE)
        away = np.linalg.norm(self.point_mm[rows] - place_mm, axis=1)
        return int(rows[np.argmin(away)]) if len(rows) else None
