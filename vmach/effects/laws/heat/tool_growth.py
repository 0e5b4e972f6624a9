"""Tool growth: a tool lengthens while it cuts, and cools in the magazine."""

import numpy as np

from vmach.effects.effect import Effect, along
from vmach.effects.parameter import inner, linear

__all__ = ["ToolGrowth"]


class ToolGrowth(Effect):
    """Every tool warms in its first minutes in the spindle: its later floors are deeper."""

    name = "tool_growth"
    title = "growth of the tools in the cut"
    commonness = 15
    shows_as = "every tool lengthens in its first minutes in the spindle and cools outside"
    law = "-growth g_T(τ) ê_z, g_T the warmth of the tool, which cuts or cools"
    source = (
        "equation (20) of docs/laws.md; closed form derived here: one body warms by Newton's "
        "law, dL = alpha L dT"
    )
    parameters = (
        linear("growth_um", "lengthening when warm", usual=10.0, is_size=True),
        inner(
            "time_constant_s",
            "time to reach 63 % of the final growth",
            (40, 80, 160, 320, 640),
            usual=160.0,
            spread=0.7,
        ),
    )
    targets = ("",)
    needs_surface = True
    rarity = 1.5
    slack_share = 0.1
    slack_time_s = 300.0
    usual_size = "5 to 20 um within 1 to 5 minutes of cutting, more when dry"
    confirm = "measure the tool's length before and right after a long cut"
    cure = "coolant on the tool; let it cut before it finishes; measure it warm"

    def displacement(self, path, target, growth_um, time_constant_s):
        return along("Z", -1e-3 * growth_um * _warmth(path, time_constant_s))

    def tool_shift(self, path, target, **parameters):
        return self.displacement(path, target, **parameters)


def _warmth(path, time_constant_s: float) -> np.ndarray:
    """Warmth of the tool in the spindle, which turns and cuts or waits outside, (P,)."""
    warmth, turns = np.zeros(len(path)), path.moves.spindle_rpm != 0.0
    for number in np.unique(path.tool):
        own = path.tool == number
        cuts = (turns & (path.moves.tool == number)).astype(float)
        warmth[own] = path.history.spindle_warmth(cuts, time_constant_s, path.time_s[own])
    return warmth
