"""Points of the surface that a program leaves, found without its solid.

Every point of that surface lies on the envelope of some sweep, where no other sweep has taken it
away. So lines that start on the envelopes are followed to the material's edge by the exact
engine; the normal there comes from the edge on four lines beside it.

Source: Blackmore, Leu and Wang, Computer-Aided Design 29 (1997) 629; closed form derived here:
the normal is the cross product of two differences of the edge.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stock.compiled import njit_kernel
from stock.exact.edge import Edges, EdgeStatus, Material
from stock.exact.envelope import Contacts, Places, envelope_contacts, envelope_places
from stock.sweeps import Sweeps
from stock.threads import cores_to_use
from stock.tools import Tool

__all__ = ["LeftSurface", "find_left_surface"]

#: lines that are tried for every cell of space and direction
_TRIES = 4
#: distance of the lines that tell the normal, mm: far above what an edge is wrong by, 1e-12 mm,
#: and far below the radii of tools
_BESIDE_MM = 1e-3
#: what two sides of a point may say differently of the slope: beyond, an edge is between them
_SMOOTH = 0.05
#: steeper than this against its line a surface is looked at again along its own normal
_STEEP = 3.0
#: how far from its tangent plane a smooth surface may be, as a share of the margin
_IN_PLANE = 0.5
#: contacts that are held at once, about
_CONTACTS_AT_ONCE = 2_000_000
#: of a point that is not looked at
_NO_CELL = -1
#: nearer to the blank's faces no tool has cut, mm
_BLANK_MM = 1e-6


@dataclass(frozen=True)
class LeftSurface:
    """P points of the surface that sweeps leave.

    Attributes
    ----------
    point_mm, normal : (P, 3) float64
        Workpiece coordinates; outward unit normals.
    sweep : (P,) int64
        What made each point.
    """

    point_mm: np.ndarray
    normal: np.ndarray
    sweep: np.ndarray

    def __len__(self) -> int:
        return len(self.sweep)


def find_left_surface(
    sweeps: Sweeps,
    tools: Sequence[Tool],
    *,
    blank_mm: tuple[Sequence[float], Sequence[float]],
    is_cutting: np.ndarray,
    spacing_mm: float,
    margin_mm: float,
    material: Material | None = None,
) -> LeftSurface:
    """Sample the surface that sweeps without displacement leave of a blank.

    Parameters
    ----------
    sweeps : Sweeps
        All of them take material away.
    tools : sequence of Tool
    blank_mm : pair of (3,) arrays
        Least and largest corner.
    is_cutting : (M,) bool
        Sweeps whose surface is looked for.
    spacing_mm : float
        About one point in a square of this side, for each of the six main directions.
    margin_mm : float
        Points nearer to an edge of the surface are left out.
    material : Material, optional
        That of the same sweeps, tools and blank, where it is there already.

    Returns
    -------
    LeftSurface
        In the order in which the surface was made; empty where nothing is cut.
    """
    material = material or Material(sweeps, tools, blank_mm)
    box_mm = np.asarray(blank_mm[0]) + _BLANK_MM, np.asarray(blank_mm[1]) - _BLANK_MM
    places = envelope_places(sweeps, tools, is_cutting, spacing_mm=spacing_mm)
    starts = _starts(places, spacing_mm, box_mm)
    del places
    found, is_open = [], np.ones(len(starts[0].sweep), bool)
    for start in starts:
        asked = np.flatnonzero(is_open)
        there = _surface_at(material, start, asked, (spacing_mm, margin_mm))
        found.append(there[0])
        is_open[asked[there[1]]] = False
    return _thinned(found, box_mm, spacing_mm)


def _starts(places: Sequence[Places], spacing_mm: float, box_mm: tuple) -> list[Contacts]:
    """For every try a contact of every cell of space and direction, (C,) each.

    Slab after slab of the box, so that only the contacts of a few slabs are there at once.
    """
    edges = _slabs(places, spacing_mm, box_mm)
    with ThreadPoolExecutor(cores_to_use()) as pool:
        parts = list(pool.map(lambda slab: _starts_of_slab(places, spacing_mm, box_mm, slab),
                              pairwise(edges)))  # fmt: skip
    return [Contacts.joined([part[turn] for part in parts]) for turn in range(_TRIES)]


def _slabs(places: Sequence[Places], spacing_mm: float, box_mm: tuple) -> list[int]:
    """Numbers of the cells along X between which slabs lie, no narrower than a radius."""
    first, last = (int(np.floor(corner[0] / spacing_mm)) for corner in box_mm)
    most = sum(one.most_contacts(spacing_mm, box_mm) for one in places)
    reach_mm = max((one.reach_mm for one in places), default=0.0)
    narrowest = max(math.ceil(reach_mm / spacing_mm), 1)
    count = max(min(math.ceil(most / _CONTACTS_AT_ONCE), (last + 1 - first) // narrowest), 1)
    return [first + (last + 1 - first) * k // count for k in range(count + 1)]


def _starts_of_slab(
    places: Sequence[Places], spacing_mm: float, box_mm: tuple, slab: tuple[int, int]
) -> list[Contacts]:
    """For every try a contact of every cell from one number along X to before another."""
    near = [corner.copy() for corner in box_mm]
    near[0][0] = max(near[0][0], (slab[0] - 1) * spacing_mm)
    near[1][0] = min(near[1][0], (slab[1] + 1) * spacing_mm)
    contacts = envelope_contacts(places, spacing_mm, (near[0], near[1]))
    cell = _cells(contacts.point_mm, contacts.normal, spacing_mm, box_mm, slab)
    order = np.lexsort((contacts.sweep, cell))
    cell = cell[order]
    first = np.flatnonzero(np.diff(cell, prepend=_NO_CELL))  # what is in none comes before
    count = np.diff(first, append=len(cell))
    # the last sweeps of a cell first: what finishes comes after what roughs
    shares = [(count - 1) * (_TRIES - turn) // _TRIES for turn in range(_TRIES)]
    return [contacts.taken(order[first + share]) for share in shares]


def _cells(
    point_mm: np.ndarray, normal: np.ndarray, spacing_mm: float, box_mm: tuple,
    slab: tuple[int, int],
) -> np.ndarray:  # fmt: skip
    """One number for every cube of a box and main direction of the normal; none off the slab."""
    low, high = (np.floor(np.asarray(corner) / spacing_mm) for corner in box_mm)
    cell = np.empty(len(point_mm), np.int64)
    _fill_cells(cell, point_mm, normal, (spacing_mm, low, high - low + 1.0, slab))
    return cell


@njit_kernel()
def _fill_cells(cell, point, normal, grid):
    spacing, low, wide, slab = grid
    for i in range(len(cell)):
        x = math.floor(point[i, 0] / spacing)
        if not slab[0] <= x < slab[1]:
            cell[i] = _NO_CELL
            continue
        place, axis = 0, 0
        for j in range(3):
            place = place * int(wide[j]) + int(math.floor(point[i, j] / spacing) - low[j])
            if abs(normal[i, j]) > abs(normal[i, axis]):
                axis = j
        cell[i] = 6 * place + 2 * axis + (1 if normal[i, axis] > 0.0 else 0)


def _surface_at(
    material: Material, starts: Contacts, rows: np.ndarray, sizes: tuple[float, float]
) -> tuple[LeftSurface, np.ndarray]:
    """The surface next to some starts, and which of them have led to it."""
    spacing_mm, margin_mm = sizes
    point, normal = starts.point_mm[rows], starts.normal[rows]
    edges = material.edges(point, normal, spacing_mm)
    kept = np.flatnonzero(edges.status == EdgeStatus.CUT)
    sweep = edges.sweep[kept]
    point = point[kept] + edges.deviation_mm[kept, None] * normal[kept]
    normal, is_smooth = _normals(material, point, normal[kept])
    if margin_mm > 0.0:
        is_smooth &= _in_plane(material, point, normal, margin_mm)
    good = np.flatnonzero(is_smooth)
    return LeftSurface(point[good], normal[good], sweep[good]), kept[good]


def _normals(
    material: Material, point: np.ndarray, normal: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Normals of the surface at points of it, and where it has one."""
    slope, is_smooth = np.zeros((len(point), 2)), np.zeros(len(point), bool)
    for again in range(2):  # the second time where the first line is far off the normal
        rows = np.flatnonzero(is_smooth & (np.abs(slope) > 1e-3).any(axis=1)) if again else (
            np.arange(len(point)))  # fmt: skip
        sides = _tangents(normal[rows])
        height, known = _heights(material, point[rows], normal[rows], sides, _BESIDE_MM)
        slope[rows] = 0.5 * (height[:, :, 0] - height[:, :, 1]) / _BESIDE_MM
        bend = np.abs(height.sum(axis=2)).max(axis=1, initial=0.0) / _BESIDE_MM
        is_smooth[rows] = known & (bend < _SMOOTH) & (np.abs(slope[rows]) < _STEEP).all(axis=1)
        new = normal[rows] - np.einsum("ps,psi->pi", slope[rows], sides)
        new /= np.linalg.norm(new, axis=1, keepdims=True)
        normal = normal.copy()
        normal[rows] = np.where(is_smooth[rows, None], new, normal[rows])
    return normal, is_smooth


def _in_plane(
    material: Material, point: np.ndarray, normal: np.ndarray, margin_mm: float
) -> np.ndarray:
    """Where the surface goes on beside points, near their tangent planes."""
    height, known = _heights(material, point, normal, _tangents(normal), margin_mm)
    return known & (np.abs(height) <= _IN_PLANE * margin_mm).all(axis=(1, 2))


def _heights(
    material: Material, point: np.ndarray, normal: np.ndarray, sides: np.ndarray, offset_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """Height of the surface on either side in two directions, (P, 2, 2), and where it is known."""
    step = offset_mm * np.stack([sides, -sides], axis=2)  # (P, side, sign, 3)
    beside = (point[:, None, None] + step).reshape(-1, 3)
    edges: Edges = material.edges(beside, np.repeat(normal, 4, axis=0), 2.0 * _STEEP * offset_mm)
    known = (edges.status == EdgeStatus.CUT).reshape(-1, 4).all(axis=1)
    return edges.deviation_mm.reshape(-1, 2, 2), known


def _tangents(normal: np.ndarray) -> np.ndarray:
    """Two unit vectors square to every normal and to each other, (P, 2, 3)."""
    one = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal), axis=1)])
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    return np.stack([one, np.cross(normal, one)], axis=1)


def _thinned(found: Sequence[LeftSurface], box_mm: tuple, spacing_mm: float) -> LeftSurface:
    """One point a cell, in the order of the sweeps, without those on the blank's own faces."""
    point = np.concatenate([part.point_mm for part in found])
    normal = np.concatenate([part.normal for part in found])
    sweep = np.concatenate([part.sweep for part in found])
    inside = Contacts(point, normal, np.arange(len(sweep))).inside(box_mm).sweep
    point, normal, sweep = point[inside], normal[inside], sweep[inside]
    everywhere = (-(2**62), 2**62)
    cell = _cells(point, normal, spacing_mm, box_mm, everywhere)
    _, first = np.unique(cell, return_index=True)
    rows = first[np.argsort(sweep[first], kind="stable")]
    return LeftSurface(point[rows], normal[rows], sweep[rows])
