"""What effects ask of a path, by hand on a small program."""

from dataclasses import replace

import numpy as np
import pytest

from gcode import MoveKind
from tests.small_job import write_job
from vmach.effects import Circumstances
from vmach.job import read_job
from vmach.path.preparation import prepare
from vmach.path.toolpath import PathStates


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


def test_a_rapid_begins_and_ends_at_rest(tmp_path):
    """What it touches where it leaves a floor was made before it set off."""
    job = read_job(write_job(tmp_path))
    moves = prepare(job).path.nodes.moves
    rapid = int(np.flatnonzero((moves.kind == MoveKind.RAPID) & (moves.duration_s > 0))[-1])
    feed = int(np.flatnonzero(moves.at_feed & (moves.kind != MoveKind.ARC))[-1])
    move, parameter = np.array([rapid, rapid, rapid, feed]), np.array([0.0, 0.5, 1.0, 0.0])
    zero = np.zeros((4, 3))
    states = PathStates(moves, np.array([np.nan, 100.0]), move, parameter, zero, zero)
    speed = np.linalg.norm(states.velocity_mm_per_s, axis=1)
    both = [rapid, feed]
    way = np.linalg.norm(moves.end_mm[both] - moves.start_mm[both], axis=1)
    assert speed[[0, 2]].tolist() == [0.0, 0.0]
    assert speed[[1, 3]] == pytest.approx(way / moves.duration_s[both])
