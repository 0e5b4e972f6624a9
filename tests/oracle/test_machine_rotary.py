"""Chains with rotary axes: exact products, first order and closed forms against each other."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.machine_cases import make_machine, random_components, random_squareness
from tests.oracle.test_machine_exact import inverse, matrix, times
from vmach.errors import InputError
from vmach.machine import Chain, Variant, contributions, displacement, read_machine
from vmach.machine.exact import exact_displacement
from vmach.machine.machine import SignConvention
from vmach.machine.nominal_motion import nominal_joints
from vmach.machine.rotary import RotaryAxis, RotaryError

CHAINS = [
    "t (C1) Z Y b X' A' C' w",  # trunnion table
    "t (C1) B Z Y b X' C' w",  # swivelling head, turning table
    "t (C1) A C Z Y X b w",  # fork head on a gantry
    "t (C1) Z b Y' X' C' w",
    "t (C1) B A C Z b X' Y' w",
]
TOOL = np.array([4.0, -3.0, -180.0])


def random_rotary(rng, size_mm=0.02, size_rad=20e-6):
    angle = np.linspace(-math.pi, math.pi, 25)

    def component(name):
        size = size_rad if name[1] in "ABC" else size_mm
        return RotaryError(name, angle, rng.uniform(-size, size, 25))

    def axis(letter):
        return RotaryAxis(
            -math.pi, math.pi, rng.uniform(-300, 300, 3),
            {f"E{kind}{letter}": component(f"E{kind}{letter}") for kind in "XYZABC"},
            rng.uniform(-size_mm, size_mm, 3), rng.uniform(-size_rad, size_rad, 3),
        )  # fmt: skip

    return axis


def random_machine(chain, rng, sign=SignConvention.RELATIVE):
    blank = Chain.parse(chain)
    linear = make_machine(
        "t X Y Z b w", random_components(rng), squareness_rad=random_squareness(rng), sign=sign
    )
    axis = random_rotary(rng)
    return replace(
        linear, chain=blank, rotary={letter: axis(letter) for letter in blank.rotary_axes}
    )


@pytest.mark.parametrize("sign", [SignConvention.RELATIVE, SignConvention.BODY])
@pytest.mark.parametrize("variant", [Variant.HTM, Variant.ABBE])
@pytest.mark.parametrize("chain", CHAINS)
def test_first_order_is_within_50_nm_of_the_exact_product(chain, variant, sign):
    rng = np.random.default_rng(77)
    machine = random_machine(chain, rng, sign)
    nose, angles = rng.uniform(-500, 500, (500, 3)), rng.uniform(-3, 3, (500, 3))
    exact = exact_displacement(machine, nose, TOOL, variant, rotary_rad=angles)
    first = displacement(machine, nose, TOOL, variant, rotary_rad=angles)
    assert np.abs(exact.shift_mm).max() > 0.05
    assert np.abs(exact.shift_mm - first.shift_mm).max() < 5e-5
    assert np.abs(exact.tilt_rad - first.tilt_rad).max() < 2e-8


def written_out(machine, nose, tool, angles, *, with_errors):
    """Tip on the workpiece at one state, every matrix multiplied in plain lists."""
    sides = []
    for axes, sense in ((machine.chain.tool_side[::-1], 1.0), (machine.chain.work_side, -1.0)):
        product = matrix((0, 0, 0), (0, 0.0))
        for axis in axes:
            k = "XYZABC".index(axis) % 3
            kinds = [f"E{kind}{axis}" for kind in "XYZABC"]
            if axis in "XYZ":
                found = [machine.components[n].evaluate(nose[k : k + 1])[0] for n in kinds]
                lean = (
                    np.eye(3)[k] + np.cross(machine.squareness_rad[k], np.eye(3)[k]) * with_errors
                )
                product = times(product, matrix(sense * nose[k] * lean, (0, 0.0)))
                product = small(product, found, sense * with_errors)
                continue
            rotary = machine.rotary[axis]
            found = [rotary.components[n].evaluate(angles[k : k + 1])[0] for n in kinds]
            place = [*rotary.location_mm, *rotary.location_rad]
            product = times(product, matrix(rotary.centre_mm, (0, 0.0)))
            product = small(product, found, sense * with_errors)
            product = small(product, place, with_errors)
            product = times(product, matrix((0, 0, 0), (k, sense * angles[k])))
            product = small(product, place, -with_errors)
            product = times(product, matrix(-rotary.centre_mm, (0, 0.0)))
        sides.append(product)
    relative = times(inverse(sides[1]), sides[0])
    return np.array([sum(relative[i][k] * [*tool, 1.0][k] for k in range(4)) for i in range(3)])


def small(product, errors, factor):
    """The product, moved on by six small errors times a factor."""
    product = times(product, matrix([factor * e for e in errors[:3]], (0, 0.0)))
    for k in range(3):
        product = times(product, matrix((0, 0, 0), (k, factor * errors[3 + k])))
    return product


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_exact_form_of_random_chains_against_a_written_out_product(seed):
    rng = np.random.default_rng(seed)
    axes = [*"XYZ", *rng.choice([*"ABC"], rng.integers(1, 4), replace=False)]
    rng.shuffle(axes)
    axes.insert(rng.integers(0, len(axes) + 1), "b")
    machine = random_machine(f"t {' '.join(axes)} w", rng)
    nose, angles = rng.uniform(-400, 400, 3), rng.uniform(-3, 3, 3)
    ends = [written_out(machine, nose, TOOL, angles, with_errors=on) for on in (1.0, 0.0)]
    state = {"rotary_rad": angles[None]}
    exact = exact_displacement(machine, nose[None], TOOL, Variant.HTM, **state).shift_mm[0]
    # second-order terms differ: the order of three small turns, and inverses of small errors
    assert exact == pytest.approx(ends[0] - ends[1], abs=2e-5)
    assert np.linalg.norm(exact) > 1e-3


@given(st.integers(0, 2**32 - 1), st.sampled_from(CHAINS), st.sampled_from(["htm", "abbe"]))
@settings(max_examples=20, deadline=None)
def test_rotary_axes_at_zero_leave_the_three_axis_machine(seed, chain, variant):
    # location errors do nothing at zero; component errors of the rotary axes left out
    rng = np.random.default_rng(seed)
    machine = random_machine(chain, rng)
    bare = {k: replace(axis, components={}) for k, axis in machine.rotary.items()}
    linear_words = [word for word in chain.split() if word[0] not in "ABC" or word.startswith("(")]
    three = replace(machine, chain=Chain.parse(" ".join(linear_words)), rotary={})
    nose = rng.uniform(-500, 500, (20, 3))
    here = displacement(replace(machine, rotary=bare), nose, TOOL, Variant(variant))
    there = displacement(three, nose, TOOL, Variant(variant))
    assert here.shift_mm == pytest.approx(there.shift_mm, abs=1e-12)
    assert here.tilt_rad == pytest.approx(there.tilt_rad, abs=1e-15)


@pytest.mark.parametrize("variant", [Variant.HTM, Variant.ABBE])
@pytest.mark.parametrize("chain", CHAINS[:3])
def test_contributions_add_up_on_five_axes(chain, variant):
    rng = np.random.default_rng(5)
    machine = random_machine(chain, rng)
    nose, angles = rng.uniform(-500, 500, (30, 3)), rng.uniform(-3, 3, (30, 3))
    whole = displacement(machine, nose, TOOL, variant, rotary_rad=angles)
    parts = dict(contributions(machine, nose, TOOL, variant, rotary_rad=angles))
    # 18 linear, 6 leaning lines, and for each rotary axis 6 components and 6 of location
    assert len(parts) == 18 + 6 + 12 * len(machine.rotary)
    assert sum(p.shift_mm for p in parts.values()) == pytest.approx(whole.shift_mm, abs=1e-13)
    assert sum(p.tilt_rad for p in parts.values()) == pytest.approx(whole.tilt_rad, abs=1e-16)


def rotation_about_z(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def turntable(**location):
    empty = make_machine("t X Y Z b w", {})
    axis = RotaryAxis(-7.0, 7.0, np.array([-200.0, -150.0, -400.0]), **location)
    return replace(empty, chain=Chain.parse("t (C1) Z Y b X' C' w"), rotary={"C": axis})


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.7, -2.9])
def test_table_axis_out_of_place_by_hand(angle):
    # axis at c + d instead of c. The table turns by -phi in the bed, so a point at u from the real
    # axis comes to R(-phi) u; seen from the workpiece the tool is off by (1 - R(phi)) d, the first
    # harmonic of the angle that an R-test shows
    d = np.array([0.012, -0.007, 0.0])
    machine = turntable(location_mm=d)
    nose, angles = np.array([[-120.0, -90.0, -100.0]]), np.array([[0.0, 0.0, angle]])
    expected = (np.eye(3) - rotation_about_z(angle)) @ d
    for function in (exact_displacement, displacement):
        moved = function(machine, nose, TOOL, Variant.HTM, rotary_rad=angles)
        assert moved.shift_mm[0] == pytest.approx(expected, abs=1e-12)
        assert moved.tilt_rad[0] == pytest.approx(np.zeros(3), abs=1e-15)


def test_nominal_tip_on_a_turntable_by_hand():
    # tip 100 mm beside the axis in X, table turned by +90 deg (by -90 deg in the bed): on the
    # workpiece the tool stands 100 mm beside the axis in +Y, where a positive C would carry it
    machine = turntable()
    centre = machine.rotary["C"].centre_mm
    tip = centre + np.array([100.0, 0.0, 50.0])
    angles = np.array([[0.0, 0.0, math.pi / 2]])
    tool_side, work_side = nominal_joints(machine, (tip - TOOL)[None], angles)
    tip_in_bed = tool_side[-1].body.points_to_bed(TOOL[None])
    # X is on the work side: the table has moved by -x, the tip stays where it is in X
    assert tip_in_bed[0] == pytest.approx([TOOL[0], tip[1], tip[2]])
    on_table = work_side[-1].body.points_from_bed(tip_in_bed)[0]
    assert on_table == pytest.approx(centre + np.array([0.0, 100.0, 50.0]))


def test_axial_and_angular_errors_of_a_table_by_hand():
    # EZC lifts the tool against the workpiece by itself; ECC turns it about the axis
    flat = np.array([-7.0, 7.0])
    angle, phi = 8e-6, 0.9
    errors = {
        "EZC": RotaryError("EZC", flat, np.full(2, 0.003)),
        "ECC": RotaryError("ECC", flat, np.full(2, angle)),
    }
    machine = turntable(components=errors)
    nose = np.array([[-120.0, -90.0, -100.0]])
    moved = displacement(machine, nose, TOOL, Variant.ABBE, rotary_rad=np.array([[0, 0, phi]]))
    # arm from the axis to the tip, in the axes of the workpiece
    arm = rotation_about_z(phi) @ (nose[0] + TOOL - machine.rotary["C"].centre_mm)
    expected = np.array([-angle * arm[1], angle * arm[0], 0.003])
    assert moved.shift_mm[0] == pytest.approx(expected, abs=1e-15)
    assert moved.tilt_rad[0] == pytest.approx([0, 0, angle])


def test_head_carries_the_tool_vector():
    # B head with its pivot 200 mm above the nose: tilt error about Y at B = 90 deg
    empty = make_machine("t X Y Z b w", {})
    pivot = np.array([0.0, 0.0, 200.0])
    errors = {"EBB": RotaryError("EBB", np.array([-7.0, 7.0]), np.full(2, 1e-5))}
    axis = RotaryAxis(-7.0, 7.0, pivot, errors)
    machine = replace(empty, chain=Chain.parse("t (C1) B Z Y X b w"), rotary={"B": axis})
    tool = np.array([0.0, 0.0, -150.0])
    moved = displacement(machine, np.zeros((1, 3)), tool, Variant.HTM,
                         rotary_rad=np.array([[0.0, math.pi / 2, 0.0]]))  # fmt: skip
    # the tip is 350 mm from the pivot, along -X after the turn; theta x arm = 1e-5 * 350 along Z
    assert moved.shift_mm[0] == pytest.approx([0.0, 0.0, 3.5e-3], abs=1e-15)


FILE = """schema = 1
name = "five axes"
chain = "t (C1) Z Y b X' A' C' w"
[convention]
sign = "relative"
length = "um"
angle = "urad"
[motion]
rapid_mm_min = 20000
[axes]
X = {travel_mm = [-500, 0]}
Y = {travel_mm = [-400, 0]}
Z = {travel_mm = [-300, 0]}
A = {travel_deg = [-120, 30], centre_mm = [-250, -200, -450]}
C = {travel_deg = [-360, 360], centre_mm = [-250, -200, -450]}
[location]
EX0C = 12.0
AOC = -15.0
[errors.EZC]
table = "EZC.csv"
"""


def write(tmp_path, text, table="position_deg,forward,backward\n-360,1,3\n360,3,5\n"):
    (tmp_path / "EZC.csv").write_text(table)
    (tmp_path / "machine.toml").write_text(text)
    return tmp_path / "machine.toml"


def test_five_axis_machine_file(tmp_path):
    machine = read_machine(write(tmp_path, FILE))
    c = machine.rotary["C"]
    assert c.location_mm.tolist() == [0.012, 0, 0]
    assert c.location_rad == pytest.approx([-15e-6, 0, 0])
    assert c.components["EZC"].evaluate(np.array([0.0])) == pytest.approx([0.003])
    assert math.degrees(machine.rotary["A"].travel_min_rad) == pytest.approx(-120)
    with pytest.raises(InputError, match=r"EZC is asked for at 401.* deg"):
        c.components["EZC"].evaluate(np.array([7.0]))


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        (
            "A = {travel_deg = [-120, 30], centre_mm = [-250, -200, -450]}",
            "",
            "rotary axis A needs",
        ),
        ("[-120, 30]", "[30, -120]", "travel 30.0 .. -120.0 deg"),
        ("EX0C", "EX0B", "location error 'EX0B'"),
        ("[errors.EZC]", "[errors.EZB]", "there is no axis B in the chain"),
        ('"EZC.csv"', '"EZC.csv"\nmeasured_at_mm = [0, 0, 0]', "belongs to a rotary axis"),
        ('"EZC.csv"', '"EZC.csv"\nslope_removed = true', "belongs to a rotary axis"),
        ('"EZC.csv"', '"EZC.csv"\norder = 2', "no order and no period"),
        ('"EZC.csv"', '"EZD.csv"', "table = 'EZD.csv': no such file"),
        ("A' C' w", "C' C' w", "A, B and C at most once"),
    ],
)
def test_complaints_about_rotary_axes(tmp_path, old, new, part):
    assert old in FILE
    with pytest.raises(InputError, match=part):
        read_machine(write(tmp_path, FILE.replace(old, new, 1)))
