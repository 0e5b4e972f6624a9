"""Write measured.csv: the ISO 10791-7 test piece as a machine with a hidden fault would leave it.

The machine's tables are those of ``../iso10791_7``; beside them its Y axis loses 7 um at every
reversal. The part lies on the CMM shifted and turned a little, and the CMM scatters by 0.8 um.
Run it again after changing the test piece: ``python make_measurements.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vmach.job import read_job
from vmach.machine import Variant
from vmach.nominal import read_nominal
from vmach.path.preparation import prepare
from vmach.prediction import predict

FOLDER = Path(__file__).parent
LOST_MOTION_UM, NOISE_UM, SPACING_MM = 7.0, 0.8, 11.0


def main() -> None:
    """Predict the points, add the lost motion, lay the part on the CMM, add noise, write."""
    job = read_job(FOLDER.parent / "iso10791_7")
    preparation = prepare(job)
    points = read_nominal(job.nominal).sample(SPACING_MM, edge_margin_mm=2.0)
    found = predict(preparation, points.point_mm, points.normal, variant=Variant.ABBE)
    cut = found.is_cut
    point, normal = points.point_mm[cut], points.normal[cut]
    deviation = 1e3 * found.deviation_mm[cut]
    # coming from below the axis stays behind below: half of the lost motion on either side
    deviation += -0.5 * LOST_MOTION_UM * found.states.direction[:, 1] * normal[:, 1]
    random = np.random.default_rng(20)
    shift, turn = np.array([6.0, -9.0, 4.0]), np.array([12e-3, -8e-3, 20e-3])
    deviation += ((shift + np.cross(turn, point)) * normal).sum(axis=1)
    deviation += NOISE_UM * random.standard_normal(len(point))
    measured = point + 1e-3 * deviation[:, None] * normal
    rows = ["id,feature,x,y,z,i,j,k,mx,my,mz,u_um"]
    for k, (p, n, m) in enumerate(zip(point, normal, measured, strict=True), 1):
        numbers = [f"{v:.6f}" for v in (*p, *n, *m)]
        rows.append(",".join([str(k), str(points.feature[cut][k - 1]), *numbers, str(NOISE_UM)]))
    (FOLDER / "measured.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
