"""Blocks of strokes united in several processes: the same bits, and nothing is left behind."""

import signal
import subprocess
import sys

import numpy as np
import pytest

from stock import cut_part, make_tool
from stock.solid import block_unions
from tests.stock_solid_cases import polyline, wavy_raster

BALL = make_tool("ball", diameter_mm=6.0, length_mm=30.0)
BLOCK = ((-5.0, -5.0, -10.0), (25.0, 10.0, 0.0))


def cut(monkeypatch, cores, **options):
    monkeypatch.setattr(block_unions, "cores_to_use", lambda: cores)
    return cut_part(polyline(wavy_raster(20, 12)), [BALL], BLOCK, **options)


@pytest.fixture
def hired(monkeypatch):
    """The processes that were started."""
    found, hire = [], block_unions._hired
    monkeypatch.setattr(block_unions, "_hired", lambda: found.append(hire()) or found[-1])
    return found


def test_the_bits_do_not_depend_on_the_number_of_processes(monkeypatch, hired):
    told = []
    here = cut(monkeypatch, 1, block_strokes=60)
    assert not hired
    there = cut(monkeypatch, 3, block_strokes=60, progress=lambda *count: told.append(count))
    assert len(hired) == 3 and all(one.poll() is not None for one in hired)
    for name in ("vertices_mm", "triangles", "move"):
        np.testing.assert_array_equal(getattr(here, name), getattr(there, name))
    assert here.volume_mm3 == there.volume_mm3
    assert told[-1][0] == told[-1][1] == max(count for count, _ in told)


def test_a_process_that_dies_leaves_its_block_to_this_one(monkeypatch):
    def dies():
        one = subprocess.Popen([sys.executable, "-c", "pass"], stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE)  # fmt: skip
        one.wait()
        return one

    here = cut(monkeypatch, 1, block_strokes=60)
    monkeypatch.setattr(block_unions, "_hired", dies)
    before = signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # as on the command line
    try:
        there = cut(monkeypatch, 2, block_strokes=60)
        assert signal.getsignal(signal.SIGPIPE) == signal.SIG_DFL
    finally:
        signal.signal(signal.SIGPIPE, before)
    np.testing.assert_array_equal(here.vertices_mm, there.vertices_mm)


def test_an_interruption_ends_the_processes(monkeypatch, hired):
    def interrupted(count, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cut(monkeypatch, 2, block_strokes=60, progress=interrupted)
    assert len(hired) == 2 and all(one.poll() is not None for one in hired)
