"""What a cut finds in front of a wall, against programs whose allowances are written in them."""

from __future__ import annotations

import numpy as np
import pytest

from tests.small_job import write_job
from vmach.effects import Circumstances
from vmach.job import read_job
from vmach.path.preparation import prepare
from vmach.path.toolpath import PathStates

START = "G21 G90 G94 G17\nT1 M6\nS6000 M3\nG54 G43 H1\n"
#: over all of the wall at Y 5 and beyond, down to Z -1.5
FACE = "G0 X-10 Y0 Z5\nG1 Z-1.5 F300\nG1 X50 F600\nG1 Y8\nG1 X-10\nG0 Z5\n"
#: 0.4 mm beside the path that finishes the wall
ROUGH = "G0 X0 Y-0.4 Z5\nG1 Z{z} F300\nG1 X40 F600\nG0 Z5\n"
FINISH = "G0 X0 Y0 Z5\nG1 Z-6 F300\nG1 X40 F600\nG0 Z5\n"


def on_the_wall(folder, program, heights_mm):
    """Circumstances at Y 5 of the last long cut along X, at heights above the tip."""
    job_path = write_job(folder)
    (folder / "part.nc").write_text(f"{START}{program}M30\n")
    job = read_job(job_path)
    moves = prepare(job).program.moves
    along = np.flatnonzero(moves.at_feed & (moves.end_mm[:, 0] > moves.start_mm[:, 0] + 30.0))[-1]
    count = len(heights_mm)
    contact = np.column_stack([np.zeros(count), np.full(count, 5.0), heights_mm])
    normal = np.tile([0.0, -1.0, 0.0], (count, 1))
    place = np.linspace(0.3, 0.7, count)
    lengths = np.array([np.nan, 100.0])
    return Circumstances(
        PathStates(moves, lengths, np.full(count, along), place, contact, normal), job
    )


@pytest.mark.parametrize(
    ("before", "axial_mm"),
    [
        (ROUGH.format(z=-6), 6.0),
        (FACE + ROUGH.format(z=-6), 4.5),
        (FACE + ROUGH.format(z=-3) + ROUGH.format(z=-6), 4.5),
    ],
    ids=["from the blank", "faced", "roughed in two steps"],
)
def test_a_wall_is_as_high_as_what_was_milled_off_before_left_it(tmp_path, before, axial_mm):
    path = on_the_wall(tmp_path, before + FINISH, [0.0, 2.0, 4.0])
    np.testing.assert_allclose(path.radial_depth_mm, 0.4, atol=1e-6)
    np.testing.assert_allclose(path.axial_depth_mm, axial_mm, atol=1e-6)


def test_a_slot_that_goes_down_in_steps_is_as_deep_as_its_last_step(tmp_path):
    steps = FINISH.replace("Z-6", "Z-2") + FINISH.replace("Z-6", "Z-4") + FINISH
    path = on_the_wall(tmp_path, steps, [0.5, 1.5])
    np.testing.assert_allclose(path.radial_depth_mm, 10.0, atol=1e-6)
    np.testing.assert_allclose(path.axial_depth_mm, 2.0, atol=1e-6)


def test_a_wall_finished_in_steps_is_cut_as_high_as_a_step(tmp_path):
    steps = ROUGH.format(z=-6) + FINISH.replace("Z-6", "Z-3") + FINISH
    path = on_the_wall(tmp_path, steps, [0.5, 2.5])
    np.testing.assert_allclose(path.radial_depth_mm, 0.4, atol=1e-6)
    np.testing.assert_allclose(path.axial_depth_mm, 3.0, atol=1e-6)


def test_states_of_no_surface_are_as_deep_as_the_blank_is_high(tmp_path):
    path = on_the_wall(tmp_path, FACE + FINISH, [1.0])
    bare = PathStates(
        path.moves, path.states.tool_lengths_mm, path.states.move, path.states.parameter,
        np.zeros((1, 3)),
    )  # fmt: skip
    assert Circumstances(bare, path.job).axial_depth_mm == pytest.approx([6.0])
