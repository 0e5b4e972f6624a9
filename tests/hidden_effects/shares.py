"""How much of the measured deviations each hidden effect makes, and how much of it shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .machine_maker import TrueMachine
from .part import Part
from .state import Hidden, State

__all__ = [
    "alignment_columns",
    "deviation_um",
    "displacement_mm",
    "least_own_um",
    "share_um",
    "visible_um",
]


def where_it_is_made(state: State, machine: TrueMachine) -> State:
    """The same with the axes where a point is made: its machine's errors push it aside."""
    e = machine.displacement_mm(state.nose_mm, state.contact_mm)
    aside = e - np.einsum("ij,ij->i", e, state.normal)[:, None] * state.normal
    aside *= np.any(state.normal, axis=1, keepdims=True)  # a test reads where the axes are
    return replace(state, nose_mm=state.nose_mm - aside)


def displacement_mm(state: State, machine: TrueMachine, hidden: list[Hidden]) -> np.ndarray:
    """Tool against workpiece with everything that is true, (M, 3)."""
    e = machine.displacement_mm(state.nose_mm, state.contact_mm)
    made = where_it_is_made(state, machine)
    for h in hidden:
        if h.displacement_mm and (state.tool[0] >= 0 or not h.on_part_only):
            e = e + h.displacement_mm(made)
    return e


def deviation_um(part: Part, state: State, machine: TrueMachine, hidden: list[Hidden]):
    """Noise-free deviation of every measured point, not aligned."""
    e = displacement_mm(state, machine, hidden)
    row = np.einsum("ij,ij->i", e, state.normal) + part.contacts["geometry_mm"]
    return _per_point(row, part) * 1e3


def share_um(hidden: Hidden, part: Part, state: State, machine: TrueMachine) -> np.ndarray:
    """What one effect alone does to the deviations, um per measured point."""
    e = np.zeros_like(state.nose_mm)
    if hidden.displacement_mm:
        e = e + hidden.displacement_mm(where_it_is_made(state, machine))
    for name, change in hidden.changed.items():
        e = e + _component_mm(name, change, state, machine)
    for name in hidden.missing:
        e = e + _component_mm(name, machine.curves[name], state, machine, known_at_reflector=True)
    for name in hidden.turned_round:
        curve = machine.curves[name]
        e = e + 2.0 * _component_mm(name, curve, state, machine, known_at_reflector=True)
    for name, wrong in hidden.misplaced.items():
        e = e - _misread_mm(name, wrong, state, machine)
    return _per_point(np.einsum("ij,ij->i", e, state.normal), part) * 1e3


def _component_mm(
    name: str, curve, state: State, machine: TrueMachine, *, known_at_reflector: bool = False
) -> np.ndarray:
    """First-order displacement of one component error, mm.

    known_at_reflector : the linear tables of the axis hold what the angle did to their readings
    """
    axis = name[2]
    value = curve(state.nose_mm[:, "XYZ".index(axis)])[:, None]
    if name[1] in "XYZ":
        return value * 1e-3 * np.eye(3)["XYZ".index(name[1])]
    arm = state.contact_mm.copy()
    order = [c for c in machine.chain.split("b")[0] if c in "XYZ"]
    work = machine.work_side
    inner = order[: order.index(axis)] if axis in order else order + work[: work.index(axis) + 1]
    for other in inner:
        k = "XYZ".index(other)
        arm[:, k] += state.nose_mm[:, k]
    turn = value * 1e-6 * np.eye(3)["ABC".index(name[1])]
    moved = np.cross(turn, arm)
    if known_at_reflector:
        for k, letter in enumerate("XYZ"):
            moved[:, k] -= np.cross(turn, machine.reflector_mm[f"E{letter}{axis}"])[:, k]
    return moved


def _misread_mm(name: str, wrong: np.ndarray, state: State, machine: TrueMachine) -> np.ndarray:
    axis = name[2]
    q = state.nose_mm[:, "XYZ".index(axis)]
    turn = np.stack([machine.curves[f"E{c}{axis}"](q) for c in "ABC"], axis=1) * 1e-6
    e = np.zeros_like(state.nose_mm)
    k = "XYZ".index(name[1])
    e[:, k] = -np.cross(turn, wrong)[:, k]
    return e


def _per_point(row_mm: np.ndarray, part: Part) -> np.ndarray:
    """The deepest of all moments at which the tool was over a point."""
    point = part.contacts["point"]
    return np.minimum.reduceat(row_mm, np.flatnonzero(np.diff(point, prepend=-1)))


def alignment_columns(part: Part) -> np.ndarray:
    """(N, 6): deviation per um of shift and per urad of rotation about the part's middle."""
    arm = part.place_mm - part.size_mm / 2
    return np.concatenate([part.normal, np.cross(arm, part.normal) * 1e-3], axis=1)


def visible_um(deviation: np.ndarray, part: Part) -> float:
    """RMS of what the part's alignment leaves, um."""
    return _left_um(deviation, alignment_columns(part))


def least_own_um(hidden: list[Hidden], part: Part, state: State, machine: TrueMachine) -> float:
    """The smallest RMS that an effect shows beyond the alignment and the other effects, um.

    The others with whatever amounts they might have.
    """
    spans = [_span_um(h, part, state, machine) for h in hidden]
    return min(
        _left_um(
            share_um(h, part, state, machine),
            np.column_stack([alignment_columns(part), *spans[:k], *spans[k + 1 :]]),
        )
        for k, h in enumerate(hidden)
    )


def _span_um(hidden: Hidden, part: Part, state: State, machine: TrueMachine) -> np.ndarray:
    """What an effect does, one column for each of its amounts where they are told, (N, K)."""
    moves = hidden.amounts or (hidden.displacement_mm,)
    ones = [replace(hidden, displacement_mm=move) for move in moves]
    return np.column_stack([share_um(one, part, state, machine) for one in ones])


def _left_um(deviation: np.ndarray, columns: np.ndarray) -> float:
    fit = np.linalg.lstsq(columns, deviation, rcond=None)[0]
    return float(np.sqrt(np.mean((deviation - columns @ fit) ** 2)))
