"""Would the program cut measured points if a tool's length or diameter were in another unit?

Source: the international inch of 1959, 25.4 mm; the bounds are chosen.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np

from gcode import ProgramError
from stock import Tool
from vmach.errors import InputError
from vmach.job import JobTool
from vmach.machine import Variant
from vmach.nominal.points import SurfacePoints
from vmach.path.preparation import Preparation, prepare
from vmach.prediction import predict_surface

__all__ = ["tool_that_would_cut"]

#: what a dimension may have been given in or as, by how much it then is too small
_MISTAKES = {
    "length_mm": (("in metres", 1e3), ("in inches", 25.4)),
    "diameter_mm": (("in metres", 1e3), ("in inches", 25.4), ("the radius", 2.0)),
}
#: smallest and largest of tools, mm
_USUAL_MM = {"length_mm": (10.0, 1000.0), "diameter_mm": (0.1, 250.0)}
#: share of the points that have to be cut then
_MOST = 0.5
#: and the share that leaves no question open
_NEARLY_ALL = 0.95


def tool_that_would_cut(preparation: Preparation, points: SurfacePoints) -> str | None:
    """What to look at in the job's tools, if another dimension would bring points on the part.

    Parameters
    ----------
    preparation : Preparation
    points : SurfacePoints
        A few that the program does not cut.

    Returns
    -------
    str or None
        A question; None where no tool would do.
    """
    job, best, question = preparation.job, 0.0, None
    for asked, tools in _mistaken_tools(dict(job.tools)):
        with suppress(InputError, ProgramError):  # it cannot have been so
            other = prepare(replace(job, tools=tools), program_path=preparation.program.path)
            share = float(np.mean(predict_surface(other, points, Variant.NONE).is_cut))
            if share > best:
                best, question = share, asked
            if share > _NEARLY_ALL:
                break
    return question if best >= _MOST else None


def _mistaken_tools(
    tools: dict[int, JobTool],
) -> Iterator[tuple[str, dict[int, JobTool]]]:
    """Questions, and the tools with their answer yes: about single tools, then about all."""
    sets = [[number] for number in tools]
    if len(tools) > 1:
        sets.append(list(tools))
    for key, mistakes in _MISTAKES.items():
        for numbers in sets:
            for what, factor in mistakes:
                sizes = [factor * getattr(tools[n], key) for n in numbers]
                low, high = _USUAL_MM[key]
                if not all(low <= size <= high for size in sizes):
                    continue
                said = ", ".join(f"{getattr(tools[n], key):g}" for n in numbers)
                named = "tool" + "s" * (len(numbers) > 1) + " " + ", ".join(map(str, numbers))
                changed = {n: _larger(tools[n], key, factor) for n in numbers}
                yield f"is {key} = {said} of {named} {what}?", tools | changed


def _larger(tool: JobTool, key: str, factor: float) -> JobTool:
    """The tool with one dimension that many times larger."""
    cutter = tool.cutter
    if key == "length_mm":
        top = replace(cutter.corners[-1], z_mm=factor * cutter.corners[-1].z_mm)
        cutter = replace(
            cutter, length_mm=factor * cutter.length_mm, corners=(*cutter.corners[:-1], top)
        )
        return replace(tool, cutter=cutter, length_mm=factor * tool.length_mm)
    return replace(tool, cutter=_enlarged(cutter, factor), diameter_mm=factor * tool.diameter_mm)


def _enlarged(cutter: Tool, factor: float) -> Tool:
    """The same shape, larger in all directions."""
    corners = tuple(
        replace(c, r_mm=factor * c.r_mm, z_mm=factor * c.z_mm, radius_mm=factor * c.radius_mm)
        for c in cutter.corners
    )
    return replace(
        cutter,
        diameter_mm=factor * cutter.diameter_mm,
        length_mm=factor * cutter.length_mm,
        corners=corners,
    )
