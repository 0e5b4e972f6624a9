"""Laws that the displacement must obey on any machine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.machine_cases import (
    ALL_CHAINS,
    constant,
    make_machine,
    random_components,
    random_squareness,
)
from vmach.machine import COMPONENT_NAMES, Chain, Variant, contributions, displacement
from vmach.machine.component_errors import SetUp
from vmach.machine.machine import SignConvention

seeds = st.integers(0, 2**32 - 1)
chains = st.sampled_from(ALL_CHAINS)
variants = st.sampled_from([Variant.HTM, Variant.ABBE])
few = settings(max_examples=25, deadline=None)


def random_case(seed, chain, **options):
    """A machine with all errors, 40 states and a tool that is not along Z."""
    rng = np.random.default_rng(seed)
    machine = make_machine(
        chain, random_components(rng), squareness_rad=random_squareness(rng), **options
    )
    return rng, machine, rng.uniform(-500, 500, (40, 3)), rng.uniform(-100, 100, 3)


@given(seeds, chains, variants)
@few
def test_zero_errors_displace_nothing(seed, chain, variant):
    rng = np.random.default_rng(seed)
    components = random_components(rng, shift_mm=0.0, angle_rad=0.0)
    moved = displacement(make_machine(chain, components), rng.uniform(-500, 500, (9, 3)),
                         np.array([1.0, 2.0, -150.0]), variant)  # fmt: skip
    assert not moved.shift_mm.any()
    assert not moved.tilt_rad.any()


@given(seeds, chains, variants, st.sampled_from(list(SignConvention)), st.booleans())
@few
def test_compiled_displacement_is_the_sum_of_the_contributions(
    seed, chain, variant, sign, indicator
):
    rng, machine, nose, tool = random_case(seed, chain, sign=sign)
    if indicator:
        set_up = {n: replace(c, set_up=SetUp.INDICATOR) for n, c in machine.components.items()}
        machine = replace(machine, components=set_up)
    machine = replace(machine, separate_directions=True)
    tools = tool + rng.uniform(-5, 5, (40, 3))
    direction = rng.integers(-1, 2, (40, 3))
    moved = displacement(machine, nose, tools, variant, direction=direction)
    parts = [p for _, p in contributions(machine, nose, tools, variant, direction=direction)]
    assert moved.shift_mm == pytest.approx(sum(p.shift_mm for p in parts), abs=1e-15)
    assert moved.tilt_rad == pytest.approx(sum(p.tilt_rad for p in parts), abs=1e-18)


@given(seeds, chains)
@few
def test_moving_the_origin_changes_nothing_in_the_abbe_form(seed, chain):
    # the zero of the coordinates moves by d: positions, tables and reflectors are restated
    rng, machine, nose, tool = random_case(seed, chain)
    machine = replace(machine, squareness_rad=np.zeros((3, 3)))
    d = rng.uniform(-300, 300, 3)
    masks = machine.chain.arm_masks
    restated = {}
    for name, component in machine.components.items():
        axis = "XYZ".index(name[2])
        at = component.measured_at_mm
        restated[name] = replace(
            component,
            position_mm=component.position_mm - d[axis],
            measured_at_mm=None if at is None else at - masks[axis] * d,
        )
    other = replace(machine, components=restated)
    here = displacement(machine, nose, tool, Variant.ABBE)
    there = displacement(other, nose - d, tool, Variant.ABBE)
    assert there.shift_mm == pytest.approx(here.shift_mm, abs=1e-12)
    conventional = displacement(other, nose - d, tool, Variant.HTM).shift_mm
    changed = conventional - displacement(machine, nose, tool, Variant.HTM).shift_mm
    assert np.abs(changed).max() > 1e-4  # the conventional form does depend on it


@given(seeds, chains, variants)
@few
def test_mirrored_machine_makes_mirrored_errors(seed, chain, variant):
    # mirror in the plane X = 0: X errors, B and C rotations and X positions change sign
    _, machine, nose, tool = random_case(seed, chain)
    mirror = np.array([-1.0, 1.0, 1.0])
    mirrored = {}
    for name, component in machine.components.items():
        sign = -1.0 if name[1] in "XBC" else 1.0
        x_axis = name[2] == "X"
        at = component.measured_at_mm
        order = slice(None, None, -1) if x_axis else slice(None)
        mirrored[name] = replace(
            component,
            position_mm=(-component.position_mm if x_axis else component.position_mm)[order],
            forward=sign * component.forward[order],
            backward=sign * component.backward[order],
            measured_at_mm=None if at is None else at * mirror,
        )
    squareness = machine.squareness_rad * np.array([1.0, -1.0, -1.0])
    image = replace(machine, components=mirrored, squareness_rad=squareness)
    moved = displacement(machine, nose, tool, variant)
    reflected = displacement(image, nose * mirror, tool * mirror, variant)
    assert reflected.shift_mm == pytest.approx(moved.shift_mm * mirror, abs=1e-14)
    assert reflected.tilt_rad == pytest.approx(moved.tilt_rad * [1, -1, -1], abs=1e-18)


@given(seeds, chains, variants)
@few
def test_body_and_relative_signs_are_the_same_machine_told_twice(seed, chain, variant):
    _, machine, nose, tool = random_case(seed, chain)
    told = {}
    for name, component in machine.components.items():
        sign = 1.0 if machine.chain.carries_tool(name[2]) else -1.0
        told[name] = replace(
            component, forward=sign * component.forward, backward=sign * component.backward
        )
    body = replace(machine, components=told, sign=SignConvention.BODY)
    assert displacement(body, nose, tool, variant).shift_mm == pytest.approx(
        displacement(machine, nose, tool, variant).shift_mm, abs=1e-15
    )


@given(seeds, chains)
@few
def test_tilt_carries_points_above_the_tip_as_a_longer_tool_would(seed, chain):
    # the same machine state seen at two points of one rigid tool
    rng, machine, nose, tool = random_case(seed, chain)
    c = rng.uniform(-50, 50, 3)
    at_tip = displacement(machine, nose, tool, Variant.ABBE)
    at_point = displacement(machine, nose, tool + c, Variant.ABBE)
    assert at_tip.at(np.tile(c, (40, 1))) == pytest.approx(at_point.shift_mm, abs=1e-15)


@given(chains, st.sampled_from([n for n in COMPONENT_NAMES if n[1] in "ABC"]))
@settings(max_examples=60, deadline=None)
def test_huddersfield_angles_are_positive_where_their_first_effect_is(chain, name):
    # all amplifying axes at +100 mm, the moving axis at zero: the first effect in X, Y, Z
    axis = "XYZ".index(name[2])
    nose = np.full((1, 3), 100.0)
    nose[0, axis] = 0.0
    machine = make_machine(chain, {name: constant(name, 1e-5)}, sign=SignConvention.HUDDERSFIELD)
    shift = displacement(machine, nose, np.zeros(3), Variant.HTM).shift_mm[0]
    effects = shift[np.abs(shift) > 1e-12]
    amplifies = Chain.parse(chain).arm_masks[axis] * nose[0]
    across = np.arange(3) != "ABC".index(name[1])
    assert bool(effects.size) == bool(amplifies[across].any())
    assert effects.size == 0 or effects[0] > 0
