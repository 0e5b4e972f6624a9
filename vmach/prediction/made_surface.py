"""Which pass of the tool made each point of a measured surface, and at which moment.

Where several passes or moments compete for a point, as on a floor, the lowest edge wins. Which one
that is depends on all that acts, so that it is asked for again once effects are fitted.

Source: closed form derived here: the surface left is the least material of all contacts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stock import Tool
from vmach.base.alike_rows import alike_rows
from vmach.base.rows import with_rows
from vmach.machine import Variant
from vmach.path.preparation import Preparation
from vmach.path.toolpath import PathStates
from vmach.prediction.displaced_path import ActingEffect, displacement_of
from vmach.prediction.prediction import Prediction, predict

__all__ = ["FLOOR", "MadeSurface"]

#: a point so near the outermost reach of a tool's flat end may or may not be cut by it: no corner
#: is sharp, and no point is probed just where it should be
_CORNER_MM = 0.2
#: what another contact may lie away from the deepest one and still be the same surface
_SAME_MM = 0.05
#: cosine between a floor's normal and the tool axis, at least; chosen: within 2.6 degrees
FLOOR = 0.999


@dataclass(frozen=True)
class MadeSurface:
    """Measured points of a surface that the program made, P in all.

    Attributes
    ----------
    preparation : Preparation
    points_mm, normals : (P, 3) float64
        Nominal, workpiece coordinates.
    variant : Variant
    effects : tuple of ActingEffect
        Those of the model.
    """

    preparation: Preparation
    points_mm: np.ndarray
    normals: np.ndarray
    variant: Variant
    effects: tuple[ActingEffect, ...] = ()

    def __getitem__(self, rows: np.ndarray) -> MadeSurface:
        """Some of the points, (P,) bool or (R,) index."""
        return replace(self, points_mm=self.points_mm[rows], normals=self.normals[rows])

    def beside(
        self, others: Sequence[ActingEffect], *, known: PathStates
    ) -> tuple[PathStates, np.ndarray]:
        """Contacts that make the points while further effects act, and what the model says there.

        Parameters
        ----------
        others : sequence of ActingEffect
        known : PathStates
            Contacts that count for points which no pass would make.

        Returns
        -------
        states : PathStates
            One a point.
        deviation_mm : (P,) float64
            Predicted there by the model alone, without the others.
        """
        first, of = alike_rows(
            [self.points_mm, self.normals, known.move, known.parameter, known.contact_mm]
        )
        places, deviation = self[first]._beside(others, known[first])
        return places[of], deviation[of]

    def _beside(
        self, others: Sequence[ActingEffect], known: PathStates
    ) -> tuple[PathStates, np.ndarray]:
        """The same, of points none of which repeats another."""
        acting = (*self.effects, *others)
        found = self._predicted(acting)
        places, deviation = _merged(known, found), np.zeros(len(self.points_mm))
        deviation[found.is_cut] = found.deviation_mm[found.is_cut]
        deviation -= self._along_normal(places, acting) - self._along_normal(places, self.effects)
        return places, deviation

    def _predicted(self, acting: tuple[ActingEffect, ...]) -> Prediction:
        """With all that acts, points at the outermost reach of a tool's end by another contact."""
        found = self._by_tools(self.preparation, acting)
        at_corner = np.flatnonzero(found.is_cut)[self._is_at_corner(found)]
        if not len(at_corner):
            return found
        cutters = tuple(_without_corner(tool) for tool in self.preparation.cutters)
        inside = self[at_corner]._by_tools(replace(self.preparation, cutters=cutters), acting)
        return _with(found, at_corner, inside)

    def _by_tools(self, preparation: Preparation, acting: Sequence[ActingEffect]) -> Prediction:
        return predict(
            preparation,
            self.points_mm,
            self.normals,
            variant=self.variant,
            effects=acting,
            known_surface=np.ones(len(self.points_mm), dtype=bool),
        )

    def _is_at_corner(self, found: Prediction) -> np.ndarray:
        """Of the points that are cut: floors at the outermost reach of a tool's flat end."""
        states = found.states
        assert states.normal is not None
        reach = np.array([_flat_end_mm(tool) for tool in self.preparation.cutters])
        own = reach[self.preparation.tool_index[states.tool]]
        away = np.hypot(*states.contact_mm[:, :2].T)
        return (states.normal[:, 2] > FLOOR) & (own > 0.0) & (away > own - _CORNER_MM)

    def _along_normal(self, states: PathStates, effects: Sequence[ActingEffect]) -> np.ndarray:
        moved = displacement_of(self.preparation, states, self.variant, effects)
        at_contact = moved.at(states.contact_mm)
        for effect in effects:
            at_contact = at_contact + effect.at_surface(states)
        return np.einsum("ij,ij->i", at_contact, self.normals)


def _flat_end_mm(tool: Tool) -> float:
    """Radius of the flat at a tool's end, 0 where it has none that is worth a doubt."""
    ends = [corner.r_mm for corner in tool.corners if corner.z_mm - corner.radius_mm <= 0.0]
    return max(ends) if max(ends, default=0.0) > 2.0 * _CORNER_MM else 0.0


def _without_corner(tool: Tool) -> Tool:
    """The tool without what its end reaches outermost; as it is where it has no flat end."""
    if _flat_end_mm(tool) == 0.0:
        return tool
    corners = [replace(c, r_mm=max(c.r_mm - _CORNER_MM, 0.0)) for c in tool.corners]
    return replace(tool, diameter_mm=tool.diameter_mm - 2.0 * _CORNER_MM, corners=tuple(corners))


def _with(found: Prediction, rows: np.ndarray, other: Prediction) -> Prediction:
    """A prediction with some rows of another, where that is of the same surface."""
    good = other.is_cut & (np.abs(other.deviation_mm - found.deviation_mm[rows]) < _SAME_MM)
    taken, own = rows[good], np.flatnonzero(good)

    edges = replace(
        found.edges,
        **{
            name: with_rows(getattr(found.edges, name), taken, getattr(other.edges, name)[own])
            for name in ("deviation_mm", "status", "sweep", "parameter", "contact_mm")
        },
    )
    deviation = with_rows(found.deviation_mm, taken, other.deviation_mm[own])
    return replace(found, edges=edges, deviation_mm=deviation)


def _merged(known: PathStates, found: Prediction) -> PathStates:
    """Contacts that were found, and known ones for points that have none."""
    cut, new = np.flatnonzero(found.is_cut), found.states
    return replace(
        known,
        move=with_rows(known.move, cut, new.move),
        parameter=with_rows(known.parameter, cut, new.parameter),
        contact_mm=with_rows(known.contact_mm, cut, new.contact_mm),
    )
