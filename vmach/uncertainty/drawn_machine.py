"""One draw of all corrections, as something that acts on the tool wherever it is asked for.

What a law leaves open is new in every run and is not drawn here.

Source: JCGM 101:2008, 6.4.7 and 6.4.9 (distributions of the corrections).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vmach.effects import EffectInstance
from vmach.effects.correlated import acting_together
from vmach.machine import Machine, RigidDisplacement, Variant
from vmach.path.toolpath import PathStates
from vmach.uncertainty.tables import Cause, TableUncertainty

__all__ = ["DrawnTables", "drawn_steps"]

#: states whose causes are looked at together; a thousand numbers each
_BATCH = 4000
#: numbers of the streams of a draw: corrections of the tables, of the noise's size, of effects
_TABLES, _NOISE, _EFFECTS = 0, 100, 200


@dataclass(frozen=True)
class DrawnTables:
    """The corrections of a machine's tables in one draw.

    Attributes
    ----------
    machine : Machine
    variant : Variant
    tables : TableUncertainty
    entropy : tuple of int
        The draw: equal numbers, equal corrections.
    """

    machine: Machine
    variant: Variant
    tables: TableUncertainty
    entropy: tuple[int, ...]
    label: str = "corrections of the tables"

    def displacement(self, states: PathStates) -> RigidDisplacement:
        """Rigid motion of the tool by the corrections."""
        total = RigidDisplacement.zero(len(states))
        for start in range(0, len(states), _BATCH):
            rows = slice(start, start + _BATCH)
            for moved in self._moved(states[rows]):
                total.shift_mm[rows] += moved.shift_mm
                total.tilt_rad[rows] += moved.tilt_rad
        return total

    def _moved(self, states: PathStates) -> Iterator[RigidDisplacement]:
        random = _stream(self.entropy, _TABLES)  # the same corrections wherever they are asked for
        known: dict[str, float] = {}
        for cause in self.tables.causes_of(self.machine, states, self.variant):
            drawn = random.standard_normal(cause.size.shape[1])
            yield cause.moved(drawn * self._widening(cause, known))

    def _widening(self, cause: Cause, known: dict[str, float]) -> float:
        """Factor of all corrections of a pool in one draw: its t-distribution."""
        freedom, name = cause.pool.degrees_of_freedom, cause.pool.name
        if not np.isfinite(freedom):
            return 1.0
        if name not in known:
            chi = _stream(self.entropy, _NOISE + len(known)).chisquare(freedom)
            known[name] = float(np.sqrt(freedom / chi))
        return known[name]

    def at_surface(self, states: PathStates) -> np.ndarray:
        """Nothing: the whole tool moves."""
        return np.zeros((len(states), 3))

    def tool_shift(self, states: PathStates) -> np.ndarray:
        """Nothing beside the displacement."""
        return np.zeros((len(states), 3))

    def uncertainty_patterns(self, states: PathStates) -> np.ndarray:
        """Nothing is left open once it is drawn."""
        return np.zeros((len(states), 3, 0))


def drawn_steps(effects: Sequence[EffectInstance], entropy: tuple[int, ...]) -> list[np.ndarray]:
    """Corrections of every effect's parameters in one draw, in their u; none beyond its bounds."""
    steps = {}
    for group in acting_together(effects):
        number = next(k for k, effect in enumerate(effects) if effect is group[0])
        steps |= dict.fromkeys(map(id, group), _steps(group, entropy, number))
    return [steps[id(effect)] for effect in effects]


def _steps(group: Sequence[EffectInstance], entropy: tuple[int, ...], number: int) -> np.ndarray:
    steps = _stream(entropy, _EFFECTS + number).standard_normal(len(group[0].one_sigma))
    possible = all(_is_within_bounds(effect.with_drawn(steps)) for effect in group)
    return steps if possible else np.zeros_like(steps)


def _is_within_bounds(effect: EffectInstance) -> bool:
    for p in effect.effect.parameters:
        value = np.asarray(effect.parameters.get(p.name, p.usual), dtype=float)
        if not ((value >= p.low) & (value <= p.high)).all():
            return False
    return True


def _stream(entropy: tuple[int, ...], number: int) -> np.random.Generator:
    return np.random.Generator(np.random.Philox(np.random.SeedSequence([*entropy, number])))
