"""Cards of all effects: what each is, its parameters, and the sliders that they make."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from vmach.effects import Effect, EffectInstance, Parameter, catalogue
from vmach.effects.declaration import unit_of
from vmach.workbench.model.part_model import PartModel

__all__ = ["effect_cards"]

#: ends of the slider of an amplitude, in usual sizes; a value in the job widens it
_TIMES_USUAL, _TIMES_VALUE = 3.0, 2.0
#: the interval of 95 % in standard uncertainties
_COVERAGE = 1.96


def effect_cards(model: PartModel) -> list[dict[str, Any]]:
    """A card for every effect and target that sliders can move, those of the job first."""
    from vmach.diagnosis.words import describe  # late: the picture needs no diagnosis

    in_job = {(e.effect.name, e.target): e for e in model.effects}
    cards = []
    for effect in catalogue().values():
        for target in effect.possible_targets(model.job):
            acting = in_job.get((effect.name, target))
            if acting is not None or not effect.corrects_table:
                cards.append(_card(effect, target, acting) | describe(effect))
    return sorted(cards, key=lambda card: not card["in_job"])


def _card(effect: Effect, target: str, acting: EffectInstance | None) -> dict[str, Any]:
    sliders = [] if effect.corrects_table else [_slider(p, acting) for p in effect.parameters]
    return {
        "effect": effect.name,
        "target": target,
        "title": effect.title,
        "in_job": acting is not None,
        "parameters": sliders,
    }


def _slider(parameter: Parameter, acting: EffectInstance | None) -> dict[str, Any]:
    """A slider; it starts at the job's value, at nothing, or at what is usual."""
    start = 0.0 if parameter.is_linear else parameter.usual
    value = start if acting is None else float(acting.parameters[parameter.name])
    if parameter.is_linear:
        end = max(_TIMES_USUAL * parameter.usual, _TIMES_VALUE * abs(value))
        low, high = (0.0 if parameter.is_size else -end), end
    else:
        low, high = min(*parameter.grid, value), max(*parameter.grid, value)
    return {
        "name": parameter.name,
        "meaning": parameter.meaning,
        "unit": unit_of(parameter.name),
        "is_amplitude": parameter.is_linear,
        "is_logarithmic": not parameter.is_linear and low > 0 and high > 10 * low,
        "low": max(low, parameter.low),
        "high": min(high, parameter.high),
        "usual": parameter.usual,
        "value": value,
        "half_width": None if acting is None else _half_width(parameter.name, acting),
    }


def _half_width(name: str, acting: EffectInstance) -> float | None:
    """Half of the interval of 95 %; None where the job does not state it."""
    u = math.sqrt(sum(float(np.square(change.get(name, 0.0))) for change in acting.one_sigma))
    return _COVERAGE * u if u else None
