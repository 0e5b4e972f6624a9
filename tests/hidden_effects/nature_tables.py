"""Error tables that are missing or no longer true, reflectors that stood elsewhere, sag."""

from __future__ import annotations

import numpy as np

from .machine_maker import ErrorCurve, TrueMachine
from .state import Hidden, State

__all__ = ["TABLES"]

UM = 1e-3


def missing_table(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """No level was at hand: the table of an angle does not exist."""
    name = str(rng.choice(["EAY", "EBX", "EAX", "EBY", "ECX", "ECY"]))
    return Hidden("component", ("component",), {"missing": name}, missing=(name,), target=name)


def drifted_table(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The curve bent since it was measured."""
    name = str(rng.choice(["EXX", "EYY", "EYX", "EXY", "EZX", "EZY"]))
    fall = np.array([0.0, 1.0, 0.6, 0.3, 0.1])
    low, high = machine.travel_mm[name[2]]
    change = ErrorCurve(
        low, high, 0.0, rng.uniform(5, 9) * fall * rng.choice([-1, 1], 5), rng.uniform(0, 6.28, 5)
    )
    return Hidden(
        "component", ("component",), {"drifted": name}, changed={name: change}, target=name
    )


def reversed_table(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Whoever typed it in took nominal minus actual."""
    name = str(rng.choice(["EXX", "EYY", "EYX", "EXY", "EZX", "EZY", "EAX", "EBX", "EAY", "EBY"]))
    return Hidden(
        "error_tables",
        ("error_tables", f"component {name}"),
        {"turned round": name},
        comparable={"share": 2.0},
        turned_round=(name,),
        target=name,
    )


def compensated_tables(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """What was measured is in the control now: the axes are right, and square as they were."""
    tables = {name: _times(-1.0, curve) for name, curve in machine.curves.items()}
    told = {"compensated": "all tables"}
    return Hidden(
        "error_tables", ("error_tables",), told,
        comparable={"share": 1.0}, changed=tables, target="tables",
    )  # fmt: skip


def _times(share: float, curve: ErrorCurve):
    return lambda position_mm: share * curve(position_mm)


def local_damage(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A dent in one guide."""
    name = str(rng.choice(["EZX", "EZY", "EYX", "EXY"]))
    low, high = machine.travel_mm[name[2]]
    at, width = rng.uniform(low + 150, high - 150), rng.uniform(30, 60)
    depth = rng.choice([-1, 1]) * rng.uniform(9, 16)

    def dent(position_mm: np.ndarray) -> np.ndarray:
        return depth / (1 + np.abs((position_mm - at) / width) ** 3)

    return Hidden(
        "component",
        ("component", "unknown"),
        {"dent": name, "at_mm": at},
        changed={name: dent},
        target=name,
    )


def reflector(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The record of where a reflector stood is wrong by decimetres."""
    name = str(rng.choice(["EXX", "EYY", "EYX", "EXY", "EZX", "EZY"]))
    wrong = np.zeros(3)
    other = [k for k in range(3) if "XYZ"[k] != name[1]]
    wrong[int(rng.choice(other))] = rng.choice([-1, 1]) * rng.uniform(200, 350)
    return Hidden(
        "reflector",
        ("reflector", f"component {name}"),
        {"reading": name, "wrong_mm": wrong.tolist()},
        misplaced={name: wrong},
        target=name,
    )


def gravity_sag(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A cross beam that hangs through under its carriage, free at the ends."""
    axis, size = int(rng.integers(2)), rng.uniform(12, 25)
    low, high = machine.travel_mm["XYZ"[axis]]

    def move(state: State) -> np.ndarray:
        u = (state.nose_mm[:, axis] - low) / (high - low)
        e = np.zeros_like(state.nose_mm)
        e[:, 2] = -size * 1e-3 * 16 / 5 * (u - 2 * u**3 + u**4)  # beam under its own weight
        return e

    return Hidden(
        "gravity_sag",
        ("gravity_sag", f"component EZ{'XYZ'[axis]}"),
        {"axis": "XYZ"[axis], "size_um": size},
        move,
        target="XYZ"[axis],
    )


def table_load_sag(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A loaded table dips where it hangs over its guides and rises at the other end."""
    axis, size = int(rng.integers(2)), rng.choice([-1, 1]) * rng.uniform(20, 40)
    low, high = machine.travel_mm["XYZ"[axis]]
    steep = rng.uniform(2.0, 3.5)

    def move(state: State) -> np.ndarray:
        u = 2 * (state.nose_mm[:, axis] - low) / (high - low) - 1
        e = np.zeros_like(state.nose_mm)
        e[:, 2] = size * UM * np.sinh(steep * u) / np.sinh(steep)
        return e

    return Hidden(
        "table_load_sag",
        ("table_load_sag", f"component EZ{'XYZ'[axis]}"),
        {"axis": "XYZ"[axis], "size_um": size},
        move,
        target="XYZ"[axis],
    )


TABLES = (
    missing_table, drifted_table, local_damage, reflector, gravity_sag, table_load_sag,
    reversed_table, compensated_tables,
)  # fmt: skip
