"""Machines made in code, for the tests of everything that needs one."""

from __future__ import annotations

import itertools

import numpy as np

from vmach.machine import COMPONENT_NAMES, Axis, Chain, ComponentError, Machine, Motion
from vmach.machine.machine import SignConvention

#: the 24 orders of three linear axes between tool and workpiece
ALL_CHAINS = [
    f"t (C) {' '.join(order[:bed])} b {' '.join(a + chr(39) for a in order[bed:])} w"
    for order in itertools.permutations("XYZ")
    for bed in range(4)
]


def make_machine(
    chain: str,
    components: dict[str, ComponentError],
    *,
    squareness_rad: np.ndarray | None = None,
    sign: SignConvention = SignConvention.RELATIVE,
    travel_mm: tuple[float, float] = (-500.0, 500.0),
) -> Machine:
    """A machine with the given errors and the same travel on every axis."""
    return Machine(
        name="made for a test",
        chain=Chain.parse(chain),
        axes={name: Axis(*travel_mm) for name in "XYZ"},
        motion=Motion(rapid_mm_per_min=20000.0),
        components=components,
        squareness_rad=np.zeros((3, 3)) if squareness_rad is None else squareness_rad,
        sign=sign,
    )


def constant(name: str, value: float, measured_at_mm: tuple[float, ...] | None = None):
    """A component error that is the same everywhere within +-1e4 mm, mm or rad."""
    at = None if measured_at_mm is None else np.array(measured_at_mm)
    ends = np.array([-1e4, 1e4])
    return ComponentError(name, ends, np.full(2, value), np.full(2, value), at)


def random_components(
    rng: np.random.Generator, *, shift_mm: float = 0.02, angle_rad: float = 20e-6
) -> dict[str, ComponentError]:
    """All 18 component errors, uniform within the given bounds, each with its own reflector."""
    position = np.linspace(-500.0, 500.0, 21)
    components = {}
    for name in COMPONENT_NAMES:
        angular = name[1] in "ABC"
        bound = angle_rad if angular else shift_mm
        both = rng.uniform(-bound, bound, (2, 21))
        at = None if angular else rng.uniform(-400.0, 400.0, 3)
        components[name] = ComponentError(name, position, *both, at)
    return components


def random_squareness(rng: np.random.Generator, angle_rad: float = 20e-6) -> np.ndarray:
    """Reference lines of the axes turned by up to `angle_rad` about the axes across."""
    return rng.uniform(-angle_rad, angle_rad, (3, 3)) * (1.0 - np.eye(3))
