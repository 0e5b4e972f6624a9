"""A small part, measured: one with a hidden backlash, one with an error that no catalogue holds."""

import numpy as np

from tests.small_job import pocket_points, write_job_with_nominal, write_points
from vmach.api.points import predict

ERRORS = {
    "EXX": (lambda x: 8e-3 * (x + 200.0) + 2.0 * np.sin(x / 30.0), (0.0, -150.0, -200.0)),
    "ECX": (lambda x: 0.05 * (x + 200.0), None),
    "EYY": (lambda y: -6e-3 * (y + 150.0), None),
}
BACKLASH_UM, NOISE_UM = 6.0, 0.3


def write_measured_job(folder):
    """The small job, measured after a machine with backlash in Y made it; gives the job file."""
    job = write_job_with_nominal(folder, ERRORS)
    text = job.read_text()
    hidden = folder / "hidden.toml"
    hidden.write_text(f"{text}\n[effects.backlash.Y]\nreversal_um = {BACKLASH_UM}\n")
    _, points, normals = pocket_points()
    deviation = predict(hidden, folder / "points.csv").deviation_um
    hidden.unlink()
    noise = NOISE_UM * np.random.default_rng(7).standard_normal(len(points))
    write_points(folder / "points.csv", points + 1e-3 * (deviation + noise)[:, None] * normals)
    return job


def write_odd_job(folder):
    """Beside the measured job: the same part with an error that no effect of the catalogue is."""
    _, points, normals = pocket_points()
    deviation_um = predict(folder / "job.toml", folder / "points.csv").deviation_um
    bend_um = 8.0 * (points[:, 0] / 20.0) ** 2 * np.sign(points[:, 1])
    noise_um = NOISE_UM * np.random.default_rng(3).standard_normal(len(points))
    moved_um = deviation_um + bend_um * normals[:, 1] + noise_um
    write_points(folder / "odd.csv", points + 1e-3 * moved_um[:, None] * normals)
    text = (folder / "job.toml").read_text().replace('"points.csv"', '"odd.csv"')
    (folder / "odd.toml").write_text(text)
