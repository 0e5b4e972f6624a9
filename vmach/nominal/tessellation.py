"""Triangles to look at for exact faces: closed, and within the chord of the edges."""

from __future__ import annotations

import numpy as np
from scipy.spatial import Delaunay, QhullError, cKDTree

from vmach.nominal.step_solids import CHORD_MM, Edge, Solid, SolidFace
from vmach.nominal.surface_face import sample_uv
from vmach.nominal.surfaces import Sphere, unit_normals
from vmach.nominal.trimming import Trim

__all__ = ["conforming", "face_trim", "triangulate"]

_PASSES = 8
_SHORTEST_MM = 0.02


def face_trim(solid: Solid, face: SolidFace) -> Trim:
    """The face's edges on its surface."""
    lines = [_directed(solid.edges[number], left) for number, left in face.edges]
    surface = face.surface
    if isinstance(surface, Sphere):
        surface = surface.away_from(np.vstack(lines) if lines else np.empty((0, 3)))
    return Trim.from_polylines(surface, lines)


def _directed(edge: Edge, forward: bool) -> np.ndarray:
    return edge.points_mm if forward else edge.points_mm[::-1]


def conforming(solid: Solid) -> Solid:
    """The solid with its edges split until Delaunay triangles of each face follow them.

    A segment is sure to be a side of a triangle if no other point of the face lies in the ball
    over it; so segments are halved until that holds, on both faces of the edge alike.
    """
    edges = dict(solid.edges)
    for _ in range(_PASSES):
        marked: dict[int, set[int]] = {}
        for face in solid.faces:
            for number, segments in _crowded(edges, face):
                marked.setdefault(number, set()).update(segments.tolist())
        if not marked:
            break
        for number, segments in marked.items():
            edges[number] = edges[number].split(np.array(sorted(segments)))
    return Solid(solid.faces, edges, solid.gap_mm)


def _crowded(edges: dict[int, Edge], face: SolidFace):
    """Edges of a face and their segments whose ball holds another point of the face."""
    lines = [edges[number].points_mm for number, _ in face.edges]
    if not lines:
        return
    tree = cKDTree(np.vstack(lines))
    for (number, _), line in zip(face.edges, lines, strict=True):
        length = np.linalg.norm(np.diff(line, axis=0), axis=1)
        middle = (line[:-1] + line[1:]) / 2.0
        distance, _ = tree.query(middle)
        crowded = (distance < length / 2.0 * (1.0 - 1e-6)) & (length > _SHORTEST_MM)
        if crowded.any():
            yield number, np.flatnonzero(crowded)


def triangulate(trim: Trim) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) mm and triangles (T, 3), counter-clockwise about dS/du x dS/dv.

    Delaunay triangles in u and v, scaled to lengths, of the ends of the segments and of points
    inside that are near enough for the chord; periodic directions are tiled.
    """
    uv, vertices = _nodes(trim)
    periods = np.array([trim.surface.u_period, trim.surface.v_period])
    copies, owner = _tiled(uv, periods)
    scale = [np.linalg.norm(d, axis=1).mean() for d in trim.surface.derivatives(uv)]
    try:
        triangles = Delaunay(_shaken(copies * scale, owner)).simplices
    except (QhullError, ValueError):  # fewer than three points, or all on one line
        return vertices, np.empty((0, 3), dtype=np.int64)
    a, b, c = np.moveaxis(copies[triangles] * scale, 1, 0)
    area = np.cross(b - a, c - a) / 2.0
    longest = np.max([np.linalg.norm(x - y, axis=1) for x, y in ((a, b), (b, c), (c, a))], axis=0)
    triangles = np.where((area < 0.0)[:, None], triangles[:, ::-1], triangles)
    centre = copies[triangles].mean(axis=1)
    window = ((centre >= 0.0) & (centre < periods) | (periods == 0.0)).all(axis=1)
    keep = window & (np.abs(area) > 1e-5 * longest**2)
    keep[keep] = trim.contains(centre[keep])
    return vertices, owner[triangles[keep]]


def _nodes(trim: Trim) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the triangles: u and v within one period (V, 2), and points (V, 3) mm."""
    border = _wrapped(trim, trim.segments_uv.reshape(-1, 2))
    _, first = np.unique(np.round(border, 9), axis=0, return_index=True)
    inner = _inner_points(trim)
    poles = [pole for pole in map(lambda v: _pole(trim, v), trim.v_range()) if len(pole)]
    ends = [np.repeat(trim.surface.evaluate(pole[:1]), len(pole), axis=0) for pole in poles]
    uv = np.vstack([border[first], inner, *poles])
    return uv, np.vstack(
        [trim.segments_mm.reshape(-1, 3)[first], trim.surface.evaluate(inner), *ends]
    )


def _wrapped(trim: Trim, uv: np.ndarray) -> np.ndarray:
    uv = uv.copy()
    for axis, period in enumerate((trim.surface.u_period, trim.surface.v_period)):
        if period:
            uv[:, axis] = np.mod(uv[:, axis], period)
            uv[period - uv[:, axis] < 1e-9, axis] = 0.0
    return uv


def _pole(trim: Trim, v: float) -> np.ndarray:
    """Copies of the pole at the end v of the surface, if the face reaches it."""
    surface = trim.surface
    if surface.v_period or not surface.u_period or v not in surface.v_limits:
        return np.empty((0, 2))
    u = np.linspace(0.0, surface.u_period, 24, endpoint=False)
    uv = np.column_stack([u, np.full_like(u, v)])
    around = np.linalg.norm(surface.derivatives(uv)[0], axis=1).max() * surface.u_period
    return uv if around < 1e-6 else np.empty((0, 2))


def _inner_points(trim: Trim) -> np.ndarray:
    """Points inside the face whose distance keeps the chord, none in the ball of a segment."""
    across, along = (np.sqrt(4.0 * CHORD_MM / k) if k else np.inf for k in _curvatures(trim))
    if np.isinf(across) and np.isinf(along):
        return np.empty((0, 2))
    uv = _wrapped(trim, sample_uv(trim, along, across))
    if not len(uv) or not len(trim.segments_mm):
        return uv
    start, end = np.moveaxis(trim.segments_mm, 1, 0)
    radius = np.linalg.norm(end - start, axis=1) / 2.0
    near = cKDTree(trim.surface.evaluate(uv)).query_ball_point((start + end) / 2.0, radius)
    return np.delete(uv, np.unique(np.concatenate(near)).astype(int), axis=0)


def _curvatures(trim: Trim) -> tuple[float, float]:
    """Largest turn of the normal per length along u and along v, 1/mm; 0 where it is flat."""
    grid = trim.grid(9)
    points = trim.surface.evaluate(grid.reshape(-1, 2)).reshape(grid.shape[:2] + (3,))
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = unit_normals(trim.surface, grid.reshape(-1, 2)).reshape(points.shape)
        turns = [
            np.linalg.norm(np.diff(normals, axis=axis), axis=2)
            / np.linalg.norm(np.diff(points, axis=axis), axis=2)
            for axis in range(2)
        ]
    largest = (float(turn[np.isfinite(turn)].max(initial=0.0)) for turn in turns)
    return tuple(k if k > 1e-9 else 0.0 for k in largest)


def _tiled(uv: np.ndarray, periods: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Copies one period to either side, and which point each is a copy of."""
    shifts = [(-1, 0, 1) if period else (0,) for period in periods]
    turns = np.array([(i, j) for i in shifts[0] for j in shifts[1]])
    copies = (uv + (turns * periods)[:, None]).reshape(-1, 2)
    return copies, np.tile(np.arange(len(uv)), len(turns))


def _shaken(points: np.ndarray, owner: np.ndarray) -> np.ndarray:
    """Points moved a little, all copies alike, so that no four lie on one circle."""
    shake = np.random.default_rng(0).uniform(-1.0, 1.0, (owner.max(initial=0) + 1, 2))
    return points + 1e-7 * np.ptp(points, axis=0).max() * shake[owner]
