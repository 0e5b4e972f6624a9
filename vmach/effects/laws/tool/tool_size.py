"""Tool size: radius and length of a tool are not what the control believes."""

from dataclasses import replace

import numpy as np

from stock import Tool
from vmach.effects.effect import Effect, along
from vmach.effects.parameter import inner, linear

__all__ = [
    "OfOneTool",
    "Runout",
    "ToolLength",
    "ToolRadius",
    "ToolWear",
    "by_radius",
    "by_swing",
    "by_tool",
]


class OfOneTool(Effect):
    """Base of the effects that belong to one tool; the target is its number: ``T1``."""

    targets = ()

    def possible_targets(self, job):
        return tuple(f"T{number}" for number in job.tools)

    def not_testable(self, path, target):
        return None if by_tool(path, target).any() else f"no point was made by {target}"


class ToolRadius(OfOneTool):
    """The tool is thicker than in the tool table: it takes more from every wall.

    It is thicker at every height. A ball is a larger ball, and its tip stays where it was.
    """

    name = "tool_radius"
    title = "radius of the tool"
    commonness = 29
    shows_as = "walls that this tool cut"
    law = "-radius [T1] ρ n"
    source = (
        "equation (6) of docs/laws.md; closed form derived here: the support function "
        "of the tool's outline changes by ρ for one unit of radius"
    )
    parameters = (linear("radius_um", "true minus stated radius", usual=10.0),)
    is_never_exact = imitates_as_team = True
    signature = "radius of one tool"
    needs_surface = True
    usual_size = "5 to 20 um, more after regrinding"
    confirm = "measure the tool; compare a boss and a bore, whose sizes err in opposite ways"
    cure = "enter the measured radius in the tool table"

    def displacement(self, path, target, radius_um):
        return -1e-3 * radius_um * by_tool(path, target)[:, None] * by_radius(path)


class Runout(OfOneTool):
    """The tool turns off centre: its longest flute cuts at a larger radius.

    Where that flute cuts alone, feed marks of height f^2 / (8 R) stay, f the feed of one turn; a
    probe sees a third of it as material left.
    """

    name = "runout"
    title = "runout of the tool"
    commonness = 9
    shows_as = "walls that this tool cut; a flute that cuts alone leaves feed marks"
    law = "(marks_share f^2/(24 R) - runout) [T1] ν n, f the feed of one turn"
    source = (
        "equation (26) of docs/laws.md; closed form derived here: a flute of radius R leaves "
        "marks f^2 / (8 R) high, f^2 / (24 R) in the mean; an outline that swings out by "
        "r covers r ν more along the normal"
    )
    parameters = (
        replace(
            linear("runout_um", "growth of the cutting radius", usual=10.0, is_size=True),
            is_essential=True,
        ),
        replace(
            linear("marks_share", "share of the marks of a single flute that is there", usual=1.0),
            optional=True,
            is_size=True,
            most=1.0,
        ),
    )
    needs_surface = True
    imitates_as_team = True
    signature = "radius of one tool"
    rarity = 1.0
    usual_size = "3 to 20 um"
    confirm = "dial gauge on the shank at two heights, spindle turned by hand"
    cure = "clean collet and taper; clamp the tool again; balance it"

    def displacement(self, path, target, runout_um, marks_share):
        turn_mm = path.feed_per_tooth_mm * np.nan_to_num(path.of_tool("flutes"), nan=2.0)
        marks_mm = turn_mm**2 / (24.0 * 0.5 * path.of_tool("diameter_mm"))
        left_mm = marks_share * marks_mm - 1e-3 * runout_um
        return (left_mm * by_tool(path, target))[:, None] * by_swing(path)


class ToolWear(OfOneTool):
    """The cutting radius shrinks with the way that the tool has cut."""

    name = "tool_wear"
    title = "wear of the tool"
    commonness = 26
    shows_as = "walls, with the cutting length"
    law = "wear (cutting length/10 m)^exponent [T1] ρ n"
    source = (
        "equation (9) of docs/laws.md; ISO 8688-2, tool life in end milling; the power of "
        "the cutting length is empirical"
    )
    parameters = (
        linear(
            "wear_um", "loss of radius after the first ten metres of cut", usual=5.0, is_size=True
        ),
        inner(
            "exponent",
            "of the loss with the cutting length; below one where a new edge wears quickly",
            (0.5, 0.7, 0.85, 1.0, 1.4),
            usual=1.0,
            spread=0.5,
            optional=True,
        ),
    )
    needs_surface = True
    slack_share = 0.05
    usual_size = "10 um per 5 to 60 minutes of cutting"
    confirm = "measure the tool before and after; cut the first feature again at the end"
    cure = "change the tool earlier, or compensate its radius by cutting length"

    def displacement(self, path, target, wear_um, exponent):
        way = (path.cutting_length_mm / 10e3) ** exponent
        left_mm = 1e-3 * wear_um * way * by_tool(path, target)
        return left_mm[:, None] * by_radius(path)


class ToolLength(OfOneTool):
    """The tool is longer than in the tool table: it cuts too deep."""

    name = "tool_length"
    title = "length of the tool"
    commonness = 28
    shows_as = "height of what this tool cut"
    law = "-length [T1] ê_z"
    source = (
        "equation (7) of docs/laws.md; closed form derived here: a floor lies off by the "
        "change of length"
    )
    parameters = (linear("length_um", "true minus stated length", usual=15.0),)
    is_never_exact = imitates_as_team = True
    needs_surface = True
    usual_size = "5 to 30 um"
    confirm = "touch off all tools on one surface"
    cure = "measure the tool again and enter its length"

    def displacement(self, path, target, length_um):
        return along("Z", -1e-3 * length_um * by_tool(path, target))

    def tool_shift(self, path, target, **parameters):
        return self.displacement(path, target, **parameters)


def by_tool(path, target: str) -> np.ndarray:
    """1 where the state belongs to the tool ``T1`` ..., else 0; (P,)."""
    return (path.tool == int(target[1:])).astype(float)


def by_radius(path) -> np.ndarray:
    """How far a surface lies off, along its outward normal, for one unit of the tool's radius.

    (P, 3). An outline that is wider at every height moves a surface by the part of its normal
    across the tool; a ball whose tip stays moves it by 1 - n_z.
    """
    balls = [number for number, tool in path.job.tools.items() if _ends_in_a_ball(tool.cutter)]
    ball_share = 1.0 - path.normal[:, 2:]
    share = np.linalg.norm(path.side_normal, axis=1, keepdims=True)
    return np.where(np.isin(path.tool, balls)[:, None], ball_share, share) * path.normal


def by_swing(path) -> np.ndarray:
    """The same for one unit by which the outline swings out of the tool's axis, (P, 3)."""
    return np.linalg.norm(path.side_normal, axis=1, keepdims=True) * path.normal


def _ends_in_a_ball(cutter: Tool) -> bool:
    """Whether the rounding at the tip has its centre on the axis, as that of a ball end mill."""
    return cutter.corners[0].r_mm == 0.0 and cutter.corners[0].radius_mm > 0.0
