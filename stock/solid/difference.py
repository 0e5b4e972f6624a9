"""Where two closed meshes are farther apart than a threshold, and which of them has the material.

Both surfaces are looked at: all their vertices and points spread evenly over their area. Between
vertices flat triangles reach no larger distance from a flat neighbour, so that small features
count however coarse the points are.

Source: closed form derived here: between vertices a flat triangle is no farther from a flat one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy  # its parts are loaded when they are first used
from manifold3d import Manifold

from stock.errors import StockError
from stock.solid.blank import blank_solid

__all__ = ["Difference", "Surface", "find_differences"]

#: points that are spread over each surface, beside its vertices
_SPREAD = 10_000

#: pieces that a surface is cut into, about, to look up what is near
_PIECES = 4_000

#: pieces whose triangles are measured to find the nearest one, and where that leaves a doubt
_NEAREST = (32, 128)

#: point-to-triangle distances that are computed at a time
_AT_ONCE = 400_000

#: points of this share of the largest depth may tell which triangles are at fault
_AS_DEEP = 0.9

#: triangles whose distances differ by less, relative, are equally near
_TIE = 1e-6

#: the plastic number, whose powers fill a triangle evenly
_PLASTIC = 1.32471795724474602596


@dataclass(frozen=True)
class Surface:
    """A closed mesh: (V, 3) float64 mm, and (T, 3) int64, counter-clockwise from outside."""

    vertices_mm: np.ndarray
    triangles: np.ndarray

    @property
    def corners_mm(self) -> np.ndarray:
        """Corners of the triangles, (T, 3, 3)."""
        return self.vertices_mm[self.triangles]


@dataclass(frozen=True)
class Difference:
    """One place where the part differs from what it should be.

    Attributes
    ----------
    depth_mm : float
        Largest distance between the surfaces: positive where material is left (excess), negative
        where too much is removed (gouge).
    point_mm : (3,) float64
        Where that is.
    low_mm, high_mm : (3,) float64
        Box around the place.
    area_mm2 : float
        Surface beyond the threshold, of the part or of the nominal, whichever is larger.
    volume_mm3 : float
        Material left or missing within the box; NaN where a mesh is no solid to the library.
    part_triangle, nominal_triangle : int
        The nearest triangles there.
    """

    depth_mm: float
    point_mm: np.ndarray
    low_mm: np.ndarray
    high_mm: np.ndarray
    area_mm2: float
    volume_mm3: float
    part_triangle: int
    nominal_triangle: int


def find_differences(part: Surface, nominal: Surface, threshold_mm: float) -> list[Difference]:
    """Places where the surfaces are more than the threshold apart, deepest first.

    The same for the same meshes, bit by bit.

    Parameters
    ----------
    part, nominal : Surface
    threshold_mm : float
        Above what the meshes themselves are off by.

    Returns
    -------
    list of Difference
        Flagged points of one sense that are neighbours make one place.
    """
    on_part = _beyond(part, nominal, threshold_mm)
    on_nominal = _beyond(nominal, part, threshold_mm)
    if not len(on_part.at) + len(on_nominal.at):
        return []
    # a point of the nominal that lies outside of the part is a gouge
    depth = np.r_[on_part.height, -on_nominal.height]
    at = np.vstack([on_part.at, on_nominal.at])
    area = np.zeros((len(depth), 2))
    area[: len(on_part.at), 0], area[len(on_part.at) :, 1] = on_part.area, on_nominal.area
    of_part = np.r_[on_part.own, on_nominal.other]
    of_nominal = np.r_[on_part.other, on_nominal.own]
    place = _places(at, depth > 0.0, 2.0 * _spacing(nominal))
    volume, found = _Volumes(part, nominal), []
    for number in range(place.max() + 1):
        here = np.flatnonzero(place == number)
        worst = here[np.argmax(np.abs(depth[here]))]
        # at an edge several triangles are the nearest: a point within a triangle knows its own
        deep = here[np.abs(depth[here]) >= _AS_DEEP * abs(depth[worst])]
        within = deep[area[deep, 0] > 0.0]
        knows = within[np.argmax(np.abs(depth[within]))] if within.size else worst
        low, high = at[here].min(axis=0), at[here].max(axis=0)
        found.append(
            Difference(
                depth_mm=float(depth[worst]),
                point_mm=at[worst],
                low_mm=low,
                high_mm=high,
                area_mm2=float(area[here].sum(axis=0).max()),
                volume_mm3=volume.within(
                    low - threshold_mm, high + threshold_mm, excess=depth[worst] > 0.0
                ),
                part_triangle=int(of_part[knows]),
                nominal_triangle=int(of_nominal[knows]),
            )
        )
    return sorted(found, key=lambda one: -abs(one.depth_mm))


class _Volumes:
    """Material that only one of the two solids has."""

    def __init__(self, part: Surface, nominal: Surface) -> None:
        one, other = _solid(part), _solid(nominal)
        self._excess = None if one is None or other is None else one - other
        self._gouge = None if one is None or other is None else other - one

    def within(self, low_mm: np.ndarray, high_mm: np.ndarray, *, excess: bool) -> float:
        """Volume of the excess or of the gouge in a box with corners (3,) mm, in mm3."""
        solid = self._excess if excess else self._gouge
        if solid is None:
            return float("nan")
        box = Manifold.cube(tuple(high_mm - low_mm)).translate(tuple(low_mm))
        return float((solid ^ box).volume())


def _solid(surface: Surface) -> Manifold | None:
    try:
        return blank_solid(_Mesh(surface.vertices_mm, surface.triangles))
    except StockError:
        return None


class _Mesh(NamedTuple):
    vertices: np.ndarray
    faces: np.ndarray


def _areas(corners: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(corners, 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0


def _spacing(surface: Surface) -> float:
    """Mean distance of the points that are spread over a surface."""
    return float(np.sqrt(_areas(surface.corners_mm).sum() / _SPREAD))


def _samples(surface: Surface) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (P, 3), the triangle of each (P,), and the area that each stands for (P,)."""
    corners = surface.corners_mm
    sizes = np.cumsum(_areas(corners))
    each = sizes[-1] / _SPREAD
    triangle = np.searchsorted(sizes, (np.arange(_SPREAD) + 0.5) * each)
    triangle = np.minimum(triangle, len(corners) - 1)
    s, t = np.modf(np.outer([1 / _PLASTIC, 1 / _PLASTIC**2], np.arange(1, _SPREAD + 1)))[0]
    s, t = np.where(s + t > 1.0, [1.0 - s, 1.0 - t], [s, t])
    a, b, c = np.moveaxis(corners[triangle], 1, 0)
    spread = a + s[:, None] * (b - a) + t[:, None] * (c - a)
    vertex, first = np.unique(surface.triangles.ravel(), return_index=True)
    return (
        np.vstack([surface.vertices_mm[vertex], spread]),
        np.r_[first // 3, triangle],
        np.r_[np.zeros(len(vertex)), np.full(_SPREAD, each)],
    )


@dataclass(frozen=True)
class _Flagged:
    """Points of one surface beyond the threshold: signed height over the other, triangles."""

    at: np.ndarray
    height: np.ndarray
    area: np.ndarray
    own: np.ndarray
    other: np.ndarray


def _beyond(surface: Surface, other: Surface, threshold_mm: float) -> _Flagged:
    """Points of a surface that are farther than the threshold from the other one."""
    at, own, area = _samples(surface)
    near = _Nearness(other)
    far = np.flatnonzero(near.is_farther(at, threshold_mm))
    height, triangle = near.height(at[far])
    # the nearest of many triangles may be nearer than the few that were asked first
    beyond = np.abs(height) > threshold_mm
    far = far[beyond]
    return _Flagged(at[far], height[beyond], area[far], own[far], triangle[beyond])


class _Nearness:
    """Distances to a surface, by a tree over the pieces that its triangles are cut into."""

    def __init__(self, surface: Surface) -> None:
        self._corners = surface.corners_mm
        area = _areas(self._corners).sum()
        self._limit = float(np.sqrt(2.0 * area / _PIECES))
        pieces, self._triangle = _cut_small(self._corners, self._limit)
        self._tree = scipy.spatial.cKDTree(pieces.mean(axis=1))

    @property
    def _cover(self) -> float:
        """Every point of a piece is nearer than this to its centre."""
        return 2.0 / 3.0 * self._limit

    def is_farther(self, points: np.ndarray, distance_mm: float) -> np.ndarray:
        """(P,) bool: points with no triangle within the distance. Never wrong."""
        waiting = np.arange(len(points))
        for count in (1, 4, 16):
            _, piece = self._tree.query(points[waiting], k=[*range(1, count + 1)])
            away = self._distances(points[waiting], self._of(piece))[0].min(axis=1)
            waiting = waiting[away > distance_mm]
        reach = distance_mm + self._cover
        centre = self._tree.query(points[waiting])[0]
        farther = np.zeros(len(points), dtype=bool)
        farther[waiting[centre > reach]] = True
        for row in waiting[centre <= reach]:
            piece = self._tree.query_ball_point(points[row], reach)
            triangle = np.unique(self._triangle[piece])[None]
            farther[row] = self._distances(points[row : row + 1], triangle)[0].min() > distance_mm
        return farther

    def height(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Signed distance, positive outside, and the nearest triangle, (P,) each.

        Of several equally near triangles, at an edge or a corner, the one that faces the point
        most tells the side.
        """
        height, nearest = np.zeros(len(points)), np.zeros(len(points), dtype=np.int64)
        waiting = np.arange(len(points))
        for count in _NEAREST:
            if not len(waiting):
                break
            centre, piece = self._tree.query(points[waiting], k=[*range(1, count + 1)])
            triangle = self._of(piece)
            away, facing = self._distances(points[waiting], triangle)
            least = away.min(axis=1, keepdims=True)
            tied = away <= least * (1.0 + _TIE) + _TIE
            best = np.argmax(np.where(tied, np.abs(facing), -1.0), axis=1)
            rows = np.arange(len(waiting))
            side = np.where(facing[rows, best] < 0.0, -1.0, 1.0)
            height[waiting], nearest[waiting] = side * least[:, 0], triangle[rows, best]
            waiting = waiting[centre[:, -1] < least[:, 0] + self._cover]
        return height, nearest

    def _of(self, piece: np.ndarray) -> np.ndarray:
        return self._triangle[np.minimum(piece, len(self._triangle) - 1)]

    def _distances(self, points: np.ndarray, triangle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance (P, K) to K triangles each, and the cosine between normal and offset."""
        away, facing = np.empty(triangle.shape), np.empty(triangle.shape)
        rows = max(_AT_ONCE // triangle.shape[1], 1)
        for start in range(0, len(points), rows):
            some = slice(start, start + rows)
            corners = self._corners[triangle[some]]
            offset = points[some, None] - _closest(points[some, None], corners)
            normal = np.cross(corners[..., 1, :] - corners[..., 0, :],
                              corners[..., 2, :] - corners[..., 0, :])  # fmt: skip
            away[some] = np.linalg.norm(offset, axis=2)
            size = np.linalg.norm(normal, axis=2) * away[some]
            facing[some] = np.einsum("pki,pki->pk", offset, normal) / np.maximum(size, 1e-300)
        return away, facing


def _closest(point: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Nearest point of each triangle (..., 3, 3) to the points (..., 3)."""
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    u, v, w = b - a, c - a, point - a
    uu, uv, vv = (np.einsum("...i,...i->...", x, y) for x, y in ((u, u), (u, v), (v, v)))
    wu, wv = (np.einsum("...i,...i->...", w, x) for x in (u, v))
    squared = uu * vv - uv * uv
    safe = np.where(squared > 1e-14 * uu * vv, squared, np.inf)
    s, t = (vv * wu - uv * wv) / safe, (uu * wv - uv * wu) / safe
    inside = np.isfinite(safe) & (s >= 0.0) & (t >= 0.0) & (s + t <= 1.0)
    best = a + s[..., None] * u + t[..., None] * v
    nearest = np.where(inside, 0.0, np.inf)
    for start, along in ((a, u), (a, v), (b, c - b)):
        length = np.maximum(np.einsum("...i,...i->...", along, along), 1e-300)
        share = np.clip(np.einsum("...i,...i->...", point - start, along) / length, 0.0, 1.0)
        on_edge = start + share[..., None] * along
        squared = np.einsum("...i,...i->...", point - on_edge, point - on_edge)
        nearer = ~inside & (squared < nearest)
        best = np.where(nearer[..., None], on_edge, best)
        nearest = np.where(nearer, squared, nearest)
    return best


def _cut_small(corners: np.ndarray, limit_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Pieces (N, 3, 3) of triangles with no side above the limit, and whose each is (N,)."""
    done, owners = [], []
    owner = np.arange(len(corners))
    while len(corners):
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        small = sides.max(axis=1) <= limit_mm
        done.append(corners[small])
        owners.append(owner[small])
        corners, owner, longest = corners[~small], owner[~small], sides[~small].argmax(axis=1)
        rows = np.arange(len(corners))
        a, b, c = (corners[rows, (longest + i) % 3] for i in range(3))
        middle = (a + b) / 2.0
        corners = np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
        owner = np.r_[owner, owner]
    return np.concatenate(done), np.concatenate(owners)


def _places(points: np.ndarray, kind: np.ndarray, cell_mm: float) -> np.ndarray:
    """Number of the place of each point: points of a kind in cells that touch are one place."""
    cells = np.column_stack([np.floor(points / cell_mm), 3.0 * kind])
    cells, cell = np.unique(cells, axis=0, return_inverse=True)
    touching = 1.8  # in cells: more than the root of 3, less than 2 and than the step of kinds
    pairs = scipy.spatial.cKDTree(cells).query_pairs(touching, output_type="ndarray")
    graph = scipy.sparse.coo_array(
        (np.ones(len(pairs)), tuple(pairs.T)), shape=(len(cells), len(cells))
    )
    return scipy.sparse.csgraph.connected_components(graph, directed=False)[1][cell.reshape(-1)]
