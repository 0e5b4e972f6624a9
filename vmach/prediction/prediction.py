"""Predicted deviation of surface points: the displaced path, swept exactly.

Source: closed form derived here: the tip stands at nominal + e, and the surface is what the tool
sweeps there; deviation = distance along the nominal normal (docs/engine.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from stock import Edges, EdgeStatus, Sweeps, find_generating
from vmach.base.rows import with_rows
from vmach.machine import RigidDisplacement, Variant
from vmach.nominal.points import SurfacePoints
from vmach.path.preparation import Preparation
from vmach.path.toolpath import PathStates
from vmach.prediction.displaced_path import ActingEffect, DisplacedPath, displacement_of

#: a tool that passes a surface point no closer than this does not generate it
GENERATING_MISS_MM = 0.05

__all__ = ["Prediction", "predict", "predict_surface"]


@dataclass(frozen=True)
class Prediction:
    """Deviations of P surface points under one error model.

    Attributes
    ----------
    variant : Variant
    preparation : Preparation
    normals : (P, 3) float64
        Outward unit normals of the points.
    deviation_mm : (P,) float64
        Positive where material is left; 0 where `is_cut` is false.
    edges : Edges
        What the removal engine found: status, sweep, parameter, contact.
    overcut : (P,) bool
        Points known to be surface which other moves of the program would have cut away; their
        deviation is that of the move which generates them.
    effects : tuple of ActingEffect
        What was taken to act beside the error tables.
    """

    variant: Variant
    preparation: Preparation
    normals: np.ndarray
    deviation_mm: np.ndarray
    edges: Edges
    overcut: np.ndarray
    effects: tuple[ActingEffect, ...] = ()

    @property
    def is_cut(self) -> np.ndarray:
        """(P,) bool: points whose surface a tool made."""
        return self.edges.status == EdgeStatus.CUT

    @cached_property
    def states(self) -> PathStates:
        """The machine's state when it made each point that is cut, in the order of the points."""
        return _contact_states(self.preparation, self.edges, self.normals)


def predict(
    preparation: Preparation,
    points_mm: np.ndarray,
    normals: np.ndarray,
    *,
    variant: Variant,
    effects: Sequence[ActingEffect] = (),
    known_surface: np.ndarray | None = None,
    sweeps: Sweeps | None = None,
    is_compensated: bool = False,
) -> Prediction:
    """Signed deviation of nominal surface points.

    Parameters
    ----------
    preparation : Preparation
    points_mm, normals : (P, 3) float64
        Nominal surface points and outward unit normals, workpiece coordinates.
    variant : Variant
        Arms of the machine's errors.
    effects : sequence of ActingEffect
        What acts beside the machine's error tables.
    known_surface : (P,) bool, optional
        Points where the real part has been found, so that a tool must have made them. Where the
        program as read would have cut them away, the move that generates the surface counts.
    sweeps : Sweeps, optional
        `displaced_sweeps` of the same variant and effects, where they are there already.
    is_compensated : bool
        The program was moved against these errors: not its own path, but the displaced one shows
        which move generates a known surface.

    Notes
    -----
    The engine sweeps the tool along the path with the displacement interpolated between the
    nodes. Where it finds the edge of the material, the displacement is then evaluated once more,
    exactly there, and the difference along the normal is added: what is left is of second order
    in the slope of the error, and effects that depend on the surface's normal enter here.
    """
    displaced = DisplacedPath(preparation, variant, tuple(effects), sweeps)
    edges = displaced.material().edges(points_mm, normals, preparation.job.inspection.reach_mm)
    overcut = np.zeros(len(points_mm), dtype=bool)
    if known_surface is not None:
        edges, overcut = _generated(
            edges, known_surface, points_mm, normals,
            displaced=displaced, is_compensated=is_compensated,
        )  # fmt: skip
    cut = np.flatnonzero(edges.status == EdgeStatus.CUT)
    states = _contact_states(preparation, edges, normals)
    at_contact = displaced.at(edges.sweep[cut], edges.parameter[cut])
    interpolated = RigidDisplacement(*at_contact).at(states.contact_mm)
    exact = displacement_of(preparation, states, variant, effects).at(states.contact_mm)
    for effect in effects:
        exact = exact + effect.at_surface(states)
    correction = exact - np.where(overcut[cut, None], 0.0, interpolated)
    deviation = edges.deviation_mm.copy()
    deviation[cut] += np.einsum("ij,ij->i", correction, normals[cut])
    return Prediction(variant, preparation, normals, deviation, edges, overcut, tuple(effects))


def predict_surface(
    preparation: Preparation,
    points: SurfacePoints,
    variant: Variant,
    effects: Sequence[ActingEffect] = (),
    *,
    sweeps: Sweeps | None = None,
    is_compensated: bool = False,
) -> Prediction:
    """Signed deviation of surface points; those found on the real part are known to be surface.

    Parameters as in `predict`; a measured point counts as found within the job's reach.
    """
    found = None
    if points.measured_mm is not None:
        found = np.abs(points.measured_deviation_mm) < preparation.job.inspection.reach_mm
    return predict(
        preparation,
        points.point_mm,
        points.normal,
        variant=variant,
        effects=effects,
        known_surface=found,
        sweeps=sweeps,
        is_compensated=is_compensated,
    )


def _generated(
    edges: Edges,
    known_surface: np.ndarray,
    points_mm: np.ndarray,
    normals: np.ndarray,
    *,
    displaced: DisplacedPath,
    is_compensated: bool,
) -> tuple[Edges, np.ndarray]:
    """Give known surface points that were gouged away the place on the path that makes them.

    The place is looked for on the path that was meant.

    Returns the edges, with deviations of the perfect path there, and which points these are.
    """
    lost = np.flatnonzero(known_surface & (edges.status == EdgeStatus.GOUGED))
    overcut = np.zeros(len(points_mm), dtype=bool)
    if lost.size == 0:
        return edges, overcut
    sweeps, tools = displaced.sweeps, displaced.preparation.cutters
    meant = _path_displaced(sweeps) if is_compensated else sweeps
    found = find_generating(points_mm[lost], normals[lost], sweeps=meant, tools=tools)
    near = found.miss_mm < GENERATING_MISS_MM
    rows = lost[near]
    overcut[rows] = True
    tips = sweeps.nominal_tip_at(found.sweep[near], found.parameter[near])
    own = np.einsum("ij,ij->i", tips + found.contact_mm[near] - points_mm[rows], normals[rows])

    return Edges(
        deviation_mm=with_rows(edges.deviation_mm, rows, own),
        status=with_rows(edges.status, rows, EdgeStatus.CUT),
        sweep=with_rows(edges.sweep, rows, found.sweep[near]),
        parameter=with_rows(edges.parameter, rows, found.parameter[near]),
        contact_mm=with_rows(edges.contact_mm, rows, found.contact_mm[near]),
    ), overcut


def _path_displaced(sweeps: Sweeps) -> Sweeps:
    """The sweeps with their ends where the displacement takes them; arcs go along on average."""
    first, last = sweeps.shift_mm[:, 0], sweeps.shift_mm[:, 1]
    return replace(
        sweeps,
        start_mm=sweeps.start_mm + first,
        end_mm=sweeps.end_mm + last,
        centre_mm=sweeps.centre_mm + 0.5 * (first + last),
    )


def _contact_states(preparation: Preparation, edges: Edges, normals: np.ndarray) -> PathStates:
    cut = np.flatnonzero(edges.status == EdgeStatus.CUT)
    return preparation.path.states_on_pieces(
        edges.sweep[cut],
        edges.parameter[cut],
        contact_mm=edges.contact_mm[cut],
        normal=normals[cut],
    )
