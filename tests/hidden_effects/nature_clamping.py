"""How the piece is held."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .machine_maker import TrueMachine, rotation_matrices
from .part import SECOND_DATUM_MM
from .state import Hidden, State

__all__ = ["CLAMPING"]

UM = 1e-3


def datum_shift(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The part slips in its clamps at one moment."""
    shift, share = rng.normal(size=3), rng.uniform(0.3, 0.7)
    shift = shift / np.linalg.norm(shift) * rng.uniform(9, 16)

    def moved_by(shift: np.ndarray) -> Callable[[State], np.ndarray]:
        def move(state: State) -> np.ndarray:
            when = share * (len(state.history.rpm) - 1)
            return UM * (state.time_s > when)[:, None] * shift

        return move

    move = moved_by(shift)

    def shows_as(state: State) -> tuple[str, ...]:
        """Between two clampings it is a part of how the second one stands."""
        moved = np.any(move(state) != 0.0, axis=1)
        is_second = state.set_up == 1
        return ("fixture",) if is_second.any() and np.array_equal(moved, is_second) else ()

    return Hidden(
        "datum_shift",
        ("datum_shift",),
        {"shift_um": shift.tolist(), "share_of_time": share},
        move,
        {f"shift_{a}_um": float(v) for a, v in zip("xyz", shift, strict=True)},
        once=True,
        on_part_only=True,
        amounts=tuple(map(moved_by, np.eye(3))),
        shows_as=shows_as,
    )


def fixture(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The second clamping stands a little elsewhere and turned."""
    shift, turn = rng.uniform(-40, 40, 3), rng.uniform(-150, 150, 3)

    def moved_by(shift: np.ndarray, turn: np.ndarray) -> Callable[[State], np.ndarray]:
        turned = rotation_matrices(turn[None] * 1e-6)[0] - np.eye(3)

        def move(state: State) -> np.ndarray:
            e = shift * UM + (state.place_mm - SECOND_DATUM_MM) @ turned.T
            return (state.set_up == 1)[:, None] * e

        return move

    told = [f"shift_{a}_um" for a in "xyz"], [f"turn_{a}_urad" for a in "abc"]
    return Hidden(
        "fixture",
        ("fixture",),
        {"shift_um": shift.tolist(), "turn_urad": turn.tolist()},
        moved_by(shift, turn),
        {**dict(zip(told[0], shift, strict=True)), **dict(zip(told[1], turn, strict=True))},
        on_part_only=True,
        amounts=tuple(moved_by(one[:3], one[3:]) for one in np.eye(6)),
    )


CLAMPING = (datum_shift, fixture)
