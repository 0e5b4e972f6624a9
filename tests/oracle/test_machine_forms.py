"""The forms of the model in the papers against each other and against simulated measurements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.machine_cases import ALL_CHAINS, make_machine, random_components, random_squareness
from vmach.machine import ComponentError, Variant, displacement
from vmach.machine.component_errors import SetUp, component_of
from vmach.machine.machine import SignConvention

TOOL = np.array([2.0, -5.0, -200.0])


@pytest.mark.parametrize("set_up", list(SetUp))
@pytest.mark.parametrize("chain", ALL_CHAINS)
def test_readings_simulated_at_the_measuring_points_give_the_truth_back(chain, set_up):
    # truth: motions t, theta of every body at the origin of its frame. A reflector at R reads
    # t + theta x R along its direction; the Abbe form must return t + theta x r
    rng = np.random.default_rng(13)
    truth = {
        name: replace(c, measured_at_mm=None if c.is_angle else np.zeros(3), backward=c.forward)
        for name, c in random_components(rng).items()
    }
    machine = make_machine(chain, truth, squareness_rad=random_squareness(rng))
    position = truth["EXX"].position_mm
    readings = {}
    for name, component in truth.items():
        direction, axis, angular = component_of(name)
        if angular:
            readings[name] = component
            continue
        R = rng.uniform(-600, 600, 3)
        at = np.tile(R, (len(position), 1))
        if set_up is SetUp.INDICATOR:
            # the point of contact belongs to the other side: it travels through the body's frame
            at[:, axis] += position * (-1.0 if machine.chain.carries_tool(name[2]) else 1.0)
        theta = np.column_stack([truth[f"E{k}{name[2]}"].forward for k in "ABC"])
        read = component.forward + np.cross(theta, at)[:, direction]
        readings[name] = replace(
            component, forward=read, backward=read, measured_at_mm=R, set_up=set_up
        )
    nose = rng.choice(position, (60, 3))  # at the targets: products are not linear in between
    true = displacement(machine, nose, TOOL, Variant.HTM)
    measured = replace(machine, components=readings)
    found = displacement(measured, nose, TOOL, Variant.ABBE)
    assert found.shift_mm == pytest.approx(true.shift_mm, abs=1e-14)
    conventional = displacement(measured, nose, TOOL, Variant.HTM).shift_mm
    assert np.abs(conventional - true.shift_mm).max() > 1e-3


def homogeneous(shift, angles):
    a, b, c = angles
    return np.array(
        [[1, -c, b, shift[0]], [c, 1, -a, shift[1]], [-b, a, 1, shift[2]], [0, 0, 0, 1]]
    )


def test_functional_points_of_the_thesis():
    # KTH thesis, section 3.2: H_j = S_j T_j E_j dP_j, E_err,j = H_j - T_j dP_j, and eq. 26 adds the
    # three last columns; MP in the frame of each axis, FP - MP in dP. X on the work side, its
    # errors recorded as tool relative to workpiece (only then may eq. 26 add)
    rng = np.random.default_rng(26)
    points = {
        "X": np.array([-800.0, -256.0, -280.0 - 198.0]),
        "Y": np.array([0.0, 0.0, -280.0 - 220.0]),
        "Z": np.array([0.0, 0.0, -130.0]),
    }
    components = {
        name: ComponentError(
            name, c.position_mm, c.forward, c.forward, None if c.is_angle else points[name[2]]
        )
        for name, c in random_components(rng).items()
    }
    sigma = np.zeros((3, 3))
    sigma[0, 1], sigma[0, 2], sigma[1, 0] = 2.4e-5, -1.5e-5, 6.7e-5  # X two, Y one, Z none
    machine = make_machine(
        "t (C) Z Y b X' w", components, squareness_rad=sigma, sign=SignConvention.RELATIVE
    )
    for q in rng.uniform(-500, 0, (50, 3)):
        functional = {
            "X": TOOL + q, "Y": TOOL + q * [0.0, 0.0, 1.0], "Z": TOOL,
        }  # fmt: skip
        total = np.zeros(3)
        for j, axis in enumerate("XYZ"):
            errors = {k: components[f"E{k}{axis}"].evaluate(q[j : j + 1])[0] for k in "XYZABC"}
            E = homogeneous([errors[k] for k in "XYZ"], [errors[k] for k in "ABC"])
            S = homogeneous((0, 0, 0), sigma[j])
            T = homogeneous(q[j] * np.eye(3)[j], (0, 0, 0))
            dP = homogeneous(functional[axis] - points[axis], (0, 0, 0))
            # S turns the direction of travel only
            travel = S @ T @ np.linalg.inv(S)
            total += (travel @ E @ dP - T @ dP)[:3, 3]
        ours = displacement(machine, q[None], TOOL, Variant.ABBE).shift_mm[0]
        assert ours == pytest.approx(total, abs=1e-12)
