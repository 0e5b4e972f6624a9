"""With conventional arms nothing asks where tables were measured."""

import numpy as np
import pytest

from tests.small_job import write_job
from vmach.base.variant import Variant
from vmach.errors import InputError
from vmach.run.pipeline import predict_points
from vmach.uncertainty.first_order import prediction_u_mm


def predicted(folder, variant, at=None):
    folder.mkdir(exist_ok=True)
    errors = {
        "EAX": (lambda x: 10 * np.sin(x / 40), None),
        "EYX": (lambda x: 3 * np.cos(x / 60), at),
    }
    job = write_job(folder, errors)
    _, prediction = predict_points(job, folder / "points.csv", variant=variant)
    return prediction


def test_a_machine_without_measuring_points_is_predicted_with_its_uncertainty(tmp_path):
    """As with points in the origin of the frame, from which the conventional arms count."""
    found = predicted(tmp_path / "nowhere", Variant.HTM)
    at_origin = predicted(tmp_path / "origin", Variant.ABBE, (0.0, 0.0, 0.0))
    np.testing.assert_allclose(found.deviation_mm, at_origin.deviation_mm, atol=1e-9)
    np.testing.assert_allclose(prediction_u_mm(found), prediction_u_mm(at_origin), atol=1e-12)
    with pytest.raises(InputError, match=r"EYX has no measured_at_mm.*commands with '--model htm'"):
        predicted(tmp_path / "nowhere", Variant.ABBE)
