"""A mesh made fit for showing: fine enough for the colours, small enough for a page."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from vmach.report.result import Colouring, DisplayMesh, InspectedPoints

__all__ = [
    "Interpolation",
    "Neighbours",
    "build_display_mesh",
    "interpolate_to_mesh",
    "shaped_for_display",
    "sharp_edges",
    "vertex_normals",
]

_SHARP_EDGE_RAD = 0.6  # above: an edge of the part; below: a chord of a curved face
_NEIGHBOURS = 6
_SLOPE, _CHORD_MM = 0.02, 0.05  # of a chord against its face: curvature, facets


def build_display_mesh(
    vertices_mm: np.ndarray,
    triangles: np.ndarray,
    points: InspectedPoints,
    *,
    max_triangles: int = 100_000,
) -> DisplayMesh:
    """Return a mesh with the deviations, and remainders, of all columns at its vertices.

    Large triangles are divided to about the spacing of the points, too many are thinned out;
    a CAD face of two triangles would otherwise show nothing of what lies within it.

    Parameters
    ----------
    vertices_mm, triangles : (V, 3) float, (T, 3) int
        Closed surface in workpiece coordinates, shared or repeated vertices alike.
    points : InspectedPoints
    max_triangles : int
        Not more triangles than this.
    """
    mesh = shaped_for_display(
        vertices_mm, triangles, point_count=len(points), max_triangles=max_triangles
    )
    near = Neighbours.of(points.point_mm, points.normal, mesh)
    colourings = {}
    for column in points.with_remainders().columns:
        found = near.interpolation(has_value=column.is_cut & np.isfinite(column.deviation_mm))
        colourings[column.name] = Colouring(found.at_vertices(column.deviation_mm), found.known)
    return DisplayMesh(mesh.vertices_mm, mesh.triangles, colourings)


def shaped_for_display(
    vertices_mm: np.ndarray,
    triangles: np.ndarray,
    *,
    point_count: int,
    max_triangles: int = 100_000,
) -> DisplayMesh:
    """The mesh of `build_display_mesh`, fit for so many points, without any colour."""
    vertices_mm, triangles = _weld(np.asarray(vertices_mm, float), np.asarray(triangles))
    if len(triangles) > max_triangles:
        vertices_mm, triangles = _decimate(vertices_mm, triangles, max_triangles)
    else:
        vertices_mm, triangles = _refine(vertices_mm, triangles, point_count, max_triangles)
    return DisplayMesh(*_split_sharp_edges(vertices_mm, triangles))


@dataclass(frozen=True)
class Interpolation:
    """From values of P points to V vertices; for display only.

    Attributes
    ----------
    matrix : (V, P) sparse float64
        Weights of the points, rows of `known` vertices add up to 1.
    known : (V,) bool
        Vertices that a point with a value is near to.
    """

    matrix: csr_matrix
    known: np.ndarray

    def at_vertices(self, values: np.ndarray) -> np.ndarray:
        """Values (V,) of the vertices from those of the points (P,); 0 where not known."""
        return self.matrix @ np.nan_to_num(values)


def interpolate_to_mesh(
    points: InspectedPoints, values_mm: np.ndarray, mesh: DisplayMesh
) -> Colouring:
    """Interpolate values of the points to the vertices of a mesh; see `Neighbours`.

    Parameters
    ----------
    points : InspectedPoints
    values_mm : (P,) float
        NaN where a point has no value: vertices nearest to such a point are not `known`.
    mesh : DisplayMesh

    Returns
    -------
    Colouring
    """
    values_mm = np.asarray(values_mm, float)
    near = Neighbours.of(points.point_mm, points.normal, mesh)
    found = near.interpolation(has_value=np.isfinite(values_mm))
    return Colouring(found.at_vertices(values_mm), found.known)


@dataclass(frozen=True)
class Neighbours:
    """The K points nearest to each of V vertices, for display.

    Points of a parallel face do not count, those on faces of another direction count as far away:
    the neighbours are found in the space of position and normal, the normal stretched so that 90
    degrees are as far as the reach.

    Attributes
    ----------
    index : (V, K) int64
        Of P points.
    distance_mm : (V, K) float64
    on_same_face : (V, K) bool
    reach_mm : float
        Points farther away say nothing of a vertex.
    point_count : int
    """

    index: np.ndarray
    distance_mm: np.ndarray
    on_same_face: np.ndarray
    reach_mm: float
    point_count: int

    @classmethod
    def of(cls, point_mm: np.ndarray, normal: np.ndarray, mesh: DisplayMesh) -> Neighbours:
        """Find them; places and normals of the points are (P, 3) float64."""
        vertices, count = len(mesh.vertices_mm), min(_NEIGHBOURS, len(point_mm))
        if not count:
            none = np.zeros((vertices, 0))
            return cls(none.astype(int), none, none.astype(bool), 0.0, 0)
        reach_mm = 6 * _spacing(mesh, len(point_mm))
        stretch_mm = reach_mm / np.sqrt(2)
        tree = cKDTree(np.hstack([point_mm, stretch_mm * normal]))
        normals = vertex_normals(mesh)
        distance_mm, index = tree.query(
            np.hstack([mesh.vertices_mm, stretch_mm * normals]), k=range(1, count + 1)
        )
        same_face = _on_same_face(
            point_mm[index] - mesh.vertices_mm[:, None], normal[index] + normals[:, None]
        )
        return cls(index, distance_mm, same_face, reach_mm, len(point_mm))

    def interpolation(self, *, has_value: np.ndarray) -> Interpolation:
        """How values of points become values of vertices: means with weights 1/distance^2.

        Vertices nearest to a point that has no value, (P,) bool, are not `known`.
        """
        vertices, count = self.index.shape
        if not count:
            return Interpolation(csr_matrix((vertices, 0)), np.zeros(vertices, bool))
        counts = self.on_same_face & has_value[self.index]
        nearest = self.on_same_face.argmax(axis=1)[:, None]
        known = np.take_along_axis(counts, nearest, 1)[:, 0]
        known &= np.take_along_axis(self.distance_mm, nearest, 1)[:, 0] < self.reach_mm
        softened_mm2 = self.distance_mm**2 + (1e-3 * self.reach_mm) ** 2
        weight = np.where(counts, 1 / softened_mm2, 0.0)
        weight *= known[:, None] / np.maximum(weight.sum(1, keepdims=True), 1e-300)
        row = np.repeat(np.arange(vertices), count)
        entries = (weight.ravel(), (row, self.index.ravel()))
        return Interpolation(csr_matrix(entries, shape=(vertices, self.point_count)), known)


def _on_same_face(chord_mm: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Whether chords (..., 3) lie in a smooth face, `normals` the sum of those at both ends.

    In a plane, on a cylinder and on a sphere a chord is at right angles to that sum; from a step
    to the next it is not.
    """
    offset_mm = np.abs(np.sum(chord_mm * normals, axis=-1))
    length_mm = np.linalg.norm(chord_mm, axis=-1)
    return offset_mm <= np.linalg.norm(normals, axis=-1) * (_SLOPE * length_mm + _CHORD_MM)


def vertex_normals(mesh: DisplayMesh) -> np.ndarray:
    """(V, 3) unit normals, the mean over the triangles at a vertex weighted by area."""
    twice_area = _twice_area_vectors(mesh.vertices_mm, mesh.triangles)
    corners = mesh.triangles.T.ravel()
    normals = np.column_stack([
        np.bincount(corners, np.tile(part, 3), len(mesh.vertices_mm)) for part in twice_area.T
    ])  # fmt: skip
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(length > 0, length, 1.0)


def _twice_area_vectors(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (vertices[corner] for corner in triangles.T)
    return np.cross(b - a, c - a)


def _area(vertices: np.ndarray, triangles: np.ndarray) -> float:
    return 0.5 * float(np.linalg.norm(_twice_area_vectors(vertices, triangles), axis=1).sum())


def _spacing(mesh: DisplayMesh, count: int) -> float:
    """Distance between neighbours if `count` points were spread evenly over the mesh."""
    return np.sqrt(_area(mesh.vertices_mm, mesh.triangles) / max(count, 1))


def _weld(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Merge equal vertices; drop triangles without area."""
    vertices, inverse = np.unique(vertices, axis=0, return_inverse=True)
    triangles = inverse.reshape(-1)[triangles]
    a, b, c = triangles.T
    return vertices, triangles[(a != b) & (b != c) & (c != a)]


def _decimate(
    vertices: np.ndarray, triangles: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    import pyvista  # late: it takes half a second, and only large meshes need it

    mesh = pyvista.PolyData.from_regular_faces(vertices, triangles)
    reduced = mesh.decimate(1 - 0.99 * count / len(triangles))
    return np.asarray(reduced.points, float), reduced.regular_faces


def _refine(
    vertices: np.ndarray, triangles: np.ndarray, point_count: int, max_triangles: int
) -> tuple[np.ndarray, np.ndarray]:
    """Halve edges longer than the spacing of the points, the longest first, within the limit."""
    finest = np.sqrt(_area(vertices, triangles) / max(point_count, 1))
    edge = np.ptp(vertices, axis=0).max(initial=0.0)
    while edge > finest:
        if _longest_side(vertices, triangles) <= edge:
            edge *= 0.84  # a little at a time, to come close to the limit
            continue
        finer = _halve_edges(vertices, triangles, edge)
        if len(finer[1]) > max_triangles:
            break
        vertices, triangles = finer
    return vertices, triangles


def _longest_side(vertices: np.ndarray, triangles: np.ndarray) -> float:
    corners = vertices[triangles]
    sides = corners - corners[:, [1, 2, 0]]
    return np.linalg.norm(sides.reshape(-1, 3), axis=1).max(initial=0.0)


def _halve_edges(
    vertices: np.ndarray, triangles: np.ndarray, longest_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """Halve every edge longer than `longest_mm`; neighbours stay joined without a gap."""
    edges, edge_of, _ = _edges(triangles, len(vertices))
    start, end = vertices[edges[:, 0]], vertices[edges[:, 1]]
    long = np.linalg.norm(end - start, axis=1) > longest_mm
    midpoint = np.full(len(edges), -1)
    midpoint[long] = len(vertices) + np.arange(long.sum())
    mid = midpoint[edge_of.reshape(-1, 3)]
    halved = mid >= 0
    count = halved.sum(axis=1)
    # turn each triangle a, b, c until the edges to halve are ab, or ab and bc, or all
    turn = np.where(count == 2, halved.argmin(axis=1) + 1, halved.argmax(axis=1))
    columns = (np.arange(3) + turn[:, None]) % 3
    a, b, c = np.take_along_axis(triangles, columns, 1).T
    m, n, p = np.take_along_axis(mid, columns, 1).T
    pieces = {
        0: [(a, b, c)],
        1: [(a, m, c), (m, b, c)],
        2: [(m, b, n), (a, m, n), (a, n, c)],
        3: [(a, m, p), (m, b, n), (p, n, c), (m, n, p)],
    }
    divided = [
        np.stack(piece, axis=1)[count == number]
        for number, parts in pieces.items()
        for piece in parts
    ]
    return np.vstack([vertices, 0.5 * (start + end)[long]]), np.concatenate(divided)


def _split_sharp_edges(
    vertices: np.ndarray, triangles: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Repeat vertices so that no two triangles that meet at a sharp edge share one.

    The corners of all triangles are the nodes of a graph; corners at the same vertex are joined
    across each smooth edge. Every connected set of corners becomes one vertex.
    """
    normals = _twice_area_vectors(vertices, triangles)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    corner = np.arange(3 * len(triangles)).reshape(-1, 3)
    start = corner.ravel()
    end = corner[:, [1, 2, 0]].ravel()
    vertex = triangles.ravel()
    low_first = vertex[start] < vertex[end]
    low = np.where(low_first, start, end)
    high = np.where(low_first, end, start)
    order = np.lexsort((vertex[high], vertex[low]))
    low, high = low[order], high[order]
    same = (vertex[low[1:]] == vertex[low[:-1]]) & (vertex[high[1:]] == vertex[high[:-1]])
    cosine = np.einsum("ij,ij->i", normals[low[1:] // 3], normals[low[:-1] // 3])
    smooth = np.flatnonzero(same & (cosine > np.cos(_SHARP_EDGE_RAD)))
    row = np.concatenate([low[smooth], high[smooth]])
    column = np.concatenate([low[smooth + 1], high[smooth + 1]])
    graph = coo_matrix((np.ones(len(row), bool), (row, column)), shape=(vertex.size,) * 2)
    _, label = connected_components(graph, directed=False)
    _, first = np.unique(label, return_index=True)
    return vertices[vertex[first]], label.reshape(-1, 3)


def sharp_edges(mesh: DisplayMesh) -> np.ndarray:
    """(E, 2) rows of vertices: the edges that a single triangle has, each face's outline."""
    edges, _, count = _edges(mesh.triangles, len(mesh.vertices_mm))
    return edges[count == 1]


def _edges(triangles: np.ndarray, vertices: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges (E, 2), that of every side of the triangles (3 T,), and how many sides each has."""
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1).astype(np.int64)
    # one number an edge sorts much faster than pairs
    number, side_of, count = np.unique(
        ends @ np.array([vertices, 1]), return_inverse=True, return_counts=True
    )
    return np.column_stack(np.divmod(number, vertices)), side_of, count
