"""A nominal part from a STEP file: exact faces, and triangles of them to look at.

Source: ISO 10303-203, ISO 10303-214, ISO 10303-242.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

from vmach.base.note import Kind, Note
from vmach.base.units import um_from_mm
from vmach.errors import InputError
from vmach.nominal.mesh.mesh_solidity import check_encloses_once
from vmach.nominal.mesh.unique_rows import unique_rows
from vmach.nominal.part import Mesh, NominalPart, check_size
from vmach.nominal.step.bodies import read_bodies
from vmach.nominal.step.exchange_file import StepFile
from vmach.nominal.step.pmi import StepPmi, read_pmi
from vmach.nominal.step.solids import CHORD_MM, Solid
from vmach.nominal.surfaces.curved_triangles import area_mm2
from vmach.nominal.surfaces.face import SurfaceFace
from vmach.nominal.surfaces.tessellation import tessellate

__all__ = ["read_step_part"]

#: larger gaps between edges and their vertices or faces are said
SAID_GAP_MM = 1e-4

#: a name that says something has a word; numbers of a data base have none
_WORD = re.compile("[A-Za-z]{3}")


def read_step_part(path: Path, unit_mm: float | None = None) -> NominalPart:
    """Read the solids of a STEP file (AP203, AP214, AP242) as exact surfaces, in mm.

    `unit_mm` is the unit of length of a file that names none.

    Raises
    ------
    InputError
        Not a STEP file, cut short, without a closed solid, or with geometry that is not
        supported.
    """
    step = StepFile(path, unit_mm)
    solids, notes = read_bodies(step)
    for solid in solids:
        for edge in solid.edges.values():
            check_size(path, edge.points_mm)
    faces, meshes, volume_mm3, gap_mm = [], [], 0.0, 0.0
    for solid in solids:
        solid_faces, mesh, enclosed_mm3, solid_gap_mm = _build(solid, first=len(faces))
        gap_mm = max(gap_mm, solid_gap_mm)
        if mesh.volume_mm3 < 0.0:
            solid_faces = [replace(face, outward=-face.outward) for face in solid_faces]
            mesh = Mesh(mesh.vertices_mm, mesh.triangles[:, ::-1], mesh.face)
            notes.append(Note.plain(Kind.INSIDE_OUT, "a solid was inside out and has been turned"))
        volume_mm3 += abs(enclosed_mm3)
        faces += solid_faces
        meshes.append(mesh)
    notes += _gaps(max(solid.gap_mm for solid in solids), "vertices")
    notes += _gaps(gap_mm, "faces")
    pmi, more = _pmi(step)
    notes += more
    faces = _titled(faces, pmi)
    mesh = _joined(meshes)
    if len(solids) > 1:
        check_encloses_once(path, mesh.vertices_mm, mesh.triangles, bodies_touch=True)
    return NominalPart(
        path=path,
        faces=tuple(faces),
        mesh=mesh,
        mesh_chord_mm=CHORD_MM,
        chord_error_mm=0.0,
        exact_volume_mm3=volume_mm3,
        notes=tuple(notes),
        pmi=pmi,
    )


def _gaps(gap_mm: float, what: str) -> list[Note]:
    if gap_mm <= SAID_GAP_MM:
        return []
    said = f"edges of the CAD miss their {what} by up to {um_from_mm(gap_mm):.3g} um"
    return [Note.plain(Kind.GAP, said, um_from_mm(gap_mm), "um")]


def _pmi(step: StepFile) -> tuple[StepPmi, list[Note]]:
    """The tolerances of the file; damaged ones are said and left out."""
    try:
        return read_pmi(step), []
    except InputError as error:
        return StepPmi(), [Note.question(Kind.LEFT_OUT, f"{error.what}: they are left out")]


def _titled(faces: list[SurfaceFace], pmi: StepPmi) -> list[SurfaceFace]:
    """Faces with the names that the CAD gives them, where no two have the same."""
    told = [(face.title, pmi.names.get(face.number, "")) for face in faces]
    titles = [next((name for name in names if _WORD.search(name)), "") for names in told]
    times = Counter(titles)
    return [
        replace(face, title=title if times[title] == 1 else "")
        for face, title in zip(faces, titles, strict=True)
    ]


def _build(solid: Solid, first: int) -> tuple[list[SurfaceFace], Mesh, float, float]:
    """Faces of one solid, numbered on from `first`, their mesh, and the volume that they enclose.

    The volume is negative where the solid is inside out. Also how far edges lie off faces, mm.
    """
    faces, vertices, triangles, owner, count, volume_mm3 = [], [], [], [], 0, 0.0
    found, gap_mm = tessellate(solid)
    for index, (raw, trim, points, corners, share) in enumerate(found, first):
        volume_mm3 += raw.outward * share
        area = area_mm2(points, corners)
        if raw.outward < 0.0:
            corners = corners[:, ::-1]
        name = f"face {index + 1} {trim.surface.label}"
        faces.append(
            SurfaceFace(name, trim.surface.kind, trim, raw.outward, area, raw.number, raw.name)
        )
        vertices.append(points)
        triangles.append(corners + count)
        owner.append(np.full(len(corners), index))
        count += len(points)
    mesh = _welded(np.vstack(vertices), np.vstack(triangles), np.concatenate(owner))
    return faces, mesh, volume_mm3, gap_mm


def _welded(vertices: np.ndarray, triangles: np.ndarray, face: np.ndarray) -> Mesh:
    """Mesh with equal vertices made one: faces share the points of their edges bit by bit."""
    first, place, _ = unique_rows(vertices)
    triangles = place[triangles]
    whole = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    # at a pole two triangles may lie back to back
    _, which, times = unique_rows(np.sort(triangles, axis=1))
    whole &= times[which] == 1
    return Mesh(vertices[first], triangles[whole], face[whole])


def _joined(meshes: list[Mesh]) -> Mesh:
    offsets = np.cumsum([0] + [len(mesh.vertices_mm) for mesh in meshes])
    return Mesh(
        np.vstack([mesh.vertices_mm for mesh in meshes]),
        np.vstack([mesh.triangles + start for mesh, start in zip(meshes, offsets, strict=False)]),
        np.concatenate([mesh.face for mesh in meshes]),
    )
