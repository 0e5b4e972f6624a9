"""Collisions of a job's program, named by NC line."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from gcode import MoveKind
from stock import Collision, Sweeps, find_collisions
from vmach.base.note import Kind, Note, in_file
from vmach.job import JobTool
from vmach.path.preparation import Preparation

__all__ = ["collision_notes", "job_collisions"]

#: more collisions than this are counted, not listed
_MOST_NOTES = 8

Outline = list[tuple[float, float]]


def job_collisions(
    preparation: Preparation, sweeps: Sweeps, *, progress: Callable[[int, int], None]
) -> tuple[Collision, ...]:
    """Rapid moves in material, and shanks or holders in the stock as it is at that time.

    Nothing can be said of a job without a blank.
    """
    job = preparation.job
    if job.blank is None:
        return ()
    tools = list(job.tools.values())
    return find_collisions(
        sweeps,
        preparation.cutters,
        job.blank.solid,
        rapid_moves=np.flatnonzero(preparation.program.moves.kind == MoveKind.RAPID),
        shanks=[_shank(tool) for tool in tools],
        holders=[_holder(tool) for tool in tools],
        progress=progress,
    )


def _shank(tool: JobTool) -> Outline | None:
    """The cylinder above the cutting part; as wide as the tool unless the job says."""
    bottom = tool.cutter.length_mm
    if bottom >= tool.length_mm:
        return None
    radius = (tool.shank_diameter_mm or tool.diameter_mm) / 2
    return [(radius, bottom), (radius, tool.length_mm)]


def _holder(tool: JobTool) -> Outline | None:
    return None if tool.holder_mm is None else [tuple(point) for point in tool.holder_mm]


def collision_notes(preparation: Preparation, collisions: Sequence[Collision]) -> list[Note]:
    """One note for each collision, the first of them, with line, tool, depth and place."""
    moves, program = preparation.program.moves, preparation.program.path
    notes: list[Note] = []
    for found in collisions[:_MOST_NOTES]:
        x, y, z = found.place_mm
        said = (
            f"collision: {found.kind}, T{moves.tool[found.move]}, "
            f"{found.depth_mm:.3g} mm deep near X{x:.1f} Y{y:.1f} Z{z:.1f}"
        )
        place = f"tool {moves.tool[found.move]}"
        note = Note.question(Kind.COLLISION, said, found.depth_mm, "mm", place=place)
        notes += in_file([note], program, int(moves.line[found.move]))
    if len(collisions) > _MOST_NOTES:
        more = len(collisions) - _MOST_NOTES
        notes.append(Note.question(Kind.COLLISION, f"{more} more collisions", more, "1"))
    return notes
