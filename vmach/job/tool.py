"""The tools of a job, each in its holder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stock import StockError, Tool, make_tool
from vmach.errors import InputError
from vmach.job.schema import ToolEntry

__all__ = ["JobTool", "read_tool"]


#: keys of a tool that its cutting part is made from
_CUTTER_DIMENSIONS = {
    "diameter_mm",
    "length_mm",
    "corner_radius_mm",
    "tip_diameter_mm",
    "angle_deg",
    "flute_length_mm",
}


@dataclass(frozen=True)
class JobTool:
    """A tool in its holder; lengths in mm.

    Attributes
    ----------
    number : int
        As in the program's T word.
    cutter : stock.Tool
        The cutting part, tip at the origin.
    diameter_mm, length_mm : float
        Cutting diameter; distance from spindle nose to tip.
    flutes : int or None
    shank_diameter_mm : float or None
        Above the cutting part.
    holder_mm : (K, 2) float64 or None
        Outline (r, z) of the holder, z from the tip.
    name : str
        By which a program may call it.
    """

    number: int
    cutter: Tool
    diameter_mm: float
    length_mm: float
    flutes: int | None = None
    shank_diameter_mm: float | None = None
    holder_mm: np.ndarray | None = None
    name: str = ""


def _accepted(shape: str) -> str:
    if shape == "profile":
        return "diameter_mm, length_mm, profile_mm"
    return "profile_mm of a tool with shape = 'profile'"


def read_tool(number: int, tool: ToolEntry, where: dict[str, Any]) -> JobTool:
    """A tool of a job file.

    Raises
    ------
    InputError
        Dimensions that make no cutter, or a holder without an outline.
    """
    given = tool.model_dump(exclude_none=True, include=_CUTTER_DIMENSIONS)
    is_profile = tool.shape == "profile"
    if is_profile and tool.profile_mm is None:
        raise InputError(f"tool {number}: profile tool lacks profile_mm", **where,
                         accepted="pairs of radius and height from the bottom up")  # fmt: skip
    idle = [*({*given} - {"diameter_mm", "length_mm"})] if is_profile else ["profile_mm"]
    for key in sorted(idle):
        if getattr(tool, key) is not None:
            raise InputError(f"tool {number}: {key} does nothing for a {tool.shape} tool", **where,
                             accepted=_accepted(tool.shape))  # fmt: skip
    if is_profile:
        given = {"points_mm": tool.profile_mm or []}
    try:
        cutter = make_tool(tool.shape, **given)
    except StockError as error:
        raise InputError(f"tool {number}: {error}", **where) from None
    holder = tool.holder_mm
    if holder is not None and (len(holder) < 2 or max(r for r, _ in holder) == 0.0):
        raise InputError(
            f"tool {number}: holder_mm = {[list(point) for point in holder]}",
            **where,
            accepted="two or more pairs of radius and height above the tip, from the lowest up",
        )
    return JobTool(
        number=number,
        cutter=cutter,
        diameter_mm=tool.diameter_mm,
        length_mm=tool.length_mm,
        flutes=tool.flutes,
        shank_diameter_mm=tool.shank_diameter_mm,
        holder_mm=None if tool.holder_mm is None else np.array(tool.holder_mm),
        name=tool.name,
    )
