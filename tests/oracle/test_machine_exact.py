"""First-order displacement against exact products of homogeneous matrices."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.machine_cases import (
    ALL_CHAINS,
    constant,
    make_machine,
    random_components,
    random_squareness,
)
from vmach.machine import LINEAR_AXES, Chain, Variant, displacement
from vmach.machine.exact import exact_displacement
from vmach.machine.machine import SignConvention

THREE_CHAINS = ["t (C) Z Y b X' w", "t (C) Z b Y' X' w", "t (C) Z Y X b w"]
TOOL_MM = np.array([3.0, -2.0, -150.0])


@pytest.mark.parametrize("sign", list(SignConvention))
@pytest.mark.parametrize("variant", [Variant.HTM, Variant.ABBE])
@pytest.mark.parametrize("chain", THREE_CHAINS)
def test_first_order_is_within_10_nm_of_the_exact_product(chain, variant, sign):
    # 20 um, 20 urad, +-500 mm, 2000 states: second-order terms stay below 0.01 um
    rng = np.random.default_rng(20260)
    machine = make_machine(
        chain, random_components(rng), squareness_rad=random_squareness(rng), sign=sign
    )
    nose = rng.uniform(-500.0, 500.0, (2000, 3))
    exact = exact_displacement(machine, nose, TOOL_MM, variant)
    first = displacement(machine, nose, TOOL_MM, variant)
    assert np.abs(exact.shift_mm).max() > 0.02
    assert np.abs(exact.shift_mm - first.shift_mm).max() < 1e-5
    assert np.abs(exact.tilt_rad - first.tilt_rad).max() < 1e-8


def matrix(shift, rotation):
    """Plain 4x4 of a shift and one rotation (axis index, angle), without any library."""
    matrix = [[1.0 if i == j else 0.0 for j in range(4)] for i in range(4)]
    for i in range(3):
        matrix[i][3] = shift[i]
    axis, angle = rotation
    b, c = (axis + 1) % 3, (axis + 2) % 3
    matrix[b][b] = matrix[c][c] = math.cos(angle)
    matrix[b][c], matrix[c][b] = -math.sin(angle), math.sin(angle)
    return matrix


def times(left, right):
    return [[sum(left[i][k] * right[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def inverse(matrix):
    """Inverse of a rigid motion by its transposed rotation."""
    turned = [[matrix[j][i] for j in range(3)] for i in range(3)]
    shift = [-sum(turned[i][k] * matrix[k][3] for k in range(3)) for i in range(3)]
    return [[*turned[i], shift[i]] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def _tip(tool_side, work_side, q, tool, *, joint, rotation):
    """Tip in workpiece coordinates when the body of one joint is turned, written out."""
    sides = []
    for axes, sign in ((tool_side[::-1], 1.0), (work_side, -1.0)):
        product = matrix((0.0, 0.0, 0.0), (0, 0.0))
        for axis in axes:
            k = "XYZ".index(axis)
            way = [sign * q[k] if i == k else 0.0 for i in range(3)]
            product = times(product, matrix(way, (0, 0.0)))
            if axis == joint:
                product = times(product, matrix((0.0, 0.0, 0.0), rotation))
        sides.append(product)
    relative = times(inverse(sides[1]), sides[0])
    return [sum(relative[i][k] * [*tool, 1.0][k] for k in range(4)) for i in range(3)]


@pytest.mark.parametrize("backwards", [False, True], ids=["t..w", "w..t"])
@pytest.mark.parametrize("text", ALL_CHAINS)
def test_arms_of_every_chain_against_a_written_out_product(text, backwards):
    # one angle of one body at a time, 1e-7 rad: the shift is angle x arm
    chain = Chain.parse(" ".join(text.split()[::-1]) if backwards else text)
    q, tool, angle = (120.0, -340.0, 55.0), (7.0, -11.0, -160.0), 1e-7
    for axis in LINEAR_AXES:
        for k, letter in enumerate("ABC"):
            machine = make_machine(
                text,
                {f"E{letter}{axis}": constant(f"E{letter}{axis}", angle)},
                sign=SignConvention.BODY,
            )
            moved = _tip(chain.tool_side, chain.work_side, q, tool, joint=axis, rotation=(k, angle))
            expected = np.array(moved) - tool - q
            shift = displacement(machine, np.array([q]), np.array(tool), Variant.HTM).shift_mm[0]
            assert shift == pytest.approx(expected, abs=angle * 1e-4)
