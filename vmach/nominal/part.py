"""The nominal part: faces that points are sampled on, and a mesh to look at."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np

from vmach.base.note import Kind, Note
from vmach.errors import InputError
from vmach.nominal.points import SurfacePoints

if TYPE_CHECKING:
    from vmach.nominal.step.pmi import StepPmi

__all__ = [
    "EDGE_MARGIN_MM",
    "LARGEST_MM",
    "MAX_POINTS",
    "NARROW",
    "ROW_MARGINS",
    "Face",
    "Mesh",
    "NominalPart",
    "check_size",
]

#: nothing of a part lies farther from the workpiece zero: more than the longest machines travel
LARGEST_MM = 1e5

#: finer ones are a slip: a picometre
_SMALLEST_SPACING_MM = 1e-9

#: at an edge the deviation along a normal is not defined, so points keep this distance
EDGE_MARGIN_MM = 0.05

#: where a face is narrower than so many spacings, it gets points along its edges too: evenly
#: spread ones make fewer than three rows across it
NARROW = 2.5

#: these rows keep so many edge margins from the edge: a row may meet an edge at 45 degrees
ROW_MARGINS = 1.5

#: more sampled points than this are refused before any work is done
MAX_POINTS = 5_000_000


def check_size(path: Path, points_mm: np.ndarray) -> None:
    """Raise InputError where one of the points (P, 3) lies beyond `LARGEST_MM`.

    A stray vertex, or a unit taken for another: a part of that size asks for more points and
    triangles than a computer holds.
    """
    far = ~(np.abs(points_mm) <= LARGEST_MM).all(axis=1)
    if far.any():
        x, y, z = points_mm[np.argmax(far)]
        raise InputError(
            f"{int(far.sum())} of {len(points_mm)} points of the part lie outside, the first at "
            f"({x:.6g}, {y:.6g}, {z:.6g}) mm",
            file=path,
            accepted=f"coordinates within {LARGEST_MM:g} mm of the workpiece zero",
            hint="is a vertex astray, or the unit of the file another one?",
        )


class Face(Protocol):
    """One face of the nominal part."""

    name: str  #: as in reports: ``face 12 cylinder R20``
    kind: str  #: plane, cylinder, cone, ...
    area_mm2: float

    def sample(
        self, spacing_mm: float, edge_margin_mm: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points and outward unit normals, (P, 3) mm each, and weights, (P,)."""
        ...


@dataclass(frozen=True)
class Mesh:
    """Triangles to look at; numbers come from the faces themselves.

    Attributes
    ----------
    vertices_mm : (V, 3) float64
    triangles : (T, 3) int64
        Counter-clockwise seen from outside.
    face : (T,) int64
        Index of the face in `NominalPart.faces` that each triangle belongs to.
    """

    vertices_mm: np.ndarray
    triangles: np.ndarray
    face: np.ndarray

    def __post_init__(self) -> None:
        for name, dtype in (("vertices_mm", np.float64), ("triangles", np.int64), ("face", int)):
            array = np.ascontiguousarray(getattr(self, name), dtype=dtype)
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def corners_mm(self) -> np.ndarray:
        """Corners of the triangles, (T, 3, 3) mm."""
        return self.vertices_mm[self.triangles]

    @property
    def volume_mm3(self) -> float:
        """Enclosed volume, positive when the triangles face outwards."""
        a, b, c = np.moveaxis(self.corners_mm - self.vertices_mm.mean(axis=0), 1, 0)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


@dataclass(frozen=True)
class NominalPart:
    """Nominal CAD of the finished part, in workpiece coordinates, mm.

    Attributes
    ----------
    path : Path
        The file it was read from.
    faces : tuple of Face
        Faces with a name, a kind and an area.
    mesh : Mesh
        Closed triangle mesh for pictures.
    mesh_chord_mm : float
        How far the triangles of `mesh` may leave the faces: the chord that edges keep. Inside
        doubly curved faces single triangles leave them by up to three times as much.
    chord_error_mm : float
        How far the faces are from the designer's surface: 0 for exact surfaces (STEP), the
        estimated sagitta of the facets for STL.
    notes : tuple of Note
        What the reader noticed and survived, one sentence each.
    exact_volume_mm3 : float, optional
        Volume that the faces enclose, where it is known better than that of the mesh.
    pmi : StepPmi or None
        Tolerances that the file holds.
    """

    path: Path
    faces: tuple[Face, ...]
    mesh: Mesh
    mesh_chord_mm: float
    chord_error_mm: float
    notes: tuple[Note, ...] = ()
    pmi: StepPmi | None = None
    exact_volume_mm3: float | None = None

    @property
    def volume_mm3(self) -> float:
        """Volume of the part."""
        known = self.exact_volume_mm3
        return self.mesh.volume_mm3 if known is None else known

    @property
    def bounds_mm(self) -> np.ndarray:
        """Lowest and highest corner of the bounding box of the mesh, (2, 3) mm."""
        corners = self.mesh.vertices_mm
        return np.array([corners.min(axis=0), corners.max(axis=0)])

    def sample(
        self,
        spacing_mm: float,
        *,
        edge_margin_mm: float = EDGE_MARGIN_MM,
        max_points: int = MAX_POINTS,
    ) -> SurfacePoints:
        """Sample points with outward normals on all faces, the same at every call.

        Parameters
        ----------
        spacing_mm : float
            Distance between neighbouring points; a face smaller than that gets one point.
        edge_margin_mm : float
            Least distance of a point from the edges of its face.
        max_points : int
            Refuse spacings that would give more points.

        Returns
        -------
        SurfacePoints
            With ids from 1, `feature` being the face's name; `notes` names the faces that are
            too narrow for a point.

        Raises
        ------
        InputError
            Spacing or margin that is not a positive number, or too many points.
        """
        self._check(spacing_mm, edge_margin_mm, max_points)
        samples = [face.sample(spacing_mm, edge_margin_mm) for face in self.faces]
        counts = [len(points) for points, _, _ in samples]
        bare = [f.name for f, count in zip(self.faces, counts, strict=True) if count == 0]
        notes: tuple[Note, ...] = ()
        if bare:
            said = f"{len(bare)} faces are too narrow for a point: {', '.join(bare[:5])}"
            notes = (Note.plain(Kind.NARROW, said, len(bare), "1", place=bare[0]),)
        return SurfacePoints(
            id=_own(np.arange(1, sum(counts) + 1).astype(str)),
            feature=_own(np.repeat([face.name for face in self.faces], counts)),
            point_mm=_own(np.concatenate([points for points, _, _ in samples])),
            normal=_own(np.concatenate([normals for _, normals, _ in samples])),
            weight=_own(np.concatenate([weight for _, _, weight in samples])),
            notes=self.notes + notes,
        )

    def _check(self, spacing_mm: float, edge_margin_mm: float, max_points: int) -> None:
        if not (np.isfinite(spacing_mm) and spacing_mm >= _SMALLEST_SPACING_MM):
            accepted = f"{_SMALLEST_SPACING_MM:g} mm or more"
            raise InputError(f"spacing {spacing_mm} mm", accepted=accepted)
        if not (np.isfinite(edge_margin_mm) and edge_margin_mm >= 0.0):
            raise InputError(f"edge margin {edge_margin_mm} mm", accepted="0 or a number above it")
        area_mm2 = sum(face.area_mm2 for face in self.faces)
        if area_mm2 / spacing_mm**2 > max_points:
            raise InputError(
                f"a spacing of {spacing_mm:g} mm gives about {area_mm2 / spacing_mm**2:.2g} points",
                file=self.path,
                accepted=f"at most {max_points} points",
                hint=f"use {np.sqrt(area_mm2 / max_points):.2g} mm or more",
            )


def _own(array: np.ndarray) -> np.ndarray:
    """An array that nobody else holds, read-only: a record that takes it need not copy it."""
    array.setflags(write=False)
    return array
