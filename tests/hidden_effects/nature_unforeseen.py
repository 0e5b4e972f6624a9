"""More things that no catalogue holds, made up after the diagnosis: nothing was tuned on them."""

from __future__ import annotations

import numpy as np

from .machine_maker import TrueMachine
from .state import Hidden, State

__all__ = ["UNFORESEEN"]

UM = 1e-3


def lobed_probe(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The CMM's stylus is worn to a square: its error goes round four times on every wall."""
    size, turn = rng.uniform(3.5, 6.0), rng.uniform(0.0, np.pi / 2)

    def move(state: State) -> np.ndarray:
        round_ = np.arctan2(state.normal[:, 1], state.normal[:, 0])
        across = np.hypot(*state.normal[:, :2].T)
        return size * UM * (np.cos(4.0 * (round_ - turn)) * across)[:, None] * state.normal

    return Hidden("lobed_probe", ("unknown",), {"size_um": size}, move, on_part_only=True)


def burrs(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Near both ends of every feature a burr stands under the probe."""
    size, share = rng.uniform(7.0, 13.0), rng.uniform(0.08, 0.15)

    def move(state: State) -> np.ndarray:
        height = np.zeros(len(state.time_s))
        for feature in np.unique(state.feature):
            own = np.flatnonzero(state.feature == feature)
            from_end = 1.0 - np.abs(np.linspace(-1.0, 1.0, len(own)))
            height[own] = np.exp(-from_end / share)
        return size * UM * height[:, None] * state.normal

    return Hidden("burrs", ("unknown",), {"size_um": size}, move, on_part_only=True)


def press_next_door(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A press works in a few stretches of time and pushes the machine off its place meanwhile."""
    size = rng.choice([-1, 1], 2) * rng.uniform(7.0, 13.0, 2)
    start = rng.uniform(0.0, 0.9, 4)

    def move(state: State) -> np.ndarray:
        share = state.time_s / max(float(state.time_s.max()), 1.0)
        works = ((share[:, None] > start) & (share[:, None] < start + 0.08)).any(axis=1)
        return UM * works[:, None] * np.array([size[0], size[1], 0.0])

    return Hidden("press_next_door", ("unknown",), {"size_um": size.tolist()}, move)


UNFORESEEN = (lobed_probe, burrs, press_next_door)
