"""What warms little by little, against closed forms and an independent simulation."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lsim

from tests.small_job import write_job
from vmach.effects import Circumstances, catalogue
from vmach.effects.laws.heat.warm_by_time import OfWarmthByTime
from vmach.job import read_job
from vmach.path.instrument_motion import stop_and_go
from vmach.path.preparation import prepare
from vmach.path.toolpath import PathStates

TWO_TOOLS = """\
%
G21 G17 G90 G94
T1 M6
S6000 M3
G54 G43 H1 G0 X0 Y0 Z5
G1 Z-2 F300
G1 X20 F60
G0 Z5
T2 M6
S6000 M3
G43 H2 G0 X0 Y0 Z5
G1 Z-2 F300
G1 X20 F60
G0 Z5
T1 M6
S6000 M3
G43 H1 G0 X0 Y0 Z5
G1 Z-2 F300
G1 X20 F60
G0 Z5
M5
M30
%
"""


def resting(job, nose_mm, time_s):
    """States at given places and times, (P, 3) and (P,)."""
    side = np.zeros((len(time_s), 3))
    states = stop_and_go(nose_mm, time_s, side=side, tool_length_mm=100.0)
    return Circumstances(states, job)


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    return read_job(write_job(tmp_path_factory.mktemp("job")))


def test_a_warm_part_is_stretched_from_the_bottom_of_its_blank(job):
    """At one moment the part is cut alpha dT too long; after three time constants by 95 %."""
    tau, ppm = 1000.0, 30.0
    zero = job.work_offsets_mm["G54"] + [0.0, 0.0, 100.0]
    place = np.array([[0.0, 0.0, -20.0], [50.0, 0.0, -20.0], [0.0, 20.0, 0.0]])
    path = resting(job, np.vstack([zero + place] * 2), np.repeat([1e-6, 3 * tau], 3) + np.arange(6))
    moved = catalogue()["workpiece_warming"].displacement(
        path, "", expansion_ppm=ppm, at_zero_x_um=4.0, at_zero_y_um=0.0, time_constant_s=tau
    )
    warm = 1.0 - np.exp(-path.time_s / tau)
    np.testing.assert_allclose(moved[:3], 0.0, atol=1e-5)
    first, along_x, top = moved[3:] / -warm[3:, None]
    np.testing.assert_allclose(first, [4e-3, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(along_x - first, [ppm * 1e-6 * 50.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(top - first, ppm * 1e-6 * np.array([0.0, 20.0, 20.0]), atol=1e-12)


def test_a_bed_bows_as_a_plate_between_two_temperatures(job):
    """Curvature alpha dT / h over the length L: the arch is alpha dT L^2 / (8 h) high."""
    length = np.ptp(job.machine.travel_mm[:, 0])
    curvature = 11e-6 * 2.0 / 300.0
    height_mm = curvature * length**2 / 8.0
    x = job.machine.travel_mm[0, 0] + length * np.linspace(0.0, 1.0, 9)
    path = resting(job, np.column_stack([x, 0 * x - 100.0, 0 * x - 100.0]), 1e9 + np.arange(9.0))
    moved = catalogue()["thermal_bow"].displacement(
        path, "X", bow_um=1e3 * height_mm, time_constant_s=600.0
    )
    np.testing.assert_allclose(moved[[0, -1], 2], 0.0, atol=1e-12)
    bend = np.diff(moved[:, 2], 2) / (length / 8.0) ** 2
    np.testing.assert_allclose(bend, -curvature, rtol=1e-9)


def test_tools_warm_in_the_spindle_and_cool_outside(tmp_path):
    """T1 twice with T2 between, against scipy's linear simulation of T1's own heat."""
    path = write_job(tmp_path)
    more = '[tools.2]\nshape = "flat"\ndiameter_mm = 8\nlength_mm = 90\n'
    path.write_text(path.read_text() + more)
    (tmp_path / "part.nc").write_text(TWO_TOOLS)
    job, tau = read_job(path), 12.0
    nodes = prepare(job).path.nodes
    zeros = np.zeros((len(nodes), 3))
    states = PathStates(
        nodes.moves, nodes.tool_lengths_mm, nodes.move, nodes.parameter, zeros, zeros
    )
    here = Circumstances(states, job)
    moved = catalogue()["tool_growth"].displacement(here, "", growth_um=9.0, time_constant_s=tau)
    moves = nodes.moves
    time = np.linspace(0.0, here.time_s.max(), 40001)
    at = np.maximum(np.searchsorted(moves.start_s, time, side="right") - 1, 0)
    drive = ((moves.tool[at] == 1) & (moves.spindle_rpm[at] != 0.0)).astype(float)
    _, warm, _ = lsim(([1.0], [tau, 1.0]), drive, time)
    own = here.tool == 1
    assert np.diff(here.time_s[own]).max() > 20.0  # T2 was in between
    np.testing.assert_allclose(
        moved[own, 2], -9e-3 * np.interp(here.time_s[own], time, warm), atol=3e-5
    )


def test_what_warms_evenly_is_cold_before_the_start():
    """Zeros are touched then: it does not go on backwards."""
    path = SimpleNamespace(time_s=np.array([-400.0, 0.0, 700.0]))
    np.testing.assert_allclose(OfWarmthByTime.warmth(path, 700.0), [0.0, 0.0, 1.0 - np.exp(-1.0)])
