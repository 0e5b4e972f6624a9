"""A floor point of a sample's slot whose line leaves its sweeps through the rim of the tool."""

from pathlib import Path

import numpy as np
import pytest

from stock import Sweeps, find_edges, make_tool
from tests.oracle import stock_brute_force as brute
from vmach.job import read_job
from vmach.machine import Variant
from vmach.path.preparation import prepare
from vmach.prediction import displaced_sweeps

JOB = Path(__file__).resolve().parents[2] / "samples" / "mazak_ajv25" / "toolpath1.toml"
TOOL = {"shape": "flat", "diameter_mm": 20.0, "length_mm": 200.0}
POINT_MM = np.array([-645.0, -265.0, -280.0])


def near(sweeps: Sweeps, point_mm: np.ndarray) -> Sweeps:
    """The sweeps whose tool can come over the point."""
    low = np.minimum(sweeps.start_mm, sweeps.end_mm)[:, :2] - 11.0
    high = np.maximum(sweeps.start_mm, sweeps.end_mm)[:, :2] + 11.0
    mask = ((low <= point_mm[:2]) & (point_mm[:2] <= high)).all(axis=1)
    return Sweeps(**{k: getattr(sweeps, k)[mask] for k in sweeps.__dataclass_fields__})


@pytest.mark.parametrize("lean", [0.0, 0.02])
def test_floor_of_the_slot_under_conventional_errors(lean):
    sweeps = displaced_sweeps(prepare(read_job(JOB)), Variant.HTM)
    normal = np.array([np.sin(lean), 0.0, np.cos(lean)])
    found = find_edges(
        POINT_MM[None], normal[None], sweeps=sweeps, tools=[make_tool(**TOOL)], blank_mm=None
    )
    state, h = brute.edge(near(sweeps, POINT_MM), [TOOL], POINT_MM, normal, 1.0)
    assert state == 0
    assert found.status[0] == state
    assert found.deviation_mm[0] == pytest.approx(h, abs=1e-9)
    assert abs(h) > 1e-3
