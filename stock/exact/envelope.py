"""Where tools may leave surface: points of them that graze along their way, or end it.

The boundary of a swept tool is made by the tool's points whose outward normal is square to the
motion. Where the motion ends or turns, it is also made by those that look ahead before and not
after [1]_.

.. [1] Blackmore, Leu, Wang: The sweep-envelope differential equation algorithm and its
   application to NC machining verification, Computer-Aided Design 29 (1997) 629, section 2.

Source: [1]_; closed form derived here for polylines of the outline.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stock.compiled import njit_inlined, njit_maker
from stock.exact.outline import outline_places
from stock.sweeps import Sweeps
from stock.tools import Tool

__all__ = ["Contacts", "Places", "envelope_contacts", "envelope_places"]

#: a turn of the way by more than this leaves more than a line of the tool's own surface
_TURN_COS = math.cos(math.radians(10.0))
#: the points of the tool are moved by these parts of their distance from place to place, so that
#: narrow surface, as between the passes of a raster, is seen all across
_PHASES = (0.5, 0.1, 0.7, 0.3, 0.9)
#: a component of a unit vector that is smaller is none
_LEVEL = 1e-9
#: rounding of the product of two unit vectors
_LOOKS = 1e-9
#: so many places of those that are near each other and go the same way are looked at
_OF_A_KIND = 3
#: fewest places around a tool where its whole surface counts
_AROUND = 12
#: step of the parameter for the direction of the way
_STEP = 1e-4


class Contacts(NamedTuple):
    """K points of tools at places of their way.

    Attributes
    ----------
    point_mm : (K, 3) float64
        Workpiece coordinates, without displacement.
    normal : (K, 3) float64
        Unit vectors into the tool: outward normals of the surface that it leaves there.
    sweep : (K,) int64
    """

    point_mm: np.ndarray
    normal: np.ndarray
    sweep: np.ndarray

    def inside(self, box_mm: tuple[np.ndarray, np.ndarray]) -> Contacts:
        """Those inside a box of two corners (3,), off its faces."""
        low, high = box_mm
        kept = ((self.point_mm > low) & (self.point_mm < high)).all(axis=1)
        return self.taken(kept)

    def taken(self, rows: np.ndarray) -> Contacts:
        """Some of them, by index or mask."""
        return Contacts(*(column[rows] for column in self))

    @classmethod
    def joined(cls, parts: list[Contacts]) -> Contacts:
        """Several of them as one; `parts` is emptied, as they take much memory together."""
        if not parts:
            return cls(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, np.int64))
        columns = [list(column) for column in zip(*parts, strict=True)]
        parts.clear()
        return cls(*(np.concatenate(columns.pop(0)) for _ in cls._fields))


class Places(NamedTuple):
    """P places of one tool's way where some places of its outline may leave surface.

    Attributes
    ----------
    sweep : (P,) int64
    tip_mm : (P, 3) float64
    before, behind : (P, 3) float64
        Unit vectors of the way towards the place and on from it; zero where the tool stands.
    outline : (K, 4) float64
        As of `outline_places`.
    is_end : bool
        The way ends or turns there; else it goes on as it came.
    """

    sweep: np.ndarray
    tip_mm: np.ndarray
    before: np.ndarray
    behind: np.ndarray
    outline: np.ndarray
    is_end: bool

    @property
    def reach_mm(self) -> float:
        """How far the outline is from the tool's axis."""
        return float(self.outline[:, 0].max(initial=0.0))

    def most_contacts(self, spacing_mm: float, box_mm: tuple[np.ndarray, np.ndarray]) -> int:
        """At most so many points, but for those of a tool that goes along its axis."""
        height, at = np.sort(self.tip_mm[:, 2]), self.outline[:, 1]
        first, stop = (np.searchsorted(height, corner[2] - at) for corner in box_mm)
        around = _count_around(self.outline[:, 0], spacing_mm) if self.is_end else 2
        return int(((stop - first) * around).sum())

    def contacts(self, spacing_mm: float, box_mm: tuple[np.ndarray, np.ndarray]) -> list[Contacts]:
        """Points inside a box of two corners (3,), in steps of the spacing around the tool."""
        x, reach_mm = self.tip_mm[:, 0], self.reach_mm + spacing_mm
        near = np.flatnonzero((x > box_mm[0][0] - reach_mm) & (x < box_mm[1][0] + reach_mm))
        here = self
        if len(near) < len(x):
            columns = (self.sweep, self.tip_mm, self.before, self.behind)
            here = Places(*(column[near] for column in columns), self.outline, self.is_end)
        return (_ending if self.is_end else _grazing)(here, spacing_mm, box_mm)


def envelope_places(
    sweeps: Sweeps, tools: Sequence[Tool], is_cutting: np.ndarray, *, spacing_mm: float
) -> list[Places]:
    """Where tools may leave surface, in steps of about half the spacing along the way.

    Parameters
    ----------
    sweeps : Sweeps
        Only their nominal geometry counts.
    tools : sequence of Tool
        What ``sweeps.tool`` counts in.
    is_cutting : (M,) bool
        Sweeps that are looked at.
    spacing_mm : float
        Distance of the points on the tools.
    """
    along, ends = [], []
    for number, tool in enumerate(tools):
        rows = np.flatnonzero(is_cutting & (sweeps.tool == number))
        if not len(rows):
            continue
        sweep, tip, way = _along(sweeps, rows, 0.5 * spacing_mm)
        for turn, phase in enumerate(_PHASES):
            part = slice(turn, None, len(_PHASES))
            outline = outline_places(tool, spacing_mm, phase)
            along.append(Places(sweep[part], tip[part], way[part], way[part], outline, False))
        ends.append(Places(*_turns(sweeps, rows, is_cutting, 0.5 * spacing_mm),
                           outline_places(tool, spacing_mm), True))  # fmt: skip
    return along + ends


def envelope_contacts(
    places: Sequence[Places], spacing_mm: float, box_mm: tuple[np.ndarray, np.ndarray]
) -> Contacts:
    """Tool points that may leave surface inside a box of two corners (3,)."""
    return Contacts.joined([part for one in places for part in one.contacts(spacing_mm, box_mm)])


def _along(
    sweeps: Sweeps, rows: np.ndarray, step_mm: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sweep, tip and way in equal steps of the way along `rows`, a few in any one place."""
    chord = np.linalg.norm(sweeps.end_mm[rows] - sweeps.start_mm[rows], axis=1)
    radius = np.linalg.norm(sweeps.start_mm[rows] - sweeps.centre_mm[rows], axis=1)
    length = np.maximum(chord, radius * np.abs(sweeps.sweep_rad[rows]))
    end = np.cumsum(length)
    total = float(end[-1]) if len(end) else 0.0
    way = (np.arange(max(math.ceil(total / step_mm), 1)) + 0.5) * step_mm
    way = way[way < total] if total > 0.5 * step_mm else np.array([0.5 * total])
    index = np.minimum(np.searchsorted(end, way), len(rows) - 1)
    parameter = 1.0 - (end[index] - way) / np.maximum(length[index], 1e-300)
    sweep, parameter = rows[index], np.clip(parameter, 0.0, 1.0)
    tip, way = sweeps.nominal_tip_at(sweep, parameter), _way(sweeps, sweep, parameter)
    kept = _spread(tip, way, step_mm)
    return sweep[kept], tip[kept], way[kept]


def _spread(tip_mm: np.ndarray, ways: np.ndarray, side_mm: float) -> np.ndarray:
    """A few of the places that are near each other and go the same way, in their order.

    The passes of a fine raster are many times as near as the points that are looked for.
    """
    if not len(tip_mm):
        return np.zeros(0, np.int64)
    kind = np.hstack([np.floor(tip_mm / side_mm), np.rint(ways)]).astype(np.int64)
    kind -= kind.min(axis=0)
    number = np.zeros(len(kind), np.int64)
    for column in kind.T:
        number = number * (int(column.max()) + 1) + column
    order = np.argsort(number, kind="stable")
    _, first, count = np.unique(number[order], return_index=True, return_counts=True)
    shares = (np.arange(_OF_A_KIND)[:, None] * (count - 1)) // (_OF_A_KIND - 1)
    return np.sort(order[np.unique((first + shares).ravel())])


def _way(sweeps: Sweeps, sweep: np.ndarray, parameter: np.ndarray) -> np.ndarray:
    """Unit vectors of the way; zero where the tool stands."""
    first = np.minimum(parameter, 1.0 - _STEP)
    step = sweeps.nominal_tip_at(sweep, first + _STEP) - sweeps.nominal_tip_at(sweep, first)
    length = np.linalg.norm(step, axis=1, keepdims=True)
    return np.divide(step, length, out=np.zeros_like(step), where=length > 0.0)


def _grazing(
    places: Places, spacing_mm: float, box_mm: tuple[np.ndarray, np.ndarray]
) -> list[Contacts]:
    """Points of the tool whose normal is square to its way."""
    sweep, tip, way = places.sweep, places.tip_mm, places.behind
    level = np.hypot(way[:, 0], way[:, 1])
    towards = np.arctan2(way[:, 1], way[:, 0])
    parts = []
    for r, z, u_r, u_z in places.outline:
        high = (tip[:, 2] + z > box_mm[0][2]) & (tip[:, 2] + z < box_mm[1][2])
        if not high.any():
            continue
        if abs(u_r) < _LEVEL:  # the level bottom of a tool that goes level
            rows = np.flatnonzero(high & (np.abs(way[:, 2]) < _LEVEL) & (level > 0.0))
            off = np.full(len(rows), 0.5 * math.pi)
        else:
            with np.errstate(divide="ignore", invalid="ignore"):
                cosine = -u_z * way[:, 2] / (u_r * level)
            rows = np.flatnonzero(high & (np.abs(cosine) <= 1.0) & (level > _LEVEL))
            off = np.arccos(cosine[rows])
        for side in (-1.0, 1.0):
            azimuth = towards[rows] + side * off
            found = _contacts(tip[rows], azimuth, (r, z, u_r, u_z), sweep[rows])
            parts.append(found.inside(box_mm))
        if abs(u_z) < _LEVEL:  # all around a tool that goes along its axis
            rows = np.flatnonzero(high & (level <= _LEVEL) & (np.abs(way[:, 2]) > 0.0))
            count = max(_AROUND, math.ceil(2 * math.pi * r / spacing_mm))
            azimuth = np.tile(2 * math.pi * np.arange(count) / count, len(rows))
            rows = np.repeat(rows, count)
            found = _contacts(tip[rows], azimuth, (r, z, u_r, u_z), sweep[rows])
            parts.append(found.inside(box_mm))
    return parts


def _turns(
    sweeps: Sweeps, rows: np.ndarray, is_cutting: np.ndarray, side_mm: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Sweep, tip, way before and behind of ends of `rows` where the way ends or turns."""
    here = np.concatenate([rows, rows])
    parameter = np.repeat([0.0, 1.0], len(rows))
    before = np.where(parameter == 0.0, here - 1, here)
    coming, going = _way_of(sweeps, before, 1.0), _way_of(sweeps, before + 1, 0.0)
    turns = np.einsum("ij,ij->i", coming, going) < _TURN_COS
    # the end of a sweep and the start of the next are one place
    other = np.clip(before, 0, len(sweeps) - 1)
    turns &= (parameter == 1.0) | (before < 0) | ~is_cutting[other]
    turns = np.flatnonzero(turns)
    tip = sweeps.nominal_tip_at(here[turns], parameter[turns])
    kept = _spread(tip, np.hstack([coming[turns], going[turns]]), side_mm)
    turns = turns[kept]
    return here[turns], tip[kept], coming[turns], going[turns]


def _ending(
    places: Places, spacing_mm: float, box_mm: tuple[np.ndarray, np.ndarray]
) -> list[Contacts]:
    """Points of the tool that look ahead where the way ends or turns, and not behind."""
    z = places.tip_mm[:, 2]
    at = places.outline[:, 1]
    seen = (z.max(initial=-np.inf) + at > box_mm[0][2]) & (
        z.min(initial=np.inf) + at < box_mm[1][2]
    )
    outline = places.outline[seen]
    count = _count_around(outline[:, 0], spacing_mm)
    azimuth = [2 * math.pi * np.arange(n) / n for n in count.tolist()]
    around = np.concatenate([np.zeros(0), *azimuth])
    circle = np.column_stack([np.cos(around), np.sin(around)])
    first = np.concatenate([[0], np.cumsum(count)])
    found = _look_ahead(places[:4], outline, first, circle, np.array(box_mm))
    return [Contacts(*found)]


@njit_maker()
def _look_ahead(places, outline, first, circle, box):
    """Point, normal and sweep of what looks ahead and not behind, by outline, place and azimuth."""
    count = 0
    for k in range(len(outline)):
        for i in range(len(places[0])):
            for a in range(first[k], first[k + 1]):
                count += _contact(places, i, outline[k], circle[a], box)[0]
    point, normal = np.empty((count, 3)), np.empty((count, 3))
    sweep, row = np.empty(count, np.int64), 0
    for k in range(len(outline)):
        for i in range(len(places[0])):
            for a in range(first[k], first[k + 1]):
                is_contact, p, n = _contact(places, i, outline[k], circle[a], box)
                if is_contact:
                    for j in range(3):
                        point[row, j], normal[row, j] = p[j], n[j]
                    sweep[row] = places[0][i]
                    row += 1
    return point, normal, sweep


@njit_inlined()
def _contact(places, i, at, azimuth, box):
    """Whether the point of place i at an azimuth is one, and point and normal."""
    _, tip, before, behind = places
    p = (tip[i, 0] + at[0] * azimuth[0], tip[i, 1] + at[0] * azimuth[1], tip[i, 2] + at[1])
    n = (-(at[2] * azimuth[0]), -(at[2] * azimuth[1]), -at[3])
    is_inside = True
    for j in range(3):
        is_inside &= box[0, j] < p[j] < box[1, j]
    ahead = before[i, 0] * n[0] + before[i, 1] * n[1] + before[i, 2] * n[2]
    on = behind[i, 0] * n[0] + behind[i, 1] * n[1] + behind[i, 2] * n[2]
    return is_inside and ahead <= _LOOKS and on >= -_LOOKS, p, n


def _count_around(radius_mm: np.ndarray, spacing_mm: float) -> np.ndarray:
    """How many points a tool has around its axis at radii, (K,) int64."""
    return np.maximum(_AROUND, np.ceil(2 * math.pi * radius_mm / spacing_mm)).astype(np.int64)


def _way_of(sweeps: Sweeps, sweep: np.ndarray, parameter: float) -> np.ndarray:
    """Way at one end of sweeps; zero for numbers that are none, and where the tool stands."""
    inside = np.flatnonzero((sweep >= 0) & (sweep < len(sweeps)))
    found = np.zeros((len(sweep), 3))
    found[inside] = _way(sweeps, sweep[inside], np.full(len(inside), parameter))
    return found


def _contacts(
    tip: np.ndarray, azimuth: np.ndarray, place: tuple[float, float, float, float],
    sweep: np.ndarray,
) -> Contacts:  # fmt: skip
    """Points at azimuths of the circle that one place of the outline describes."""
    r, z, u_r, u_z = place
    cos, sin = np.cos(azimuth), np.sin(azimuth)
    point = tip + np.column_stack([r * cos, r * sin, np.full(len(tip), z)])
    normal = -np.column_stack([u_r * cos, u_r * sin, np.full(len(tip), u_z)])
    return Contacts(point, normal, sweep)
