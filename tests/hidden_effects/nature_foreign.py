"""Things that no catalogue of effects holds: the only right answer is that it is unknown."""

from __future__ import annotations

import numpy as np

from .machine_maker import TrueMachine
from .state import Hidden, State

__all__ = ["FOREIGN"]

UM = 1e-3


def bump_field(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Bumps in the volume, each pushing its own way."""
    room = np.array([-machine.travel_mm[a][0] for a in "XYZ"])
    centre = rng.uniform(0.1, 0.9, (14, 3)) * room * [1, 1, 0]
    push = rng.normal(size=(14, 3)) * 6

    def move(state: State) -> np.ndarray:
        away = state.place_mm[:, None, :] - centre
        bump = np.exp(-0.5 * np.sum((away / [90, 90, 60]) ** 2, axis=2))
        return UM * bump @ push

    return Hidden("bump_field", ("unknown",), {}, move)


def checkerboard(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Up and down in the squares of a board."""
    size, pitch, at = rng.uniform(3, 5), rng.uniform(110, 170), rng.uniform(0, 6.28, 2)

    def move(state: State) -> np.ndarray:
        u = np.pi * state.place_mm[:, :2] / pitch + at
        board = np.tanh(2 * np.sin(u[:, 0]) * np.sin(u[:, 1]))
        return size * UM * board[:, None] * state.normal

    return Hidden("checkerboard", ("unknown",), {"size_um": size}, move, on_part_only=True)


def feature_offset(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Every feature sits somewhere else by chance."""
    seed = int(rng.integers(1 << 30))

    def move(state: State) -> np.ndarray:
        own = np.random.default_rng(seed).normal(size=(200, 3)) * 4
        return UM * own[state.feature]

    return Hidden("feature_offset", ("unknown",), {}, move, on_part_only=True)


def chatter(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Waves along the way that the tool cuts, shorter than the spacing of the points."""
    size, wave = rng.uniform(2.5, 4), rng.uniform(2.0, 6.0)

    def move(state: State) -> np.ndarray:
        way = state.place_mm @ np.array([1.0, 1.37, 0.61])
        return size * UM * np.sin(2 * np.pi * way / wave)[:, None] * state.normal

    return Hidden("chatter", ("unknown",), {"size_um": size}, move, on_part_only=True)


def mirror(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Walls that look inwards are displaced, those that look outwards are not."""
    size = rng.uniform(4, 7)
    middle = np.array([-machine.travel_mm[a][0] / 2 for a in "XY"])

    def move(state: State) -> np.ndarray:
        inward = np.einsum("ij,ij->i", state.normal[:, :2], middle - state.place_mm[:, :2])
        return size * UM * (inward > 0)[:, None] * state.normal

    return Hidden("mirror", ("unknown",), {"size_um": size}, move, on_part_only=True)


FOREIGN = (bump_field, checkerboard, feature_offset, chatter, mirror)
