"""Servo drives: the axes lag behind their commands."""

import numpy as np

from vmach.effects.effect import Effect
from vmach.effects.parameter import inner, linear
from vmach.machine import LINEAR_AXES
from vmach.path.circumstances import Circumstances

__all__ = [
    "POLYLINE_SHARE",
    "CornerRounding",
    "ServoLag",
    "ServoMismatch",
    "acceleration_on_curves",
]

#: Z component of a floor's normal, at least
_FLOOR = 0.99
#: an axis that is slower than this stands; far below any feed, far above rounding
_MOVES_MM_PER_S = 1e-6

POLYLINE_SHARE = inner(
    "polyline_share",
    "share of the curvature of short straight moves that counts, beside true arcs",
    (0.02, 1.0),
    usual=1.0,
    spread=3.0,
    optional=True,
)


def acceleration_on_curves(path: Circumstances, polyline_share: float) -> np.ndarray:
    """Towards the centre, (P, 3) mm/s2: controls round off short straight moves or do not."""
    share = np.where(path.on_arc, 1.0, polyline_share)
    return share[:, None] * path.acceleration_mm_per_s2


class ServoLag(Effect):
    """Circles come out too small: e = a / (2 Kv^2) towards the centre."""

    name = "servo_lag"
    title = "lag of the position loop (circles too small)"
    follows_travel = True
    commonness = 22
    shows_as = "curves, towards the centre"
    law = "(lag/2) a, with lag = 1/Kv^2"
    source = (
        "equation (13) of docs/laws.md; closed form derived here: on a circle the size of 1 "
        "/ (1 + j w / Kv) is 1 - (w / Kv)^2 / 2, so that the radius shrinks by a / (2 Kv^2)"
    )
    parameters = (
        linear("lag_ms2", "square of the time constant 1/Kv", usual=25.0),
        POLYLINE_SHARE,
    )
    targets = ("",)
    slack_share = 0.04
    usual_size = "6 um at 4 m/min on a radius of 150 mm with Kv 50 1/s"
    confirm = "ballbar or a milled circle at two feeds: the shrinking goes with feed squared"
    cure = "raise Kv or switch feed-forward on; less feed on small radii"

    def displacement(self, path, target, lag_ms2, polyline_share):
        return 0.5e-6 * lag_ms2 * acceleration_on_curves(path, polyline_share)


class ServoMismatch(Effect):
    """One axis lags more than the other: circles turn into ellipses at 45 degrees."""

    name = "servo_mismatch"
    title = "position loops of two axes do not match"
    follows_travel = True
    commonness = 23
    shows_as = "along the velocity, opposite on two axes"
    law = "(mismatch/2) (v_i ê_i - v_j ê_j)"
    source = (
        "equation (12) of docs/laws.md; ISO 230-4, circular tests; closed form derived here: "
        "an axis lags by v / Kv, half of the difference each"
    )
    parameters = (
        linear("mismatch_ms", "lag of the second axis minus lag of the first", usual=0.3),
    )
    targets = ("XY", "XZ", "YZ")
    usual_size = "13 um at 4 m/min for 2 % difference at Kv 50 1/s"
    confirm = "ballbar both ways round: the ellipse changes its side with the direction"
    cure = "set equal Kv on both axes"

    def displacement(self, path, target, mismatch_ms):
        first, second = (LINEAR_AXES.index(axis) for axis in target)
        share = np.zeros(3)
        share[first], share[second] = 0.5, -0.5
        return 1e-3 * mismatch_ms * share * path.velocity_mm_per_s

    def not_testable(self, path, target):
        own = [LINEAR_AXES.index(axis) for axis in target]
        together = np.all(np.abs(path.velocity_mm_per_s[:, own]) > _MOVES_MM_PER_S, axis=1)
        return None if together.any() else f"{target[0]} and {target[1]} never move together"


class CornerRounding(Effect):
    """After a corner the axes take a moment to catch up.

    The velocity does not jump: it changes evenly over a short time, and every part of the change
    is followed late by the position loop.
    """

    name = "corner_rounding"
    title = "corners rounded by lag and look-ahead"
    follows_travel = True
    commonness = 5
    shows_as = (
        "just after corners: the velocity changes within the rise time, the position loop "
        "follows late"
    )
    law = "lag Δv (exp(min(r - x, 0)) - exp(-x))/r, x = time since the corner/τ, r = rise/τ"
    source = (
        "equation (30) of docs/laws.md; closed form derived here: the lag 1 / (1 + s / Kv) "
        "of a velocity that changes evenly"
    )
    parameters = (
        linear("lag_ms", "lag right at the corner", usual=10.0),
        inner("time_constant_ms", "decay after the corner", (3, 6, 12, 25, 50, 100), usual=20.0),
        inner(
            "rise_ms",
            "time in which the velocity changes",
            (0.5, 2.0, 8.0),
            usual=2.0,
            spread=1.0,
            optional=True,
        ),
    )
    targets = ("",)
    usual_size = "5 to 50 um with look-ahead, 170 um at 1 m/min and Kv 50 1/s without"
    confirm = "cut the same corner at three feeds, and once with exact stop (G9)"
    cure = "exact stop or a tighter contour tolerance (G64, G61.1) at the corners that matter"

    def displacement(self, path, target, lag_ms, time_constant_ms, rise_ms):
        jump, elapsed = path.corner
        since, rise = elapsed / (1e-3 * time_constant_ms), rise_ms / time_constant_ms
        fade = (np.exp(np.minimum(rise - since, 0.0)) - np.exp(-since)) / rise
        late = 1e-3 * lag_ms * fade[:, None] * jump
        if path.states.normal is not None:
            # on a floor the deepest moment counts: the tool still arrives after it was late
            late[path.normal[:, 2] > _FLOOR, 2] = 0.0
        return late
