"""Thermal bow: a bed, table or beam bends because one side of it is warm."""

from vmach.effects.effect import along
from vmach.effects.laws.geometry.gravity_sag import from_middle
from vmach.effects.laws.heat.warm_by_time import OfWarmthByTime
from vmach.effects.parameter import linear

__all__ = ["ThermalBow"]


class ThermalBow(OfWarmthByTime):
    """An arch over the travel of an axis that rises with warmth; its ends stay where they are."""

    name = "thermal_bow"
    title = "bed or beam that bows as one side of it warms"
    commonness = 16
    shows_as = "an arch of the bed over the travel of an axis, which rises with time"
    law = "bow (1 - m_j^2) g(τ) ê_z"
    source = (
        "equation (19) of docs/laws.md; closed form derived here: a beam of height h bends "
        "by alpha dT / h, which is an arch alpha dT l^2 / (8 h) over its length l"
    )
    parameters = (
        linear("bow_um", "rise of the tool against the part at mid-travel when warm", usual=10.0),
        OfWarmthByTime.time_constant("time to reach 63 % of the final bow"),
    )
    targets = ("X", "Y")
    rarity = 1.5
    usual_size = "10 um over a metre for 1 K between top and bottom of a bed 140 mm high"
    confirm = "straightness of the axis cold and after an hour; thermometers above and below"
    cure = "keep warm chips and coolant off the bed; warm up before finishing"

    def displacement(self, path, target, bow_um, time_constant_s):
        arch = 1.0 - from_middle(path, target) ** 2
        return along("Z", 1e-3 * bow_um * arch * self.warmth(path, time_constant_s))
