"""Effects of reversal that depend on the way, or the time, since it."""

from dataclasses import replace

import numpy as np

from vmach.effects.effect import Effect, along
from vmach.effects.parameter import inner, linear
from vmach.machine import LINEAR_AXES
from vmach.path.circumstances import Circumstances

__all__ = ["TAKE_UP_MM", "Hysteresis", "LateralPlay", "QuadrantGlitch", "taken_up"]


#: ways over which lost motion may be taken up
TAKE_UP_MM = (0.0025, 0.01, 0.03, 0.1)
#: guides with more than this are broken; it then is a slope with the way that looks like a loop
_WIDEST_LOOP_UM = 20.0


def taken_up(path: Circumstances, axis: int, travel_mm: float) -> np.ndarray:
    """Side of an axis, going over from -1 to +1 with the way since it reversed, (P,)."""
    gone = np.exp(-path.travel_since_reversal_mm[:, axis] / travel_mm)
    return path.play_side[:, axis] * (1.0 - 2.0 * gone)


class QuadrantGlitch(Effect):
    """Friction holds the axis back for a moment after it reverses."""

    name = "quadrant_glitch"
    title = "reversal spike (friction at the quadrants)"
    follows_travel = True
    commonness = 8
    shows_as = "just after a reversal"
    law = "-spike s exp(-d/travel) ê_j, s = ±1"
    source = (
        "equation (27) of docs/laws.md; ISO 230-4, circular tests; closed form derived here: "
        "a spike fades as exp(-s / w)"
    )
    parameters = (
        linear("spike_um", "displacement right after the reversal", usual=5.0),
        inner(
            "travel_mm",
            "travel over which it fades to 37 %",
            (0.02, 0.05, 0.1, 0.25, 0.6, 1.5),
            usual=0.3,
        ),
    )
    rarity = 1.0
    usual_size = "2 to 10 um over 0.1 to 1 mm"
    confirm = "ballbar at two feeds: spikes at the quadrants, higher with feed"
    cure = "set the control's friction compensation; lubricate"

    def displacement(self, path, target, spike_um, travel_mm):
        axis = LINEAR_AXES.index(target)
        fade = np.exp(-path.travel_since_reversal_mm[:, axis] / travel_mm)
        return along(target, -1e-3 * spike_um * path.play_side[:, axis] * fade)


class Hysteresis(Effect):
    """The structure springs back only with the way gone since the reversal."""

    name = "hysteresis"
    title = "hysteresis of guide and structure"
    follows_travel = True
    commonness = 7
    shows_as = "builds up with the travel since the reversal"
    law = "-(width/2) s_j(travel) ê_j"
    source = (
        "equation (28) of docs/laws.md; P. Dahl, A Solid Friction Model (1968): F / F_c = 1 "
        "- 2 exp(-s / w) after a reversal"
    )
    parameters = (
        replace(linear("width_um", "width of the loop", usual=5.0), most=_WIDEST_LOOP_UM),
        inner(
            "travel_mm",
            "travel over which it builds up to 63 %",
            (2, 4, 8, 16, 32, 64),
            usual=10.0,
            spread=1.0,
            within=(0.5, 100.0),
        ),
    )
    rarity = 1.0
    usual_size = "1 to 5 um over 5 to 50 mm"
    confirm = "approach one position from both sides with different overruns"
    cure = "mend the guide's preload; always approach from one side with the same overrun"

    def displacement(self, path, target, width_um, travel_mm):
        side = taken_up(path, LINEAR_AXES.index(target), travel_mm)
        return along(target, -0.5e-3 * width_um * side)


class LateralPlay(Effect):
    """The carriage shifts sideways when its axis reverses; target ``XY``: X moves, Y shifts."""

    name = "lateral_play"
    title = "lateral play of a guide"
    follows_travel = True
    commonness = 6
    shows_as = "first axis reverses, second shifts"
    law = "(play/2) s_i(take_up) ê_j"
    source = (
        "equation (29) of docs/laws.md; closed form derived here: half the play to either "
        "side, taken up as 1 - 2 exp(-s / w)"
    )
    parameters = (
        linear("play_um", "sideways difference between both directions", usual=5.0),
        inner(
            "take_up_mm",
            "travel over which the carriage shifts to 63 %",
            TAKE_UP_MM,
            usual=0.005,
            spread=1.5,
            optional=True,
        ),
    )
    targets = ("XY", "XZ", "YX", "YZ", "ZX", "ZY")
    rarity = 1.0
    usual_size = "1 to 10 um"
    confirm = "dial gauge across the guide while the axis reverses"
    cure = "set the gibs or the guide's preload"

    def displacement(self, path, target, play_um, take_up_mm):
        side = taken_up(path, LINEAR_AXES.index(target[0]), take_up_mm)
        return along(target[1], 0.5e-3 * play_um * side)
