"""Sag under gravity: a beam bends under the weight that travels on it."""

import numpy as np

from vmach.effects.effect import Effect, along
from vmach.effects.parameter import linear
from vmach.machine import LINEAR_AXES

__all__ = ["GravitySag", "TableLoadSag", "from_middle"]


class GravitySag(Effect):
    """A drop with the square of the way from the middle of the travel."""

    name = "gravity_sag"
    title = "sag of a beam or ram under its weight"
    commonness = 17
    shows_as = "square of the distance from mid-travel"
    law = "-sag m_j^2 ê_z"
    source = (
        "equation (18) of docs/laws.md; Euler-Bernoulli beam on two supports: a load at u "
        "sinks by (1 - u^2)^2 of its sag at the middle, 1 - 2 u^2 near there, so that sag_um "
        "is negative for such a beam under the tool"
    )
    parameters = (
        linear("sag_um", "drop at the ends of the travel against its middle", usual=10.0),
    )
    targets = ("X", "Y")
    rarity = 1.5
    usual_size = "10 um for 100 N at the end of a slim 250 mm arm"
    confirm = "straightness of the axis with and without added weight"
    cure = "set straightness compensation, or counterbalance the weight"

    def displacement(self, path, target, sag_um):
        return along("Z", -1e-3 * sag_um * from_middle(path, target) ** 2)


class TableLoadSag(Effect):
    """The guides give way under a heavy part in proportion to its overhang, cubed."""

    name = "table_load_sag"
    title = "sag of the table under the workpiece"
    commonness = 3
    shows_as = "cube of the distance from mid-travel"
    law = "sag m_j^3 ê_z"
    source = (
        "equation (32) of docs/laws.md; Euler-Bernoulli cantilever, P L^3 / (3 E I), L the overhang"
    )
    parameters = (
        linear("sag_um", "drop at the upper end of the travel, rise at the lower", usual=10.0),
    )
    targets = ("X", "Y")
    rarity = 2.5
    usual_size = "5 to 20 um for half the permitted load"
    confirm = "measure flatness of the axis' motion with the table empty and loaded"
    cure = "clamp heavy parts over the guides, or compensate by load"

    def displacement(self, path, target, sag_um):
        return along("Z", 1e-3 * sag_um * from_middle(path, target) ** 3)


def from_middle(path, target: str) -> np.ndarray:
    """Axis position, -1 to 1 over the travel, (P,)."""
    axis = LINEAR_AXES.index(target)
    low, high = path.job.machine.travel_mm[:, axis]
    return (2.0 * path.nose_mm[:, axis] - low - high) / (high - low)
