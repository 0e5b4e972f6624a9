"""A step whose moment is not known: which of equally deep passes made a surface beside it.

Source: closed form derived here: of passes at times t_k the step s H(t - t_0) leaves
min_k s H(t_k - t_0). That is s H(min t_k - t_0) where s raises the tool, and s H(max t_k - t_0)
where it lowers it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from vmach.effects.instance import EffectInstance
from vmach.machine import RigidDisplacement
from vmach.path.toolpath import PathStates

__all__ = ["AtAnyMoment"]

#: of the step, over the whole program: far below any reading, far above rounding; chosen
_SHARE = 1e-2


@dataclass(frozen=True)
class AtAnyMoment:
    """Lets the first of equally deep passes count where a step raises the tool, else the last.

    Attributes
    ----------
    step : EffectInstance
        Of a sudden effect, its inner parameter ``time_s``.
    """

    step: EffectInstance

    @property
    def label(self) -> str:
        """Name and target."""
        return self.step.label

    def displacement(self, states: PathStates) -> RigidDisplacement:
        """Nothing: what moves is the order of passes."""
        return RigidDisplacement.zero(len(states))

    def at_surface(self, states: PathStates) -> np.ndarray:
        """Nothing."""
        return np.zeros((len(states), 3))

    def tool_shift(self, states: PathStates) -> np.ndarray:
        """The whole step times the share of the program's time that has passed, (P, 3) mm."""
        at_once = replace(self.step, parameters={**self.step.parameters, "time_s": -math.inf})
        passed = states.time_s / max(float(states.time_s.max(initial=0.0)), 1.0)
        return _SHARE * passed[:, None] * at_once.tool_shift(states)

    def uncertainty_patterns(self, states: PathStates) -> np.ndarray:
        """Nothing."""
        return np.zeros((len(states), 3, 0))
