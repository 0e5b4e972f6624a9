"""Tool chip: at one moment an edge of a tool breaks, and it cuts too little from then on."""

from vmach.effects.effect import along
from vmach.effects.laws.tool.sudden import Sudden, moment
from vmach.effects.laws.tool.tool_size import OfOneTool, by_radius, by_tool
from vmach.effects.parameter import linear

__all__ = ["ToolChip"]


class ToolChip(Sudden, OfOneTool):
    """The edge chips, and leaves material on every wall and on every floor that follow.

    A chip at the corner shortens the tool, one on the flank takes from its radius, most do both.
    """

    name = "tool_chip"
    title = "tool whose edge chipped"
    commonness = 11
    shows_as = "walls and floors that this tool cut after a moment: an edge broke, material is left"
    law = "(radius ρ n + length ê_z) H(t - t_0) [T1]"
    source = (
        "equation (24) of docs/laws.md; closed form derived here: radius and length change "
        "by a step in time"
    )
    parameters = (
        linear("radius_um", "loss of cutting radius", usual=10.0, is_size=True),
        linear("length_um", "loss of length", usual=10.0, is_size=True),
        moment("when it chipped"),
    )
    needs_surface = True
    rarity = 1.0
    usual_size = "5 to 50 um while it still cuts"
    confirm = "look at the edges under a magnifier; measure the tool's length and radius again"
    cure = "change the tool; less feed or engagement at entry, a tougher grade, less stick-out"

    def sees(self, path, target):
        """A chip before the tool's first point, or after its last, is none to these points."""
        return by_tool(path, target) > 0.0

    def displacement(self, path, target, radius_um, length_um, time_s):
        chipped = by_tool(path, target) * (path.time_s > time_s)
        walls = 1e-3 * radius_um * chipped[:, None] * by_radius(path)
        return walls + self.tool_shift(path, target, length_um, time_s)

    def tool_shift(self, path, target, length_um, time_s, **_):
        return along("Z", 1e-3 * length_um * by_tool(path, target) * (path.time_s > time_s))
