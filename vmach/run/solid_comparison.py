"""The virtual part against the nominal CAD, solid against solid, with the NC lines at fault."""

from __future__ import annotations

import numpy as np

from stock import BLANK, Difference, Surface, VirtualPart, find_differences
from vmach.base.note import Kind, Note
from vmach.nominal import NominalPart
from vmach.path.preparation import Preparation
from vmach.report import SolidComparison, SolidDifference

__all__ = ["compare_solids", "comparison_notes"]

#: how far the virtual part's facets may leave what the tools sweep, mm: twice its tolerance
_PART_CHORD_MM = 0.02

#: single triangles inside doubly curved nominal faces leave them by so many chords of the edges
_CHORDS = 3.0

#: places that are kept, the deepest ones
_MOST_PLACES = 100


def compare_solids(
    preparation: Preparation, part: VirtualPart, nominal: NominalPart, threshold_mm: float
) -> SolidComparison:
    """Where material is left or missing by more than the threshold.

    The threshold is raised to what the triangles of both solids may be off by.
    """
    least_mm = _PART_CHORD_MM + _CHORDS * nominal.mesh_chord_mm
    threshold_mm = max(threshold_mm, least_mm)
    found = find_differences(
        Surface(part.vertices_mm, part.triangles),
        Surface(nominal.mesh.vertices_mm, nominal.mesh.triangles),
        threshold_mm,
    )
    return SolidComparison(
        threshold_mm=threshold_mm,
        count=len(found),
        places=tuple(_place(one, preparation, part, nominal) for one in found[:_MOST_PLACES]),
    )


def _place(
    one: Difference, preparation: Preparation, part: VirtualPart, nominal: NominalPart
) -> SolidDifference:
    move, moves = int(part.move[one.part_triangle]), preparation.program.moves
    face = nominal.faces[int(nominal.mesh.face[one.nominal_triangle])]
    return SolidDifference(
        depth_mm=one.depth_mm,
        point_mm=tuple(one.point_mm.tolist()),
        size_mm=tuple(np.subtract(one.high_mm, one.low_mm).tolist()),
        area_mm2=one.area_mm2,
        volume_mm3=one.volume_mm3,
        feature=face.name,
        line=0 if move == BLANK else int(moves.line[move]),
        tool=0 if move == BLANK else int(moves.tool[move]),
    )


def comparison_notes(comparison: SolidComparison | None) -> list[Note]:
    """One note where the solids differ."""
    if comparison is None or not comparison.count:
        return []
    excess = sum(one.depth_mm > 0.0 for one in comparison.places)
    worst = comparison.places[0]
    kind = "is left" if worst.depth_mm > 0.0 else "is missing"
    said = (
        f"the virtual part differs from the nominal CAD by more than "
        f"{comparison.threshold_mm:g} mm in {comparison.said} ({excess} excess, "
        f"{len(comparison.places) - excess} gouge, of the {len(comparison.places)} deepest): "
        f"up to {abs(worst.depth_mm):.3f} mm {kind} on {worst.feature}"
    )
    place = worst.feature
    return [Note.plain(Kind.DIFFERENCE, said, abs(worst.depth_mm), "mm", place=place)]
