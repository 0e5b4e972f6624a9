"""What effects ask of a path, by hand on a small program."""

from dataclasses import replace

import numpy as np
import pytest

from tests.small_job import write_job
from vmach.effects import Circumstances
from vmach.job import read_job
from vmach.path.levers import levers
from vmach.path.preparation import prepare


def test_an_arc_is_one_and_straight_moves_are_none(tmp_path):
    job = read_job(write_job(tmp_path))
    path = Circumstances(prepare(job).path.nodes, job)
    x, y, _ = path.on_part_mm.T
    # the only arc goes round X40 Y0 at a radius of 1 mm
    round_it = np.isclose(np.hypot(x - 40.0, y), 1.0)
    assert path.on_arc.any() and round_it[path.on_arc].all()
    assert not path.on_arc[x < 30.0].any()


def test_the_middle_of_a_part_is_that_of_its_blank(tmp_path):
    job = read_job(write_job(tmp_path))
    nodes = prepare(job).path.nodes
    blank = job.blank
    path = Circumstances(nodes, job)
    np.testing.assert_allclose(path.middle_of_part_mm, (blank.min_mm + blank.max_mm) / 2)
    without = Circumstances(nodes, replace(job, blank=None))
    np.testing.assert_allclose(without.middle_of_part_mm, path.on_part_mm.mean(axis=0))


@pytest.mark.parametrize("name", ["EYX", "ECX", "EBZ"])
def test_a_lever_is_made_alone_and_as_among_all(tmp_path, name):
    """Of a million moves all eighteen took 1.4 GB where one effect asked for one of them."""
    job = read_job(write_job(tmp_path))
    nodes = prepare(job).path.nodes
    place = job.machine, nodes.nose_mm, nodes.tool_mm
    every, alone = levers(*place), levers(*place, names=(name,))
    assert list(alone) == [name] and len(every) == 18
    for found in (alone[name], Circumstances(nodes, job).lever(name)):
        np.testing.assert_array_equal(found.shift_mm, every[name].shift_mm)
        np.testing.assert_array_equal(found.tilt_rad, every[name].tilt_rad)
