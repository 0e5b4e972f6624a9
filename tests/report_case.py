"""A small result for the tests of the reports: a block of 40 x 30 x 20 mm, three columns."""

from __future__ import annotations

import numpy as np
import trimesh

from vmach.report import Colouring, Column, DisplayMesh, InputFile, InspectedPoints, RunRecord

HOSTILE = "</script><img src=x onerror=alert(1)> & \"part\" 'a' {{ 7 * 7 }}"


def block() -> tuple[np.ndarray, np.ndarray]:
    """Vertices (8, 3) and triangles (12, 3) of the block, its lowest corner at zero."""
    mesh = trimesh.creation.box((40.0, 30.0, 20.0))
    return np.add(mesh.vertices, [20.0, 15.0, 10.0]), mesh.faces


def points(count: int = 600, *, name: str = "face") -> InspectedPoints:
    """Points all over the block with the deviations of `field_mm`; the underside is uncut."""
    mesh = trimesh.Trimesh(*block())
    place, face = trimesh.sample.sample_surface(mesh, count, seed=7)
    normal = mesh.face_normals[face]
    status = np.where(normal[:, 2] < -0.5, "uncut", "cut").astype("U11")
    status[:3] = "gouged away"
    deviation = field_mm(place, normal)
    deviation[status != "cut"] = np.nan
    remainder_mm = np.where(status == "cut", 4e-4, np.nan)
    line = 1 + np.arange(count) % 50
    return InspectedPoints(
        id=[f"P{i}" for i in range(count)],
        feature=[f"{name} {n}" for n in np.abs(normal).argmax(axis=1)],
        point_mm=place,
        normal=normal,
        line=line,
        tool=np.full(count, 3),
        move=line,
        time_s=0.5 * line,
        columns=(
            Column("none", "Program only", 0.01 * deviation, status),
            Column("abbe", "Abbe-consistent", deviation, status, remainder_mm),
            Column("measured", "Measured", field_mm(place, normal), np.full(count, "cut")),
        ),
        u_mm=np.full(count, 4e-4),
    )


def field_mm(place: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """A deviation of some micrometres that differs from face to face."""
    return 1e-3 * (normal @ [1.0, 2.0, 3.0] + 0.05 * place[:, 0])


def run(**changes) -> RunRecord:
    """A record of a run, `changes` over sensible values."""
    values = {
        "title": "block",
        "command": "vmach run job.toml",
        "model": "abbe",
        "tolerance_mm": 3e-3,
        "started_at": "2026-01-02T03:04:05+00:00",
        "files": [InputFile("program", "part.nc", "ab" * 32, 123)],
        "versions": {"vmach": "0.1.0"},
        "stages_s": {"read": 0.1, "cut": 2.0},
        "facts": {"Machine": "gantry"},
        "warnings": ["3 points are gouged away."],
        "program_lines": [f"N{n} G1 X{n}" for n in range(1, 51)],
    }
    return RunRecord(**(values | changes))


def large_mesh(count: int, names: tuple[str, ...]) -> DisplayMesh:
    """A torus of about `count` triangles with a smooth field for each name."""
    sections = round(np.sqrt(count / 2))
    torus = trimesh.creation.torus(30, 10, major_sections=sections, minor_sections=sections)
    value = 4e-3 * np.sin(torus.vertices[:, 0] / 7) * np.cos(torus.vertices[:, 1] / 9)
    known = torus.vertices[:, 2] > -8
    colourings = {name: Colouring(np.where(known, value, 0), known) for name in names}
    return DisplayMesh(torus.vertices, torus.faces, colourings)
