"""Effects of tools, cutting and probing."""

from __future__ import annotations

import numpy as np

from .machine_maker import TrueMachine
from .part import TOOLS
from .state import Hidden, State

__all__ = ["CUTTING", "is_floor_of", "slipped_um"]

UM = 1e-3
FLUTES = np.array([3, 4])


def tool_radius(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """One tool is not as thick as the table says."""
    tool, less = int(rng.integers(2)), rng.choice([-1, 1]) * rng.uniform(4, 10)

    def move(state: State) -> np.ndarray:
        side = state.normal * [1, 1, 0]
        return less * UM * side * (state.tool == tool)[:, None]

    return Hidden(
        "tool_radius",
        ("tool_radius",),
        {"tool": TOOLS[tool].number, "less_um": less},
        move,
        {"radius_um": less},
        target=f"T{TOOLS[tool].number}",
        on_part_only=True,
    )


def runout(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The longest tooth cuts alone: a larger radius, less the cusps that one tooth leaves."""
    tool, wide = int(rng.integers(2)), rng.uniform(5, 14)

    def move(state: State) -> np.ndarray:
        speed = np.linalg.norm(state.velocity_mm_s, axis=1)
        feed_a_turn = speed * 60 / np.array([t.rpm for t in TOOLS])[state.tool]
        radius = np.array([t.diameter_mm / 2 for t in TOOLS])[state.tool]
        cusp = feed_a_turn**2 / (8 * radius) / 3  # mean height
        side = state.normal * [1, 1, 0]
        return ((cusp - wide * UM) * (state.tool == tool))[:, None] * side

    return Hidden(
        "runout",
        ("runout",),
        {"tool": TOOLS[tool].number, "wide_um": wide},
        move,
        {"runout_um": wide},
        target=f"T{TOOLS[tool].number}",
        on_part_only=True,
    )


def probe_radius(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The CMM's ball is not as large as believed, and its pre-travel has three lobes."""
    wrong = rng.choice([-1, 1]) * rng.uniform(4, 9)

    def move(state: State) -> np.ndarray:
        lobes = 0.3 * np.cos(3 * np.arctan2(state.normal[:, 1], state.normal[:, 0]))
        lobes *= np.hypot(*state.normal[:, :2].T)
        return UM * state.normal * (wrong + lobes)[:, None]

    return Hidden(
        "probe_radius",
        ("probe_radius",),
        {"wrong_um": wrong},
        move,
        {"radius_um": wrong},
        on_part_only=True,
        twins=("probe_radius", "tool_radius", "runout"),
    )


def tool_wear(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A tool loses radius, quickly at first, then by the way that it cuts."""
    tool, size, power = int(rng.integers(2)), rng.uniform(12, 22), rng.uniform(0.7, 1.0)

    def move(state: State) -> np.ndarray:
        mine = state.tool == tool
        way = mine * state.cut_mm / 2200.0
        return size * UM * (way**power)[:, None] * state.normal * [1, 1, 0]

    return Hidden(
        "tool_wear",
        ("tool_wear",),
        {"tool": TOOLS[tool].number, "size_um": size},
        move,
        target=f"T{TOOLS[tool].number}",
        on_part_only=True,
    )


def tool_length(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """One tool was measured wrongly."""
    tool, long = int(rng.integers(2)), rng.choice([-1, 1]) * rng.uniform(8, 20)

    def move(state: State) -> np.ndarray:
        e = np.zeros_like(state.nose_mm)
        e[:, 2] = -long * UM * (state.tool == tool)
        return e

    return Hidden(
        "tool_length",
        ("tool_length",),
        {"tool": TOOLS[tool].number, "longer_um": long},
        move,
        {"length_um": long},
        on_part_only=True,
    )


def tool_slip(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The collet lets go once, while the tool cuts; from then on it is longer or shorter."""
    tool, size = int(rng.integers(2)), rng.choice([-1, 1]) * rng.uniform(8, 20)
    when = rng.uniform(0.15, 0.85)

    def move(state: State) -> np.ndarray:
        return UM * slipped_um(state, tool, [when], [-size])[:, None] * np.array([0.0, 0.0, 1.0])

    def shows_as(state: State) -> tuple[str, ...]:
        level = slipped_um(state, tool, [when], [1.0])[is_floor_of(state, tool)]
        is_a_length = len(level) > 0 and level.min() == 1.0  # it slipped before them
        return ("tool_length T1", "tool_length T2") if is_a_length else ()

    return Hidden(
        "tool_slip",
        ("tool_slip",),
        {"tool": TOOLS[tool].number, "slip_um": size, "share_of_way": when},
        move,
        {"slip_um": size},
        target=f"T{TOOLS[tool].number}",
        once=True,
        on_part_only=True,
        shows_as=shows_as,
    )


def tool_chip(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A corner of one tool breaks off at one moment; from then on it cuts too little."""
    tool, size, when = int(rng.integers(2)), rng.uniform(7, 15), rng.uniform(0.15, 0.85)
    ends = rng.uniform(0.3, 1.0)
    name = f"T{TOOLS[tool].number}"
    told = {"tool": TOOLS[tool].number, "size_um": size, "share_of_way": when}

    def move(state: State) -> np.ndarray:
        broken = slipped_um(state, tool, [when], [size])
        return UM * broken[:, None] * state.normal * [1, 1, ends]

    def told_as(state: State) -> tuple[Hidden, ...]:
        """Where it broke before the first point, a thinner and a shorter tool."""
        if (slipped_um(state, tool, [when], [1.0])[state.tool == tool] < 1.0).any():
            return ()
        return tuple(Hidden(n, (n,), told, target=name) for n in ("tool_radius", "tool_length"))

    return Hidden(
        "tool_chip",
        ("tool_chip",),
        told,
        move,
        {"radius_um": size, "length_um": ends * size},
        target=name,
        once=True,
        on_part_only=True,
        told_as=told_as,
    )


def slipped_um(state: State, tool: int, when: list | np.ndarray, size_um: list | np.ndarray):
    """Height that a tool gained by jerks after these shares of the way that it cuts, (M,)."""
    own = state.tool == tool
    way = state.cut_mm / max(state.cut_mm[own].max(initial=0.0), 1.0)
    return own * ((way[:, None] > np.asarray(when)) @ np.asarray(size_um))


def is_floor_of(state: State, tool: int) -> np.ndarray:
    """Which moments show the height of a tool, (M,) bool."""
    return (state.tool == tool) & (state.normal[:, 2] > 0.9)


def tool_deflection(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A slender tool is pushed off its wall, more in down milling, most at its tip."""
    size = rng.uniform(1.5, 3.5)
    slender = np.array([t.length_mm**3 / t.diameter_mm**4 for t in TOOLS])
    compliance = 0.3 + 0.7 * slender / slender[0]
    rpm = np.array([t.rpm for t in TOOLS])

    def move(state: State) -> np.ndarray:
        speed = np.linalg.norm(state.velocity_mm_s, axis=1)
        tooth = speed * 60 / rpm[state.tool] / FLUTES[state.tool]
        force = (state.ap_mm / 10) * (np.minimum(state.ae_mm, 2.0) / 0.4) ** 0.9
        force *= (tooth / 0.08) ** 0.85
        left = np.stack([-state.velocity_mm_s[:, 1], state.velocity_mm_s[:, 0], 0 * speed], axis=1)
        left /= np.maximum(speed, 1e-9)[:, None]  # none at rest
        down_milling = np.einsum("ij,ij->i", left, state.normal) > 0
        slot = state.ae_mm > 5
        push = np.where(slot[:, None], left, state.normal * [1, 1, 0])
        share = np.where(slot, 0.3, np.where(down_milling, 1.0, 0.8))
        height = state.place_mm[:, 2] - state.tip_mm[:, 2]
        length = np.array([t.length_mm for t in TOOLS])[state.tool]
        bent = size * force * compliance[state.tool] * share * (1 - 0.8 * height / length)
        return UM * bent[:, None] * push

    return Hidden(
        "tool_deflection", ("tool_deflection",), {"size_um": size}, move, on_part_only=True
    )


CUTTING = (
    tool_radius,
    runout,
    probe_radius,
    tool_wear,
    tool_length,
    tool_slip,
    tool_chip,
    tool_deflection,
)
