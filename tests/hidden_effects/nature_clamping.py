"""How the piece is held."""

from __future__ import annotations

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

    def move(state: State) -> np.ndarray:
        when = share * (len(state.history.rpm) - 1)
        return UM * (state.time_s > when)[:, None] * shift

    return Hidden(
        "datum_shift",
        ("datum_shift",),
        {"shift_um": shift.tolist(), "share_of_time": share},
        move,
        {f"shift_{a}_um": float(v) for a, v in zip("xyz", shift, strict=True)},
        once=True,
        on_part_only=True,
    )


def fixture(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The second clamping stands a little elsewhere and turned."""
    shift, turn = rng.uniform(-40, 40, 3), rng.uniform(-150, 150, 3)
    turned = rotation_matrices(turn[None] * 1e-6)[0] - np.eye(3)

    def move(state: State) -> np.ndarray:
        e = shift * UM + (state.place_mm - SECOND_DATUM_MM) @ turned.T
        return (state.set_up == 1)[:, None] * e

    told = [f"shift_{a}_um" for a in "xyz"], [f"turn_{a}_urad" for a in "abc"]
    return Hidden(
        "fixture",
        ("fixture",),
        {"shift_um": shift.tolist(), "turn_urad": turn.tolist()},
        move,
        {**dict(zip(told[0], shift, strict=True)), **dict(zip(told[1], turn, strict=True))},
        on_part_only=True,
    )


CLAMPING = (datum_shift, fixture)
