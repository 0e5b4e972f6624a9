"""Tool slip: at one moment a tool moves in its holder and keeps another length from then on."""

import numpy as np

from vmach.effects.effect import along
from vmach.effects.laws.tool.sudden import Sudden, moment
from vmach.effects.laws.tool.tool_size import OfOneTool, by_tool
from vmach.effects.parameter import linear

__all__ = ["ToolSlip"]

#: a surface that leans less than this (cosine) says nothing of a length
_LEVEL = 0.05


class ToolSlip(Sudden, OfOneTool):
    """A collet lets go under load; what the tool cut before has the height that it should."""

    name = "tool_slip"
    title = "tool that slipped in its holder"
    commonness = 12
    shows_as = "height of what this tool cut after a moment: it moved in its holder"
    law = "-slip H(t - t_0) [T1] ê_z"
    source = (
        "equation (23) of docs/laws.md; closed form derived here: the length changes by a "
        "step in time"
    )
    parameters = (
        linear("slip_um", "how far it came out", usual=15.0),
        moment("when it slipped"),
    )
    needs_surface = True
    rarity = 1.0
    usual_size = "5 to 100 um"
    confirm = "measure the tool's length again and compare with the tool table"
    cure = "clean collet and shank, tighten to the stated torque, take a holder that grips harder"

    def sees(self, path, target):
        """A slip before the tool's first level, or after its last, is none to these points."""
        own = by_tool(path, target) > 0.0
        return own if path.states.normal is None else own & (np.abs(path.normal[:, 2]) > _LEVEL)

    def displacement(self, path, target, slip_um, time_s):
        slipped = by_tool(path, target) * (path.time_s > time_s)
        return along("Z", -1e-3 * slip_um * slipped)

    def tool_shift(self, path, target, **parameters):
        return self.displacement(path, target, **parameters)
