"""Rounding that goes on from what it knows, against rounding from the beginning."""

from pathlib import Path

import numpy as np
import pytest

from vmach.compensation.aim.probes import Probes, ProbeSets, path_probes
from vmach.compensation.compensate import solve
from vmach.compensation.grid import rounding
from vmach.compensation.grid.rounding import Rounding
from vmach.job import read_job

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "missing_effect" / "job.toml"


@pytest.fixture(scope="module")
def solved():
    return solve(read_job(SAMPLE))


def further_probes(random, moves):
    """Some probes at places drawn along the path, off in directions drawn."""
    count = int(random.integers(1, 6))
    normal = random.normal(size=(count, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return Probes(random.integers(0, moves, count), random.uniform(size=count), normal,
                  random.normal(scale=2e-3, size=count), random.uniform(0.1, 30.0, count),
                  random.uniform(size=count) < 0.5)  # fmt: skip


@pytest.mark.parametrize("at_once", [1, 64])
def test_going_on_gives_what_a_new_start_gives(solved, monkeypatch, at_once):
    monkeypatch.setattr(rounding, "_AT_ONCE", at_once)
    found, rewriter = solved.solution, solved.iteration.rewriter
    random, probes = np.random.default_rng(at_once), ProbeSets.of(path_probes(found.run))
    going_on, differs = Rounding(rewriter, found.plan, found.target, 1e-3), 0
    before = going_on.rounded(probes)[1].ends_mm
    for _ in range(2):
        probes = probes.beside(further_probes(random, len(rewriter.moves)))
        now = going_on.rounded(probes)[1].ends_mm
        anew = Rounding(rewriter, found.plan, found.target, 1e-3).rounded(probes)[1].ends_mm
        np.testing.assert_array_equal(now, anew)
        differs += int((now != before).any())
        before = now
    assert differs  # the further probes count
