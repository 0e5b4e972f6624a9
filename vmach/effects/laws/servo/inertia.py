"""Inertia: what an axis carries bends the structure while it is accelerated."""

from vmach.effects.effect import Effect, along
from vmach.effects.laws.servo.servo import POLYLINE_SHARE, acceleration_on_curves
from vmach.effects.parameter import linear
from vmach.machine import LINEAR_AXES

__all__ = ["Inertia"]


class Inertia(Effect):
    """The tool runs wide on curves, by mass times acceleration over stiffness: e = -m a / k.

    Circles come out too large along the axis that carries the mass; servo lag makes them too
    small on all axes alike. Only the acceleration towards the centre of curves counts: how a
    control ramps the speed up and down is not known.
    """

    name = "inertia"
    title = "moving mass bends the structure (circles too large along one axis)"
    follows_travel = True
    commonness = 4
    shows_as = "curves, away from the centre, along the axis that carries the mass"
    law = "-sway a_j ê_j, with sway = m/k"
    source = (
        "equation (31) of docs/laws.md; closed form derived here: a spring far below its "
        "resonance gives way by m a / k"
    )
    parameters = (
        linear("sway_ms2", "moving mass over stiffness, m / k", usual=5.0, is_size=True),
        POLYLINE_SHARE,
    )
    rarity = 1.0
    slack_share = 0.04
    usual_size = "1 to 10 um at 1 to 5 m/s2"
    confirm = "circle at two feeds by ballbar: it grows with feed squared, the scales show nothing"
    cure = "less feed on small radii, lower acceleration and jerk, or a stiffer structure"

    def displacement(self, path, target, sway_ms2, polyline_share):
        acceleration = acceleration_on_curves(path, polyline_share)
        return along(target, -1e-6 * sway_ms2 * acceleration[:, LINEAR_AXES.index(target)])
