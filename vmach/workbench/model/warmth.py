"""How warm spindle and axes are along the program: the states that thermal effects follow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vmach.effects import Circumstances, catalogue
from vmach.machine import LINEAR_AXES
from vmach.workbench.model.part_model import PartModel

__all__ = ["WarmState", "warm_states"]

#: effects whose parameters say how fast spindle and axes warm
_OF_SPINDLE, _OF_AXIS = "spindle_growth", "axis_expansion"


@dataclass(frozen=True)
class WarmState:
    """The warmth of one body at K nodes.

    Attributes
    ----------
    name : str
        "Spindle", or the axis.
    reference : str
        What a warmth of 1 means.
    time_constant_s : float
    is_of_job : bool
        Whether the job has an effect that states the time constant; else it is a usual one.
    warmth : (K,) float64
    """

    name: str
    reference: str
    time_constant_s: float
    is_of_job: bool
    warmth: np.ndarray

    def record(self) -> dict[str, Any]:
        """For the page, without the array."""
        return {key: value for key, value in vars(self).items() if key != "warmth"}


def warm_states(model: PartModel, path: Circumstances) -> list[WarmState]:
    """Warmth of the spindle and of each axis; empty without the effects of the catalogue."""
    if not {_OF_SPINDLE, _OF_AXIS} <= catalogue().keys():
        return []
    given, is_of_job = _parameters(model, _OF_SPINDLE, "Z")
    tau = given["time_constant_s"]
    warmth = path.warmth_of_spindle(tau, given["speed_exponent"])
    found = [WarmState("Spindle", "warm at 8000 1/min", tau, is_of_job, warmth)]
    for number, axis in enumerate(LINEAR_AXES):
        given, is_of_job = _parameters(model, _OF_AXIS, axis)
        tau = given["time_constant_s"]
        warmth = path.warmth_of_axis(number, tau, given["work_share"])
        found.append(WarmState(axis, "warm at 100 mm/min", tau, is_of_job, warmth))
    return found


def _parameters(model: PartModel, effect: str, target: str) -> tuple[dict[str, float], bool]:
    """Parameters of an effect in the job, or usual ones."""
    for acting in model.effects:
        if (acting.effect.name, acting.target) == (effect, target):
            return dict(acting.parameters), True
    return {p.name: p.usual for p in catalogue()[effect].parameters}, False
