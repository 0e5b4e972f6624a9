"""Effects of reversal that depend on the way, or the time, since it."""

from abc import abstractmethod
from dataclasses import replace

import numpy as np

from vmach.effects.effect import Effect, along
from vmach.effects.parameter import inner, linear
from vmach.machine import LINEAR_AXES
from vmach.path.circumstances import Circumstances

__all__ = [
    "TAKE_UP_MM",
    "Hysteresis",
    "LateralPlay",
    "OfReversal",
    "QuadrantGlitch",
    "share_taken_up",
]


#: ways over which lost motion may be taken up
TAKE_UP_MM = (0.0025, 0.01, 0.03, 0.1)
#: side of the play from which on an axis surely lies against it; below, it crosses the play
_SURE = 1.0 - 1e-6
#: decimals of the time, s, by which turns of an axis are told apart; chosen
_DECIMALS = 3
#: guides with more than this are broken; it then is a slope with the way that looks like a loop
_WIDEST_LOOP_UM = 20.0


def share_taken_up(path: Circumstances, axis: int, travel_mm: float) -> np.ndarray:
    """Going over from -1 to +1 with the way since an axis reversed, (P,)."""
    return 1.0 - 2.0 * np.exp(-path.travel_since_reversal_mm[:, axis] / travel_mm)


class OfReversal(Effect):
    """Base of the effects that change sides where an axis reverses.

    Just where it does, no reading tells on which side it lies: that is left open. The side is then
    one or the other, of which `play_side` is the mean.
    """

    follows_travel = True
    slack_share = 1.0

    @abstractmethod
    def on_one_side(self, path: Circumstances, target: str, **parameters: float) -> np.ndarray:
        """Displacement where the axis came in positive direction, (P, 3) mm."""

    def axis(self, target: str) -> int:
        """Number of the axis that reverses, the first that a target names."""
        return LINEAR_AXES.index(target[0])

    def displacement(self, path, target, **parameters):
        side = path.play_side[:, self.axis(target), None]
        return side * self.on_one_side(path, target, **parameters)

    def slack(self, path, target, parameters):
        axis = self.axis(target)
        side = path.play_side[:, axis]
        unsure = np.flatnonzero((np.abs(side) < _SURE) & (side != 0.0))
        # until it has crossed its play an axis stays on the side where it was when it turned
        turned_s = path.time_s[unsure] - path.time_since_reversal_s[unsure, axis]
        turns, which = np.unique(np.round(turned_s, _DECIMALS), return_inverse=True)
        columns = np.zeros((len(side), 3, len(turns)))
        spread = np.sqrt(1.0 - side[unsure] ** 2)[:, None]
        columns[unsure, :, which] = spread * self.on_one_side(path, target, **parameters)[unsure]
        return columns


class QuadrantGlitch(OfReversal):
    """Friction holds the axis back for a moment after it reverses."""

    name = "quadrant_glitch"
    title = "reversal spike (friction at the quadrants)"
    commonness = 8
    shows_as = "just after a reversal"
    law = "-spike s (1 - exp(-d/sticks)) exp(-d/travel) ê_j, s = ±1"
    source = (
        "equation (27) of docs/laws.md; ISO 230-4, circular tests; closed form derived here: "
        "a spike rises as 1 - exp(-s / w) while the axis sticks, and fades as exp(-s / w)"
    )
    parameters = (
        linear("spike_um", "displacement soon after the reversal", usual=5.0),
        inner(
            "travel_mm",
            "travel over which it fades to 37 %",
            (0.02, 0.05, 0.1, 0.25, 0.6, 1.5),
            usual=0.3,
        ),
        inner(
            "sticks_mm",
            "travel over which the axis sticks, while the spike rises to 63 %",
            (0.001, 0.01, 0.05),
            usual=0.001,
            spread=1.5,
            optional=True,
        ),
    )
    rarity = 1.0
    usual_size = "2 to 10 um over 0.1 to 1 mm"
    confirm = "ballbar at two feeds: spikes at the quadrants, higher with feed"
    cure = "set the control's friction compensation; lubricate"

    def on_one_side(self, path, target, spike_um, travel_mm, sticks_mm):
        way = path.travel_since_reversal_mm[:, self.axis(target)]
        # an axis that sticks falls behind by what is commanded: it does not jump
        rise = -np.expm1(-way / sticks_mm)
        return along(target, -1e-3 * spike_um * rise * np.exp(-way / travel_mm))


class Hysteresis(OfReversal):
    """The structure springs back only with the way gone since the reversal."""

    name = "hysteresis"
    title = "hysteresis of guide and structure"
    commonness = 7
    shows_as = "builds up with the travel since the reversal"
    law = "-(width/2) s_j(travel) ê_j"
    source = (
        "equation (28) of docs/laws.md; P. Dahl, A Solid Friction Model (1968): F / F_c = 1 "
        "- 2 exp(-s / w) after a reversal"
    )
    parameters = (
        replace(
            linear("width_um", "width of the loop", usual=5.0, is_size=True), most=_WIDEST_LOOP_UM
        ),
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

    def on_one_side(self, path, target, width_um, travel_mm):
        share = share_taken_up(path, self.axis(target), travel_mm)
        return along(target, -0.5e-3 * width_um * share)


class LateralPlay(OfReversal):
    """The carriage shifts sideways when its axis reverses; target ``XY``: X moves, Y shifts."""

    name = "lateral_play"
    title = "lateral play of a guide"
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

    def on_one_side(self, path, target, play_um, take_up_mm):
        share = share_taken_up(path, self.axis(target), take_up_mm)
        return along(target[1], 0.5e-3 * play_um * share)
