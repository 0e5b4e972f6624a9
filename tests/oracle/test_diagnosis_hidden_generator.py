"""The generator of hidden effects against closed forms, and the program against the generator."""

import numpy as np
import pytest

from tests.hidden_effects import program_runs
from tests.hidden_effects.experiment import (
    FOREIGN_KINDS,
    SINGLE_KINDS,
    make_experiment,
)
from tests.hidden_effects.machine_maker import CHAINS, random_machine
from tests.hidden_effects.nature_clamping import datum_shift, fixture
from tests.hidden_effects.nature_motion import backlash
from tests.hidden_effects.part import PartDesign, random_part
from tests.hidden_effects.shares import least_own_um, visible_um
from tests.hidden_effects.state import state_of

MOTION = {"rapid_mm_min": 20000.0, "tool_change_s": 8.0}
DESIGN = PartDesign(two_set_ups=True)


def arms(chain, nose, contact):
    """Arm of every axis by the rule of the functional point, written out for each chain."""
    x, y, z = (nose * e for e in np.eye(3))
    table = {
        "t (C) Z Y b X' w": {"Z": 0, "Y": z, "X": x + y + z},
        "t (C) Z b Y' X' w": {"Z": 0, "Y": y + z, "X": x + y + z},
        "t (C) Z X b Y' w": {"Z": 0, "X": z, "Y": x + y + z},
        "t (C) Z Y X b w": {"Z": 0, "Y": z, "X": y + z},
        "t (C) Z b X' Y' w": {"Z": 0, "X": x + z, "Y": x + y + z},
    }
    return {axis: contact + arm for axis, arm in table[chain].items()}


@pytest.mark.parametrize("chain", CHAINS)
def test_exact_matrices_agree_with_the_first_order_form(chain):
    rng = np.random.default_rng(5)
    machine = random_machine(rng, chain)
    low = [machine.travel_mm[a][0] for a in "XYZ"]
    nose = rng.uniform(low, 0, (300, 3))
    contact = rng.uniform(-10, 10, (300, 3)) - np.array([0, 0, 150])
    x, y, _ = nose.T
    square = {name: value * 1e-6 for name, value in machine.squareness_urad.items()}
    expected = np.stack([-square["C0Y"] * y, 0 * x, -square["B0X"] * x + square["A0Y"] * y], axis=1)
    for axis, arm in arms(chain, nose, contact).items():
        q = nose[:, "XYZ".index(axis)]
        shift = np.stack([machine.curves[f"E{c}{axis}"](q) for c in "XYZ"], axis=1)
        turn = np.stack([machine.curves[f"E{c}{axis}"](q) for c in "ABC"], axis=1)
        expected += shift * 1e-3 + np.cross(turn * 1e-6, arm)
    exact = machine.displacement_mm(nose, contact)
    assert np.abs(exact).max() > 0.01
    np.testing.assert_allclose(exact, expected, atol=1e-4)


def test_backlash_moves_a_bore_by_half_the_play_towards_where_the_axis_came_from():
    rng = np.random.default_rng(3)
    machine = random_machine(rng)
    part = random_part(rng, machine.travel_mm, motion=MOTION)
    state = state_of(part)
    hidden = backlash(rng, machine)
    axis = "XYZ".index(hidden.target)
    clear = np.abs(state.velocity_mm_s[:, axis]) > 0.05 * np.linalg.norm(
        state.velocity_mm_s, axis=1
    )
    clear &= state.since_reversal_mm[:, axis] > 0.3
    lag = hidden.displacement_mm(state)[clear, axis] * np.sign(state.velocity_mm_s[clear, axis])
    np.testing.assert_allclose(lag, -0.5e-3 * hidden.comparable["reversal_um"], rtol=1e-6)


def test_a_slip_between_two_clampings_is_how_the_second_one_stands():
    rng = np.random.default_rng(11)
    machine = random_machine(rng)
    part = random_part(rng, machine.travel_mm, motion=MOTION, design=DESIGN)
    state, second = state_of(part), fixture(rng, machine)
    slips = [datum_shift(rng, machine) for _ in range(40)]
    own = [least_own_um([slip, second], part, state, machine) for slip in slips]
    as_second = [slip.shows_as(state) == ("fixture",) for slip in slips]
    assert 0 < sum(as_second) < 40
    assert [one < 1e-6 for one in own] == as_second
    size = slips[0].parameters["shift_um"]
    parts = [n * one(state) for n, one in zip(size, slips[0].amounts, strict=True)]
    np.testing.assert_allclose(np.sum(parts, axis=0), slips[0].displacement_mm(state), atol=1e-12)


def test_contacts_lie_on_the_path_and_touch_their_points():
    part = random_part(
        np.random.default_rng(8), {"X": (-900, 0), "Y": (-550, 0), "Z": (-460, 0)}, motion=MOTION
    )
    rows = part.contacts
    node, share = rows["node"], rows["share"][:, None]
    chord = (1 - share) * part.path.tip_mm[node] + share * part.path.tip_mm[node + 1]
    np.testing.assert_allclose(rows["tip_mm"], chord, atol=0.008)  # sagitta of a 1 degree chord
    arm = part.place_mm[rows["point"]] - rows["tip_mm"]
    radius = np.where(rows["tool"] == 0, 10.0, 6.0)
    wall = np.abs(part.normal[rows["point"], 2]) < 0.5
    np.testing.assert_allclose(
        np.hypot(*arm[wall, :2].T) - rows["geometry_mm"][wall], radius[wall], atol=2e-4
    )
    assert (arm[wall, 2] > 0).all() and (arm[~wall, 2] == 0).all()


@pytest.mark.parametrize("kind", [*SINGLE_KINDS, *FOREIGN_KINDS])
def test_every_hidden_effect_shows(tmp_path, kind):
    made = make_experiment(tmp_path, effects=[kind], seed=21)
    seen = visible_um(made.share_um[0], made.part)
    assert seen > 0.8
    deviation = made.deviation_um
    assert np.isfinite(deviation).all() and visible_um(deviation, made.part) < 60


@pytest.mark.parametrize("chain", CHAINS[:2])
def test_prediction_of_a_healthy_machine_leaves_only_noise(tmp_path, chain):
    """Six numbers of alignment, reflectors honoured: noise and the tables' noise stay."""
    made = make_experiment(tmp_path, effects=[], seed=4, chain=chain)
    points = tmp_path / "part_measured.csv"
    left = {
        model: program_runs.aligned_rms_um(
            program_runs.predicted_um(tmp_path / "job.toml", points, model=model), made.part
        )
        for model in ("abbe", "htm")
    }
    assert 0.7 < left["abbe"] < 0.92
    assert left["htm"] > 2 * left["abbe"]
