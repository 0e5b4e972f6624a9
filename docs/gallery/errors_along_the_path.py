"""Where along the program is the tool farthest off?

The error of the tool's tip at every 5 mm of the path, line by line.
"""

from pathlib import Path

import numpy as np

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"

found = vmach.path_errors(SAMPLES / "mazak_ajv25" / "toolpath1.toml")
size_um = np.linalg.norm(found.error_um, axis=1)
worst = int(np.argmax(size_um))
print(f"{len(found)} places on {len(np.unique(found.line))} lines")
print(
    f"farthest off on line {found.line[worst]}, after {found.time_s[worst]:.1f} s: "
    f"{size_um[worst]:.1f} um, of which {found.error_um[worst].round(1).tolist()} um in X, Y, Z"
)
