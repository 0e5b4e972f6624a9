"""Physical effects beyond the error tables: one file an effect, joined by the catalogue."""

from vmach.effects.any_moment import AtAnyMoment
from vmach.effects.catalogue import catalogue
from vmach.effects.effect import Displaced, Effect, along, label_of
from vmach.effects.effect_file import load_effect_file
from vmach.effects.instance import EffectInstance
from vmach.effects.job_effects import read_effects, set_up_effect
from vmach.effects.parameter import Parameter, inner, linear
from vmach.path.circumstances import Circumstances

__all__ = [
    "AtAnyMoment",
    "Circumstances",
    "Displaced",
    "Effect",
    "EffectInstance",
    "Parameter",
    "along",
    "catalogue",
    "inner",
    "label_of",
    "linear",
    "load_effect_file",
    "read_effects",
    "set_up_effect",
]
