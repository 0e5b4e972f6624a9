"""A part cut in another process: the same part, whatever becomes of that process."""

import signal
import subprocess
import sys

import numpy as np
import pytest

from stock import CutAside, StockError, cut_part, make_tool
from stock.solid import cut_aside
from stock.solid.cut_aside import cutter_at_hand
from tests.stock_solid_cases import polyline, wavy_raster

BALL = make_tool("ball", diameter_mm=6.0, length_mm=30.0)
BLOCK = ((-5.0, -5.0, -10.0), (25.0, 10.0, 0.0))
SWEEPS = polyline(wavy_raster(20, 6))


@pytest.fixture
def started(monkeypatch):
    """The processes that were started, as on two cores."""
    found, start = [], subprocess.Popen
    monkeypatch.setattr(cut_aside, "cores_to_use", lambda: 2)
    monkeypatch.setattr(cut_aside, "_WORTHWHILE_SWEEPS", 1)
    monkeypatch.setattr(
        cut_aside.subprocess, "Popen", lambda *a, **k: found.append(start(*a, **k)) or found[-1]
    )
    return found


def assert_same(one, other):
    for name in ("vertices_mm", "triangles", "move"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
        assert not getattr(other, name).flags.writeable
    assert one.volume_mm3 == other.volume_mm3


def test_the_bits_are_those_of_a_part_cut_here(started):
    told = []
    here = cut_part(SWEEPS, [BALL], BLOCK)
    with CutAside(SWEEPS, [BALL], BLOCK) as cutting:
        there = cutting.part(lambda *count: told.append(count))
    assert len(started) == 1 and started[0].poll() is not None
    assert_same(here, there)
    assert told and told[-1][0] == told[-1][1]


def test_a_process_that_dies_leaves_the_part_to_this_one(started, monkeypatch):
    monkeypatch.setattr(cut_aside, "isolated_python", lambda _: [sys.executable, "-c", "pass"])
    before = signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # as on the command line
    try:
        with CutAside(SWEEPS, [BALL], BLOCK) as cutting:
            started[0].wait()
            assert_same(cut_part(SWEEPS, [BALL], BLOCK), cutting.part())
        assert signal.getsignal(signal.SIGPIPE) == signal.SIG_DFL
    finally:
        signal.signal(signal.SIGPIPE, before)


def test_what_is_wrong_is_said_here(started):
    with CutAside(SWEEPS, [], BLOCK) as cutting, pytest.raises(StockError, match="has tool 0"):
        cutting.part()


def test_an_interruption_ends_the_process(started):
    with pytest.raises(KeyboardInterrupt), CutAside(SWEEPS, [BALL], BLOCK):
        raise KeyboardInterrupt
    assert started[0].poll() is not None


def test_few_sweeps_are_cut_here(monkeypatch):
    monkeypatch.setattr(cut_aside.subprocess, "Popen", None)
    with CutAside(SWEEPS, [BALL], BLOCK) as cutting:
        assert cutting.part().volume_mm3 > 0.0


def test_a_process_at_hand_cuts_the_same_part(started):
    with cutter_at_hand():
        with CutAside(SWEEPS, [BALL], BLOCK) as cutting:
            there = cutting.part()
        assert len(started) == 1 and started[0].poll() is not None
    assert_same(cut_part(SWEEPS, [BALL], BLOCK), there)


def test_a_process_that_nobody_needs_is_ended(started):
    with pytest.raises(KeyboardInterrupt), cutter_at_hand():
        raise KeyboardInterrupt
    assert started[0].poll() is not None
    with CutAside(SWEEPS, [BALL], BLOCK):
        assert len(started) == 2
