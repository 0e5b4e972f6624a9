"""What would an effect of my own do to the part?

Declare parameters and one function; the effect then works everywhere, as those of vmach do.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"


class BedTwist(vmach.Effect):
    """The bed is twisted: the table rises with the product of X and Y.

    A displacement is that of the tool relative to the workpiece: over a table that rises it is
    negative along Z.
    """

    name = "bed_twist"
    title = "twist of the bed"
    parameters = (vmach.linear("twist_um_per_m2", "rise over one square metre", usual=20.0),)
    targets = ("",)
    source = "closed form of this script: the table rises by twist x y"

    def displacement(self, path, target, twist_um_per_m2):
        x_mm, y_mm, _ = path.nose_mm.T
        return vmach.along("Z", -1e-9 * twist_um_per_m2 * x_mm * y_mm)


vmach.add_effect(BedTwist())

job = vmach.read_job(SAMPLES / "iso10791_7" / "job.toml")
twisted = replace(job, effects={"bed_twist": {"twist_um_per_m2": 60.0}})

before, after = vmach.path_errors(job), vmach.path_errors(twisted)
change_um = after.error_um - before.error_um
rows = np.argsort(np.abs(change_um[:, 2]))[[0, -1]]
for k in rows:
    x, y, _ = before.nose_mm[k]
    print(f"at X{x:.1f} Y{y:.1f} the tip is {-change_um[k, 2]:.3f} um deeper in the part")
np.testing.assert_allclose(
    change_um[:, 2], -60e-6 * before.nose_mm[:, 0] * before.nose_mm[:, 1], atol=1e-9
)
