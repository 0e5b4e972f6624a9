"""Numbers printed in the papers that the model comes from."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.machine_cases import constant, make_machine
from vmach.machine import ComponentError, Variant, displacement
from vmach.machine.exact import exact_displacement

ARCSEC = math.pi / 648000

#: Bhattacharyya et al. (2022), Table 1: y mm; dx, dy, dz um; ex, ey, ez arcsec
EXERCISE_3 = np.array([
    (0, 0, 0, 0, 0, 0, 0),
    (1, 0.4, -0.3, 0.2, -7, 7, -6),
    (2, 1.0, -0.6, 0.6, -16, 19, 15),
    (3, 2.2, -0.2, 0.5, -18, 24, 26),
    (4, 3.6, 0.2, -0.1, -20, 23, 19),
    (5, 1.2, 0.9, -0.4, 7, 17, 23),
    (6, -0.6, 1.4, -0.5, 14, -6, 10),
    (7, -0.9, 0.8, -0.3, 19, -17, -1),
    (8, -0.4, 0.5, 0, 17, -23, -9),
])  # fmt: skip
#: Table 2: error in Y at the tool point B, um, as printed
PRINTED_DY = (0, 8, 60, 81, 76, 17, -18, -47, -54)
#: all three directions at B by eq. 34 and its x and z counterparts, worked out by hand, um
AT_B = np.array([
    (0.0000, 0.0000, 0.0000),
    (29.0040, 7.9418, -23.5559),
    (17.9685, 60.0017, -58.0625),
    (9.9570, 81.2487, -69.3132),
    (22.5077, 76.3157, -72.3372),
    (-2.1937, 17.3837, -11.5507),
    (-34.5370, -17.9925, 35.3762),
    (-40.1699, -46.7117, 61.2713),
    (-38.7003, -53.7991, 66.4195),
])  # fmt: skip


def test_bhattacharyya_exercise_3_tables_1_and_2():
    # a tool post on a Y slide; tool point at (300, 400, 500) mm from the frame that was measured
    columns = EXERCISE_3.T
    components = {}
    for name, column in zip(("EXY", "EYY", "EZY", "EAY", "EBY", "ECY"), columns[1:], strict=True):
        values = column * (ARCSEC if name[1] in "ABC" else 1e-3)
        components[name] = ComponentError(name, columns[0], values, values)
    machine = make_machine("t Y Z X b w", components)
    nose = np.c_[np.zeros(9), columns[0], np.zeros(9)]
    at_b = displacement(machine, nose, np.array([300.0, 400.0, 500.0]), Variant.HTM).shift_mm * 1e3
    assert at_b == pytest.approx(AT_B, abs=6e-5)
    assert tuple(np.round(at_b[:, 1]).astype(int)) == PRINTED_DY


def test_huddersfield_figure_2_sums():
    # wBMTt, X bottom, Y middle, Z top, all carry the tool; terms of the three equations, um.
    # Their angles are positive when the first effect is: EAX' = -EAX, ECX' = -ECX, EAY' = -EAY.
    y, z = 3000.0, 350.0
    lengths = {
        "EXX": 331.98, "EXY": -32.193, "EXZ": 1.303, "EYY": 9.2, "EYX": -38.554, "EYZ": -18.188,
        "EZZ": 9.2, "EZX": -39.759, "EZY": 21.126,
    }  # fmt: skip
    angles = {"EBX": 9.975 / z, "EBY": 0.0, "ECX": -61.5 / y, "EAX": 2.45 / z, "EAY": -1.51655 / z}
    components = {name: constant(name, value * 1e-3) for name, value in (lengths | angles).items()}
    squareness = np.zeros((3, 3))
    squareness[2, 1] = 63.35e-3 / z  # Z leans towards X: + z
    squareness[1, 2] = 231e-3 / y  # Y leans towards -X: - y
    squareness[2, 0] = -8.05e-3 / z  # Z leans towards Y: + z
    machine = make_machine("t (C) Z Y X b w", components, squareness_rad=squareness)
    shift = displacement(machine, np.array([[0.0, y, z]]), np.zeros(3), Variant.HTM).shift_mm[0]
    # X and Z as printed; the Y column adds up to -40.42545 where -40.4255 is printed
    assert shift * 1e3 == pytest.approx([204.915, -40.42545, 11.567], abs=1e-9)


@pytest.mark.parametrize("variant", [Variant.HTM, Variant.ABBE])
def test_first_order_y_error_agrees_with_the_full_rotation(variant):
    # the paper's own check: a full rotation changes exercise 3 by less than 0.004 um
    columns = EXERCISE_3.T
    components = {
        name: ComponentError(name, columns[0], *[column * ARCSEC] * 2)
        for name, column in zip(("EAY", "EBY", "ECY"), columns[4:], strict=True)
    }
    machine = make_machine("t Y Z X b w", components)
    nose = np.c_[np.zeros(9), columns[0], np.zeros(9)]
    tool = np.array([300.0, 400.0, 500.0])
    exact = exact_displacement(machine, nose, tool, variant).shift_mm[:, 1]
    first = displacement(machine, nose, tool, variant).shift_mm[:, 1]
    assert np.abs(exact - first).max() < 4e-6
