"""The additive model of the Huddersfield paper for its three configurations.

Longstaff, Fletcher et al., "Defining and computing machine tool accuracy", figure 2 and section 3.
The sums below are written out by hand from the hierarchy of the axes (B bottom, M middle, T top);
positions y and z count from where the other axes stood during the measurements (the offsets).
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.machine_cases import make_machine, random_components
from vmach.machine import ComponentError, Variant, displacement
from vmach.machine.component_errors import SetUp

OFFSET_MM = np.array([0.0, -120.0, 80.0])


def machine_at_offsets(chain: str, rng: np.random.Generator, set_up: SetUp):
    """All 18 errors measured with the other axes at the offsets, no tool length."""
    components = {}
    for name, component in random_components(rng).items():
        at = None if name[1] in "ABC" else measuring_point(name[2])
        components[name] = ComponentError(
            name, component.position_mm, component.mean, component.mean, at, set_up=set_up
        )
    squareness = np.zeros((3, 3))
    squareness[2, 1], squareness[2, 0], squareness[1, 2] = rng.uniform(-3e-5, 3e-5, 3)
    return make_machine(chain, components, squareness_rad=squareness)


def measuring_point(axis: str) -> np.ndarray:
    """The offsets that matter to `axis`: of the axes above it in the hierarchy X, Y, Z."""
    above = {"X": [0.0, 1.0, 1.0], "Y": [0.0, 0.0, 1.0], "Z": [0.0, 0.0, 0.0]}
    return OFFSET_MM * above[axis]


def additive(machine, nose):
    """Errors in X, Y, Z by the sums of figure 2, every angle right-handed."""
    E = {
        name: component.evaluate(nose[:, "XYZ".index(name[2])])
        for name, component in machine.components.items()
    }
    _, y, z = (nose - OFFSET_MM).T
    sigma = machine.squareness_rad
    ex = (
        E["EXX"] + E["EXY"] + E["EXZ"] + (E["EBX"] + E["EBY"]) * z - E["ECX"] * y
        + sigma[2, 1] * nose[:, 2] - sigma[1, 2] * nose[:, 1]
    )  # fmt: skip
    ey = (
        E["EYY"] + E["EYX"] + E["EYZ"] - (E["EAX"] + E["EAY"]) * z - sigma[2, 0] * nose[:, 2]
    )  # fmt: skip
    ez = E["EZZ"] + E["EZX"] + E["EZY"] + E["EAX"] * y
    return np.column_stack((ex, ey, ez)), E


@pytest.mark.parametrize(
    "chain", ["t (C) Z Y X b w", "t (C) Z Y b X' w", "t (C) Z b Y' X' w"],
    ids=["wBMTt", "BwMTt", "BMwTt"],
)  # fmt: skip
def test_three_configurations_with_indicators(chain):
    # "the B axis is not an amplifier": true where straightness is read by an indicator on the
    # other side of the joint, whose point of contact stays where the tool is
    rng = np.random.default_rng(11)
    carries_tool = chain.split("b")[0]
    machine = machine_at_offsets(chain, rng, SetUp.REFLECTOR)
    indicators = {
        name: ComponentError(
            name, c.position_mm, c.forward, c.backward, c.measured_at_mm,
            set_up=SetUp.REFLECTOR if name[2] in carries_tool else SetUp.INDICATOR,
        )
        for name, c in machine.components.items()
    }  # fmt: skip
    machine = make_machine(chain, indicators, squareness_rad=machine.squareness_rad)
    nose = rng.uniform(-500, 500, (300, 3))
    expected, _ = additive(machine, nose)
    moved = displacement(machine, nose, np.zeros(3), Variant.ABBE)
    assert moved.shift_mm == pytest.approx(expected, abs=1e-14)


def test_own_axis_terms_appear_with_a_reflector_on_the_table():
    # 20 urad over 400 mm of own travel are 8 um: the kind of set-up decides
    rng = np.random.default_rng(12)
    machine = machine_at_offsets("t (C) Z Y b X' w", rng, SetUp.REFLECTOR)
    nose = rng.uniform(-500, 500, (300, 3))
    expected, E = additive(machine, nose)
    expected[:, 1] += E["ECX"] * nose[:, 0]
    expected[:, 2] -= E["EBX"] * nose[:, 0]
    moved = displacement(machine, nose, np.zeros(3), Variant.ABBE)
    assert moved.shift_mm == pytest.approx(expected, abs=1e-14)
