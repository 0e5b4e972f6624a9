"""What happens to a tool at one moment: which points it moves, and when it can have happened."""

import numpy as np
import pytest

from tests.small_job import write_job
from vmach.effects import Circumstances, catalogue
from vmach.job import read_job
from vmach.path.preparation import prepare
from vmach.path.toolpath import PathStates


@pytest.fixture
def path(tmp_path):
    """Floors at even nodes of a small job, walls at odd ones."""
    job = read_job(write_job(tmp_path))
    nodes = prepare(job).path.nodes
    is_floor = np.arange(len(nodes)) % 2 == 0
    normal = np.where(is_floor[:, None], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    contact = np.zeros((len(nodes), 3))
    states = PathStates(
        nodes.moves, nodes.tool_lengths_mm, nodes.move, nodes.parameter, contact, normal
    )
    return Circumstances(states, job)


def test_a_longer_tool_lowers_what_it_cuts_afterwards(path):
    number = int(path.tool[-1])
    when = float(np.median(path.time_s))
    moved = catalogue()["tool_slip"].displacement(path, f"T{number}", slip_um=8.0, time_s=when)
    after = (path.tool == number) & (path.time_s > when)
    assert after.any() and not after.all()
    np.testing.assert_allclose(moved[:, 2], np.where(after, -8e-3, 0.0))
    assert not moved[:, :2].any()


def test_a_chipped_tool_leaves_material_on_walls_and_floors_afterwards(path):
    number = int(path.tool[-1])
    when = float(np.median(path.time_s))
    chip = {"radius_um": 8.0, "length_um": 5.0, "time_s": when}
    moved = catalogue()["tool_chip"].displacement(path, f"T{number}", **chip)
    left_mm = np.einsum("ij,ij->i", moved, path.normal)
    after = (path.tool == number) & (path.time_s > when)
    assert after.any() and not after.all()
    is_floor = path.normal[:, 2] > 0.9
    np.testing.assert_allclose(left_mm, after * np.where(is_floor, 5e-3, 8e-3))


def test_moments_of_a_chip_lie_between_the_points_of_that_tool(path):
    effect, target = catalogue()["tool_chip"], f"T{int(path.tool[-1])}"
    own = np.unique(path.time_s[path.tool == path.tool[-1]])
    moments = [place["time_s"] for place in effect.inner_grid(path, target)]
    assert moments
    assert all(own.min() < moment < own.max() for moment in moments)


def test_moments_of_a_slip_lie_between_the_levels_of_that_tool(path):
    effect, target = catalogue()["tool_slip"], f"T{int(path.tool[-1])}"
    level = path.time_s[(path.tool == path.tool[-1]) & (path.normal[:, 2] > 0.9)]
    moments = [place["time_s"] for place in effect.inner_grid(path, target)]
    assert 0 < len(moments) <= len(np.unique(level)) - 1
    assert all(level.min() < moment < level.max() for moment in moments)


def test_a_moment_is_as_uncertain_as_its_pause_is_long(path):
    """Uniform within the pause: its length over the root of twelve."""
    effect, target = catalogue()["tool_slip"], f"T{int(path.tool[-1])}"
    level = np.unique(path.time_s[effect.sees(path, target)])
    pause = int(np.argmax(np.diff(level)))
    here = 0.5 * (level[pause] + level[pause + 1])
    places = effect.places(path, target, {"time_s": here})
    time = np.array([values["time_s"] for values, _ in places])
    weight = np.array([weight for _, weight in places])
    inside = (time > level[pause]) & (time < level[pause + 1])
    weight = weight[inside] / weight[inside].sum()
    mean = weight @ time[inside]
    assert mean == pytest.approx(here)
    spread = np.sqrt(weight @ (time[inside] - mean) ** 2)
    assert spread == pytest.approx((level[pause + 1] - level[pause]) / np.sqrt(12.0))
    assert time[inside][np.argmax(weight)] == pytest.approx(here)


def test_a_moment_is_as_likely_as_its_pause_is_long(path):
    """Of all pauses the shares add up to one."""
    effect, target = catalogue()["tool_slip"], f"T{int(path.tool[-1])}"
    level = np.unique(path.time_s[effect.sees(path, target)])
    inside = 0.5 * (level[1:] + level[:-1])
    likes = np.array([effect.moments_like(path, target, {"time_s": t}) for t in inside])
    np.testing.assert_allclose(1.0 / likes, np.diff(level) / np.ptp(level))
    assert np.sum(1.0 / likes) == pytest.approx(1.0)
