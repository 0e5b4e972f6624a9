"""A nominal part from an STL file: smooth regions of facets, and how far these can be off.

Source: closed form derived here: strips of width c on a circle meet at an angle b = c / r and
leave the sagitta c b / 8.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from vmach.base.note import Kind, Note
from vmach.base.units import um_from_mm
from vmach.errors import InputError
from vmach.nominal.mesh.mesh_checks import (
    check_closed,
    count_intersections,
    edge_sides,
    merge_corners,
)
from vmach.nominal.mesh.mesh_solidity import check_each_triangle_once, check_encloses_once
from vmach.nominal.mesh.stl import read_stl
from vmach.nominal.mesh.thinning import near_segments, spread
from vmach.nominal.part import NARROW, ROW_MARGINS, Mesh, NominalPart, check_size
from vmach.nominal.weights import shared_weights

__all__ = ["MeshRegion", "read_stl_part"]

#: points along the edges of a narrow region, at least
MIN_ALONG_EDGES = 8

#: facets that meet at a larger angle are taken for two faces with an edge between them
SMOOTH_RAD = np.radians(30.0)

#: facets that meet at a smaller angle are taken for one flat face (32-bit rounding)
FLAT_RAD = 1e-4


@dataclass(frozen=True)
class MeshRegion:
    """Facets that join smoothly: what the designer drew as one face or several tangent ones.

    Attributes
    ----------
    name, kind : str
        ``region 3``; ``plane`` or ``curved``.
    corners_mm : (T, 3, 3) float64
        The facets, counter-clockwise from outside.
    edges_mm : (E, 2, 3) float64
        The sharp edges around the region.
    """

    name: str
    kind: str
    corners_mm: np.ndarray
    edges_mm: np.ndarray

    @property
    def area_mm2(self) -> float:
        """Area of the facets."""
        return float(_areas(self.corners_mm).sum())

    def sample(
        self, spacing_mm: float, edge_margin_mm: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points on the facets about `spacing_mm` apart, the facets' normals, and weights.

        (P, 3), (P, 3) and (P,). Narrow regions get points near their edges as well.
        """
        candidates, facet = self._candidates(0.2 * spacing_mm**2)
        keep = ~near_segments(candidates, self.edges_mm, edge_margin_mm)
        candidates, facet = candidates[keep], facet[keep]
        # 0.8: a maximal set of discs of that radius has about one point a square of the spacing
        chosen = spread(candidates, 0.8 * spacing_mm)
        points, facet = candidates[chosen], facet[chosen]
        weight = np.ones(len(points))
        if self._width_mm < NARROW * spacing_mm:
            more, of = self._near_edges(spacing_mm, ROW_MARGINS * edge_margin_mm)
            keep = ~near_segments(more, self.edges_mm, edge_margin_mm)
            weight = shared_weights(points, more[keep])
            points, facet = np.vstack([points, more[keep]]), np.r_[facet, of[keep]]
        return points, _normals(self.corners_mm[facet]), weight

    @property
    def _width_mm(self) -> float:
        """Width of a long region of this area and perimeter; endless without edges."""
        perimeter = np.linalg.norm(self.edges_mm[:, 1] - self.edges_mm[:, 0], axis=1).sum()
        return 2.0 * self.area_mm2 / perimeter if perimeter else np.inf

    def _near_edges(self, spacing_mm: float, inset_mm: float) -> tuple[np.ndarray, np.ndarray]:
        """Points this far inside the edges, about the spacing apart along them, and facets."""
        sharp = {_ends(*edge) for edge in self.edges_mm}
        sides = [
            (row, i)
            for row, facet in enumerate(self.corners_mm)
            for i in range(3)
            if _ends(facet[i], facet[(i + 1) % 3]) in sharp
        ]
        facet, side = np.array(sides, dtype=np.int64).reshape(-1, 2).T
        corners = self.corners_mm[facet]
        rows = np.arange(len(facet))
        start, end, apex = (corners[rows, (side + i) % 3] for i in range(3))
        length = np.linalg.norm(end - start, axis=1)
        along = (end - start) / np.maximum(length, 1e-300)[:, None]
        foot = np.einsum("ij,ij->i", apex - start, along)
        inward = apex - start - foot[:, None] * along
        height = np.linalg.norm(inward, axis=1)
        # at the inset the facet is narrower than its side: from `low` on, `usable` long
        share = np.minimum(inset_mm / np.maximum(height, 1e-300), 1.0)
        low, usable = share * foot, (1.0 - share) * length
        total = np.r_[0.0, np.cumsum(usable)]
        if not total[-1] > 0.0:
            return np.empty((0, 3)), np.empty(0, dtype=np.int64)
        count = max(round(total[-1] / spacing_mm), MIN_ALONG_EDGES)
        place = (np.arange(count) + 0.5) * (total[-1] / count)
        at = np.minimum(np.searchsorted(total, place, side="right") - 1, len(usable) - 1)
        s = low[at] + place - total[at]
        unit = inward[at] / height[at][:, None]
        return start[at] + s[:, None] * along[at] + inset_mm * unit, facet[at]

    def _candidates(self, area_each_mm2: float) -> tuple[np.ndarray, np.ndarray]:
        """Points spread evenly over the area by the additive sequence of the plastic number."""
        area = _areas(self.corners_mm)
        count = max(int(area.sum() / area_each_mm2), 32)
        sizes = np.cumsum(area)
        facet = np.searchsorted(sizes, (np.arange(count) + 0.5) * (sizes[-1] / count))
        facet = np.minimum(facet, len(area) - 1)
        plastic = 1.32471795724474602596
        s, t = np.modf(np.outer([1 / plastic, 1 / plastic**2], np.arange(1, count + 1)))[0]
        s, t = np.where(s + t > 1.0, [1.0 - s, 1.0 - t], [s, t])
        a, b, c = np.moveaxis(self.corners_mm[facet], 1, 0)
        return a + s[:, None] * (b - a) + t[:, None] * (c - a), facet


def _ends(one: np.ndarray, other: np.ndarray) -> frozenset[bytes]:
    """What names an edge, whichever way it is run along; -0 is 0."""
    return frozenset(((one + 0.0).tobytes(), (other + 0.0).tobytes()))


def read_stl_part(path: Path, unit_mm: float | None = None) -> NominalPart:
    """Read an STL file of one or more solids; `unit_mm` is the file's unit, mm where not given.

    Raises
    ------
    InputError
        Not an STL file, or its triangles are not the closed, consistently wound surface of a
        solid that does not cut through itself.
    """
    corners = read_stl(path) * (1.0 if unit_mm is None else unit_mm)
    check_size(path, corners.reshape(-1, 3))
    vertices, triangles, merged_within = merge_corners(corners)
    if not len(triangles):
        raise InputError(
            f"all {len(corners)} triangles are degenerate: two of their corners are one",
            file=path,
            accepted="triangles with an area",
        )
    check_each_triangle_once(path, triangles)
    check_closed(path, vertices, triangles)
    said = "STL holds facets: its normals and its surface are off by the chord error"
    notes = [Note.plain(Kind.FACETS, said)]
    if merged_within > 0.0:
        said = f"corners up to {merged_within:.2g} mm apart were joined to close the mesh"
        notes.append(Note.plain(Kind.GAP, said, merged_within, "mm"))
    mesh = Mesh(vertices, triangles, np.zeros(len(triangles)))
    if mesh.volume_mm3 < 0.0:
        triangles = triangles[:, ::-1]
        notes.append(Note.plain(Kind.INSIDE_OUT, "the mesh was inside out and has been turned"))
    check_encloses_once(path, vertices, triangles)
    notes += _check_intersections(path, vertices, triangles)

    corners = vertices[triangles]
    empty = int((_areas(corners) <= 1e-9 * np.ptp(vertices, axis=0).max() ** 2 * 1e-3).sum())
    if empty:
        said = f"{empty} triangles have no area and get no points"
        notes.append(Note.plain(Kind.FACETS, said, empty, "1"))
    joint = _Joints(vertices, triangles)
    chord_mm = joint.chord_error_mm()
    resolution = float(np.spacing(np.float32(np.abs(vertices).max()))) / 2.0
    said = (
        f"estimated chord error {um_from_mm(chord_mm):.3g} um, "
        f"rounding to 32 bits {um_from_mm(resolution):.2g} um"
    )
    notes.append(Note.plain(Kind.FACETS, said, um_from_mm(chord_mm), "um"))
    regions, owner = joint.regions()
    return NominalPart(
        path=path,
        faces=regions,
        mesh=Mesh(vertices, triangles, owner),
        mesh_chord_mm=chord_mm,
        chord_error_mm=chord_mm,
        notes=tuple(notes),
    )


def _check_intersections(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> list[Note]:
    count = count_intersections(vertices, triangles)
    if count is None:
        said = "the mesh is too large to look for self-intersections"
        return [Note.plain(Kind.FACETS, said, len(triangles), "1")]
    if count:
        raise InputError(
            f"the mesh cuts through itself or lies on itself: {count} pairs of triangles",
            file=path,
            accepted="the surface of a solid",
            hint="unite the bodies in the CAD system and export again",
        )
    return []


class _Joints:
    """The places where two facets meet: the angle between them, and what follows from it."""

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray) -> None:
        edge, _, side = edge_sides(triangles)
        self.corners = vertices[triangles]
        # sides of one edge are neighbours; edges with four sides pair up arbitrarily but sharply
        self.ends = vertices[edge[::2]]
        self.left, self.right = side[::2], side[1::2]
        normals = _normals(self.corners)
        one, other = normals[self.left], normals[self.right]
        sine = np.linalg.norm(np.cross(one, other), axis=1)
        self.angle_rad = np.arctan2(sine, np.einsum("ij,ij->i", one, other))
        has_area = _areas(self.corners) > 0.0
        # a facet without area has no normal and joins whatever it lies between
        self.angle_rad[~(has_area[self.left] & has_area[self.right])] = 0.0

    def chord_error_mm(self) -> float:
        """Largest distance from a facet to the curved surface that it stands for, estimated.

        Strips of width c on a circle of radius r meet at the angle c/r and leave the sagitta
        c^2/(8 r) = c angle/8. Triangles of height h on a sphere meet at the angle 2 h/(3 r) and
        leave (2 h/3)^2/(2 r) = h angle/3; that is taken for flats that bend on more than two
        sides. Where two flats of different width meet, the narrower counts. A bend of two flats
        that no second bend continues is a shallow edge, not a curve.
        """
        bend = (self.angle_rad > FLAT_RAD) & (self.angle_rad < SMOOTH_RAD)
        flat = self._components(self.angle_rad <= FLAT_RAD)
        left, right = self.left[bend], self.right[bend]
        bends_of_flat = np.bincount(np.r_[flat[left], flat[right]], minlength=1)
        widths = np.array([self._width(left, bend), self._width(right, bend)])
        bends = np.array([bends_of_flat[flat[left]], bends_of_flat[flat[right]]])
        narrower = np.argmin(widths, axis=0), np.arange(len(left))
        share = np.where(bends[narrower] > 2, 1 / 3, 1 / 8)
        error = widths[narrower] * self.angle_rad[bend] * share
        return float(error[bends.max(axis=0) > 1].max(initial=0.0))

    def regions(self) -> tuple[tuple[MeshRegion, ...], np.ndarray]:
        """Smooth regions, and the index of the region of each triangle, (T,)."""
        owner = self._components(self.angle_rad < SMOOTH_RAD)
        sharp = owner[self.left] != owner[self.right]
        normals = _normals(self.corners)
        regions = []
        for index in range(owner.max() + 1):
            inside = owner == index
            around = sharp & ((owner[self.left] == index) | (owner[self.right] == index))
            weighted = normals[inside] * _areas(self.corners[inside])[:, None]
            flat = (
                np.linalg.norm(weighted.sum(axis=0))
                > (1.0 - 1e-9) * np.linalg.norm(weighted, axis=1).sum()
            )
            kind = "plane" if flat else "curved"
            regions.append(
                MeshRegion(
                    f"region {index + 1} {kind}", kind, self.corners[inside], self.ends[around]
                )
            )
        return tuple(regions), owner

    def _components(self, joined: np.ndarray) -> np.ndarray:
        count = len(self.corners)
        pairs = (self.left[joined], self.right[joined])
        graph = coo_array((np.ones(joined.sum()), pairs), shape=(count, count))
        return connected_components(graph, directed=False)[1]

    def _width(self, facet: np.ndarray, which: np.ndarray) -> np.ndarray:
        """Height of each facet over the edge at which it meets its neighbour."""
        length = np.linalg.norm(self.ends[which, 1] - self.ends[which, 0], axis=1)
        return 2.0 * _areas(self.corners[facet]) / length


def _areas(corners: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(corners, 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0


def _normals(corners: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    return normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
