"""Things that no catalogue of effects holds: the only right answer is that it is unknown."""

from __future__ import annotations

import numpy as np

from .machine_maker import TrueMachine
from .nature_cutting import is_floor_of, slipped_um
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


def loose_collet(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """One tool is pulled out of its holder bit by bit, in jerks, while it cuts."""
    tool, jerks = int(rng.integers(2)), np.sort(rng.uniform(0.1, 0.9, 3))
    size = rng.choice([-1, 1], 3) * rng.uniform(6, 14, 3)

    def move(state: State) -> np.ndarray:
        return UM * slipped_um(state, tool, jerks, size)[:, None] * np.array([0.0, 0.0, 1.0])

    def told_as(state: State) -> tuple[Hidden, ...]:
        """Of three jerks that fell between the floors in one place only, a length and a slip."""
        floor = np.flatnonzero(is_floor_of(state, tool))
        level = slipped_um(state, tool, jerks, size)[floor[np.argsort(state.time_s[floor])]]
        if len(np.unique(level)) > 2:
            return ()
        length = [one_more("tool_length", None)] if level[:1].any() else []
        slip = [one_more("tool_slip", f"T{tool + 1}")] if np.any(level != level[:1]) else []
        return (*length, *slip)

    def one_more(name: str, target: str | None) -> Hidden:
        return Hidden(name, (name, "unknown"), told, target=target)

    told = {"tool": tool + 1}
    return Hidden("loose_collet", ("unknown",), told, move, on_part_only=True, told_as=told_as)


def hot_spot(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Chips lie in a corner of the part, it bulges there and is cut flat while it is warm."""
    share, size = rng.uniform(0.25, 0.75, 2), rng.uniform(15, 25)

    def move(state: State) -> np.ndarray:
        place = state.place_mm[:, :2]
        low, high = place.min(axis=0), place.max(axis=0)
        away = place - (low + share * (high - low))
        spot = np.exp(-0.5 * np.sum(away**2, axis=1) / 45.0**2)
        return -size * UM * spot[:, None] * state.normal

    return Hidden("hot_spot", ("unknown",), {"size_um": size}, move, on_part_only=True)


def waves_along_the_feed(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Waves on all surfaces, a few millimetres long along the way that the tool cuts."""
    size, wave = rng.uniform(2.5, 4), rng.uniform(6.0, 25.0)

    def move(state: State) -> np.ndarray:
        return size * UM * np.sin(2 * np.pi * state.cut_mm / wave)[:, None] * state.normal

    return Hidden("waves_along_the_feed", ("unknown",), {"wave_mm": wave}, move, on_part_only=True)


def springback(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The part was clamped bent; released, it is a parabola across a diagonal, walls and all."""
    size, turn = rng.choice([-1, 1]) * rng.uniform(25, 45), rng.uniform(0.5, 1.1)

    def move(state: State) -> np.ndarray:
        across = np.array([np.cos(turn), np.sin(turn), 0.0])
        middle = 0.5 * (state.place_mm.min(axis=0) + state.place_mm.max(axis=0))
        u = (state.place_mm - middle) @ across / 200.0
        height = state.place_mm[:, 2] - middle[2]
        e = -(height * 2 * u / 200.0)[:, None] * across
        e[:, 2] += u**2
        return size * UM * e

    return Hidden("springback", ("unknown",), {"size_um": size}, move, on_part_only=True)


def chiller(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The spindle's chiller switches on and off: a saw tooth of some minutes in Y and Z."""
    size, period = rng.uniform(6, 12), rng.uniform(240, 700)
    start, rise, lean = rng.uniform(0, 1), rng.uniform(0.6, 0.9), rng.uniform(-0.8, 0.8)

    def move(state: State) -> np.ndarray:
        share = (state.time_s / period + start) % 1.0
        warm = np.where(share < rise, share / rise, (1.0 - share) / (1.0 - rise))
        return size * UM * warm[:, None] * np.array([0.0, lean, -1.0])

    return Hidden("chiller", ("unknown",), {"size_um": size, "period_s": period}, move)


def thin_walls(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Some features lie beside thin walls, which lean away from the tool, most in their middle."""
    size, seed = rng.uniform(9, 18), int(rng.integers(1 << 30))

    def move(state: State) -> np.ndarray:
        is_thin = np.random.default_rng(seed).random(200) < 0.3
        give = np.zeros(len(state.time_s))
        for feature in np.unique(state.feature[is_thin[state.feature]]):
            own = np.flatnonzero(state.feature == feature)
            along = np.linspace(-1.0, 1.0, len(own))
            give[own] = 1.0 - along**2
        return size * UM * give[:, None] * state.normal * [1, 1, 0]

    return Hidden("thin_walls", ("unknown",), {"size_um": size}, move, on_part_only=True)


FOREIGN = (
    bump_field,
    checkerboard,
    feature_offset,
    chatter,
    mirror,
    loose_collet,
    hot_spot,
    waves_along_the_feed,
    springback,
    chiller,
    thin_walls,
)
