"""Two arms rules part where the arms are long: the slot in the corner of the table."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vmach.machine import Variant
from vmach.run.pipeline import predict_points

FOLDER = Path(__file__).resolve().parents[2] / "samples" / "spline_slot"


def difference_um(job: str) -> float:
    """RMS of conventional minus Abbe-consistent deviation on the slot's walls, um."""
    htm, abbe = (
        predict_points(FOLDER / job, FOLDER / "wall_points.csv", variant=variant)[1]
        for variant in (Variant.HTM, Variant.ABBE)
    )
    assert htm.is_cut.all()
    assert abbe.is_cut.all()
    return 1e3 * float(np.sqrt(np.mean((htm.deviation_mm - abbe.deviation_mm) ** 2)))


def test_models_differ_more_in_the_corner_than_in_the_middle():
    assert difference_um("corner.toml") > 2 * difference_um("centre.toml") > 1
