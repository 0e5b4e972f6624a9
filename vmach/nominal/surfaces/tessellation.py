"""Triangles to look at for exact faces: closed, and about as near to them as the edges' chords.

Source: J. Ruppert, J. Algorithms 18 (1995) 548 (edges split until Delaunay triangles follow
them); closed form derived here: chord error h^2 kappa / 8.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from vmach.errors import InputError
from vmach.nominal.mesh.thinning import near_segments
from vmach.nominal.mesh.unique_rows import unique_rows
from vmach.nominal.step.solids import CHORD_MM, GAP_MM, Edge, Solid, SolidFace
from vmach.nominal.surfaces import Cone, Plane, Sphere, Surface, unit_normals
from vmach.nominal.surfaces.crowding import crowded_segments
from vmach.nominal.surfaces.curved_triangles import volume_under_mm3
from vmach.nominal.surfaces.delaunay import centres, delaunay
from vmach.nominal.surfaces.face import sample_uv
from vmach.nominal.surfaces.trimming import Trim, is_pole

__all__ = ["tessellate"]

#: triangles may be this much longer along a flat direction than across the bend
_STRETCH = 20.0

#: so often edges are split; each pass halves what is still crowded
_PASSES = 12

#: edges that cross are never apart, however finely they are cut
_MOST_PIECES = 20_000

#: how far points are moved to tell triangulations of equal quality apart, relative to all
_SHAKE = 1e-8


def tessellate(
    solid: Solid,
) -> tuple[list[tuple[SolidFace, Trim, np.ndarray, np.ndarray, float]], float]:
    """Each face with its trim, vertices (V, 3) mm, triangles (T, 3) and share of the volume, mm3.

    Also how far edges lie off the faces' surfaces at most, mm.

    The shares are those of the surfaces themselves, not of the triangles: see `volume_under_mm3`.

    Triangles run counter-clockwise about dS/du x dS/dv. Vertices on an edge are the same, bit
    by bit, for both faces that meet there. A face whose normal contradicts its edges, as some
    CAD systems write them, is returned with the side that the edges say.

    Raises
    ------
    InputError
        Edges that lie off the surface of their face, or do not bound it.
    """
    faces, patches, gap_mm = [], [], 0.0
    for face in solid.faces:
        trim = _trim(solid.edges, face, face.surface)
        gap_mm = max(gap_mm, _checked_gap_mm(trim, len(faces) + 1))
        if trim.inside_out():
            face, trim = face.turned(), trim.turned()
        if not np.isfinite([trim.v_range(), trim.transposed().v_range()]).all():
            raise InputError(
                f"face {len(faces) + 1}: its edges do not bound it on its surface",
                accepted="closed loops of edges, each on the surface",
                hint="repair the solid in the CAD system and export it again",
            )
        faces.append(face)
        patches.append(_Patch.of(trim))
    edges, patches = _conforming(replace(solid, faces=tuple(faces)), patches)
    origin = next((edge.points_mm[0] for edge in edges.values()), np.zeros(3))
    found = []
    for face, patch in zip(faces, patches, strict=True):
        vertices, triangles, middles = patch.triangles(_middles(edges, face))
        share = volume_under_mm3(vertices[triangles] - origin, middles - origin)
        found.append((face, patch.trim, vertices, triangles, share))
    return found, gap_mm


def _checked_gap_mm(trim: Trim, number: int) -> float:
    gap_mm = trim.gap_mm()
    if not gap_mm <= GAP_MM:
        raise InputError(
            f"face {number}: its edges lie up to {gap_mm:.3g} mm off its {trim.surface.label}",
            accepted=f"at most {GAP_MM} mm",
            hint="the surface or the edges are damaged; export the CAD again",
        )
    return gap_mm


def _middles(edges: dict[int, Edge], face: SolidFace) -> np.ndarray:
    """Points of the edges' curves in the middle of the segments of a face, (S, 3) mm."""
    found = [np.empty((0, 3))]
    for number, left in face.edges:
        t = edges[number].t
        points = edges[number].curve.evaluate((t[:-1] + t[1:]) / 2.0)
        found.append(points if left else points[::-1])
    return np.vstack(found)


def _trim(edges: dict[int, Edge], face: SolidFace, surface: Surface) -> Trim:
    """The face's edges on its surface.

    A sphere's poles are turned away from them, and of a cone it is the half that they lie on.
    """
    lines = [
        edges[number].points_mm if left else edges[number].points_mm[::-1]
        for number, left in face.edges
    ]
    if surface is face.surface and isinstance(surface, Sphere) and lines:
        surface = surface.away_from(np.vstack(lines))
    if surface is face.surface and isinstance(surface, Cone) and lines:
        surface = surface.on_the_side_of(np.vstack(lines))
    return Trim.from_polylines(surface, lines)


def _conforming(solid: Solid, patches: list[_Patch]) -> tuple[dict[int, Edge], list[_Patch]]:
    """Edges and patches whose edges are split until Delaunay triangles follow them.

    A segment is sure to be a side of a triangle if no other point of the face lies in the
    circle over it; so segments are halved until that holds, on both faces of the edge alike.
    """
    edges, patches = dict(solid.edges), list(patches)
    stale = set(range(len(patches)))
    for _ in range(_PASSES):
        marked: dict[int, set[int]] = {}
        for index in stale:
            for number, segment in _crowded(edges, solid.faces[index], patches[index]):
                marked.setdefault(number, set()).add(segment)
        if max((len(edges[n].t) for n in marked), default=0) > _MOST_PIECES:
            raise InputError(
                f"an edge cut into {_MOST_PIECES} pieces still comes too near to another one",
                accepted="edges that do not cross",
                hint="the CAD is damaged; repair the face and export it again",
            )
        for number, segments in marked.items():
            edges[number] = edges[number].split(np.array(sorted(segments)))
        stale = {i for i, f in enumerate(solid.faces) if any(n in marked for n, _ in f.edges)}
        for index in stale:
            trim = _trim(edges, solid.faces[index], patches[index].trim.surface)
            patches[index] = replace(patches[index], trim=trim)
    return edges, patches


def _crowded(edges: dict[int, Edge], face: SolidFace, patch: _Patch) -> Iterator[tuple[int, int]]:
    """Edges of a face, and their segments whose circle holds another point."""
    crowded = np.flatnonzero(patch.crowded())
    if not len(crowded):
        return
    after = np.cumsum([len(edges[number].t) - 1 for number, _ in face.edges])
    for segment, which in zip(crowded, np.searchsorted(after, crowded, "right"), strict=True):
        number, left = face.edges[which]
        # counted from the end of the edge
        back = int(after[which] - 1 - segment)
        yield number, len(edges[number].t) - 2 - back if left else back


@dataclass(frozen=True)
class _Patch:
    """A face about to be cut into triangles.

    Attributes
    ----------
    trim : Trim
    inner : (P, 2) float64
        u and v of the vertices inside.
    scale : (2,) float64
        Times u and v it gives coordinates in which the triangles should be equilateral.
    """

    trim: Trim
    inner: np.ndarray
    scale: np.ndarray

    @classmethod
    def of(cls, trim: Trim) -> _Patch:
        """Patch with inner points near enough for the chord, none very near to an edge."""
        if isinstance(trim.surface, Plane):
            return cls(trim, np.empty((0, 2)), np.ones(2))
        bend, speed = _bend_and_speed(trim)
        if not bend.any():
            return cls(trim, np.empty((0, 2)), speed)
        step = np.sqrt(4.0 * CHORD_MM / np.maximum(bend, bend.max() / _STRETCH**2))
        inner = sample_uv(trim, step[1], step[0])
        near = near_segments(trim.surface.evaluate(inner), trim.segments_mm, step.min() / 2.0)
        return cls(trim, _wrapped(trim.surface, inner[~near]), speed / step)

    @property
    def _periods(self) -> np.ndarray:
        return np.array([self.trim.surface.u_period, self.trim.surface.v_period])

    def crowded(self) -> np.ndarray:
        """Mask of the segments whose circle holds another point, (S,)."""
        trim = self.trim
        length = np.linalg.norm(trim.segments_mm[:, 1] - trim.segments_mm[:, 0], axis=1)
        crowded = crowded_segments(trim.segments_uv, self.inner, self.scale, self._periods)
        return crowded & (length > CHORD_MM)

    def triangles(self, middle_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Vertices (V, 3) mm, Delaunay triangles (T, 3), and middles of their sides (T, 3, 3) mm.

        Periodic directions are tiled. `middle_mm` (S, 3) are points of the edges themselves in the
        middle of their segments.
        """
        uv, vertices, ends = self._nodes()
        if len(uv) < 3:
            return vertices, np.empty((0, 3), dtype=np.int64), np.empty((0, 3, 3))
        copies, owner = _tiled(uv, self._periods)
        triangles, beyond = delaunay(_shaken(copies * self.scale, owner))
        keep = self._is_inside(copies, triangles)
        within = (beyond >= 0) & keep[beyond // 3]
        middles = _middles_of_sides(self.trim.surface, copies[triangles], beyond, keep, within)
        border = keep[:, None] & ~within
        sides = np.stack([owner[triangles], owner[np.roll(triangles, -1, axis=1)]], axis=-1)
        middles[border] = _of_segments(sides[border], ends, middle_mm, otherwise=middles[border])
        return vertices, owner[triangles[keep]], middles[keep]

    def _is_inside(self, copies: np.ndarray, triangles: np.ndarray) -> np.ndarray:
        """Mask of the triangles (T, 3) of tiled points that belong to the face, each once."""
        flat = 3.0 * _SHAKE * np.ptp(copies * self.scale, axis=0).max()
        centre, keep = centres(copies, triangles, self.scale, self._periods, flat)
        keep[keep] = self.trim.contains(centre[keep])
        return keep

    def _nodes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Corners of the triangles: u and v within one period (V, 2), and points (V, 3) mm.

        Also which of them each segment of the edges joins, (S, 2).
        """
        trim = self.trim
        border = _wrapped(trim.surface, trim.segments_uv.reshape(-1, 2))
        first, which, _ = unique_rows(np.round(border, 9))
        poles = [pole for pole in (_pole(trim, v) for v in trim.v_range()) if len(pole)]
        ends = [np.repeat(trim.surface.evaluate(pole[:1]), len(pole), axis=0) for pole in poles]
        points = [trim.segments_mm.reshape(-1, 3)[first], trim.surface.evaluate(self.inner)]
        uv = np.vstack([border[first], self.inner, *poles])
        return uv, np.vstack([*points, *ends]), which.reshape(-1, 2)


def _wrapped(surface: Surface, uv: np.ndarray) -> np.ndarray:
    """u and v moved into [0, period)."""
    uv = uv.copy()
    for axis, period in enumerate((surface.u_period, surface.v_period)):
        if period:
            uv[:, axis] = np.mod(uv[:, axis], period)
            uv[period - uv[:, axis] < 1e-9, axis] = 0.0
    return uv


def _middles_of_sides(
    surface: Surface, uv: np.ndarray, beyond: np.ndarray, keep: np.ndarray, within: np.ndarray
) -> np.ndarray:
    """Points of the surface in the middle of the sides of triangles, (T, 3, 3) mm.

    Parameters
    ----------
    uv : (T, 3, 2) float64
        Of the corners.
    beyond : (T, 3) int64
        As `delaunay` says it.
    keep : (T,) bool
        The triangles that are asked for.
    within : (T, 3) bool
        Whether such a one lies beyond a side: of the two the first one's middle serves for both.
    """
    number = np.arange(beyond.size).reshape(beyond.shape)
    first = keep[:, None] & ~(within & (beyond < number))
    middles = np.empty((*beyond.shape, 3))
    between = (uv[first] + np.roll(uv, -1, axis=1)[first]) / 2.0
    middles[first] = surface.evaluate(_wrapped(surface, between))
    second = keep[:, None] & ~first
    middles[second] = middles.reshape(-1, 3)[beyond[second]]
    return middles


def _of_segments(
    sides: np.ndarray, ends: np.ndarray, middle_mm: np.ndarray, otherwise: np.ndarray
) -> np.ndarray:
    """Middles (N, 3) of those sides (N, 2) that are segments with the ends (S, 2)."""
    if not len(ends) or not len(sides):
        return otherwise
    weight = np.array([max(sides.max(), ends.max()) + 1, 1])
    side, segment = np.sort(sides, axis=1) @ weight, np.sort(ends, axis=1) @ weight
    order = np.argsort(segment)
    place = order[np.minimum(np.searchsorted(segment[order], side), len(ends) - 1)]
    return np.where((segment[place] == side)[:, None], middle_mm[place], otherwise)


def _pole(trim: Trim, v: float) -> np.ndarray:
    """Copies of the pole at the end v of the surface, if the face reaches it."""
    if v not in trim.surface.v_limits or not is_pole(trim.surface, v):
        return np.empty((0, 2))
    u = np.linspace(0.0, trim.surface.u_period, 24, endpoint=False)
    return np.column_stack([u, np.full_like(u, v)])


def _bend_and_speed(trim: Trim) -> tuple[np.ndarray, np.ndarray]:
    """Along u and v: largest turn of the normal per length (1/mm), mean length per parameter."""
    grid = trim.grid(9, 9)
    flat = grid.reshape(-1, 2)
    points = trim.surface.evaluate(flat).reshape(*grid.shape[:2], 3)
    slopes = trim.surface.derivatives(flat)
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = unit_normals(trim.surface, flat, slopes).reshape(points.shape)
    bend = np.zeros(2)
    for axis in range(2):
        turn = np.linalg.norm(np.diff(normals, axis=axis), axis=2)
        length = np.linalg.norm(np.diff(points, axis=axis), axis=2)
        # at a pole there is neither a length nor a normal
        usable = (length > 1e-2 * length.max()) & np.isfinite(turn)
        bend[axis] = (turn[usable] / length[usable]).max(initial=0.0)
    speed = [np.linalg.norm(slope, axis=1).mean() for slope in slopes]
    return np.where(bend > 1e-9, bend, 0.0), np.array(speed)


def _tiled(uv: np.ndarray, periods: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The points with copies half a period beyond either end, and whose copy each is."""
    if not periods.any():
        return uv, np.arange(len(uv))
    shifts = [(-1, 0, 1) if period else (0,) for period in periods]
    turns = np.array([(i, j) for i in shifts[0] for j in shifts[1]])
    copies = (uv + (turns * periods)[:, None]).reshape(-1, 2)
    owner = np.tile(np.arange(len(uv)), len(turns))
    near = (np.abs(copies - periods / 2.0) <= periods) | (periods == 0.0)
    return copies[near.all(axis=1)], owner[near.all(axis=1)]


def _shaken(points: np.ndarray, owner: np.ndarray) -> np.ndarray:
    """Points moved a little, all copies alike, so that no four lie on one circle."""
    shake = _shakes(int(owner.max(initial=0) + 1).bit_length())
    return points + _SHAKE * np.ptp(points, axis=0).max() * shake[owner]


@cache
def _shakes(bits: int) -> np.ndarray:
    """Random directions, (2**bits, 2), of which the first are the same for all numbers of bits."""
    return np.random.default_rng(0).uniform(-1.0, 1.0, (2**bits, 2))
