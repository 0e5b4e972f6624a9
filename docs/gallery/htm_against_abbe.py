"""How much do conventional arms overestimate?

Conventional homogeneous matrices start every arm at the machine's origin and count part of the
angular errors twice. Abbe-consistent arms start where each reflector stood.
"""

from pathlib import Path

import numpy as np

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"

machine = vmach.read_machine(SAMPLES / "spline_slot" / "machine.toml")
tool_mm = np.array([0.0, 0.0, -120.0])  # from the spindle nose to the tip

low, high = machine.travel_mm
grid = np.meshgrid(*(np.linspace(low[k], high[k], 9) for k in range(3)), indexing="ij")
nose_mm = np.stack([axis.ravel() for axis in grid], axis=1)

size_um = {}
for model in ("htm", "abbe"):
    moved = vmach.displacement(machine, nose_mm, tool_mm, vmach.Variant(model))
    size_um[model] = 1e3 * np.linalg.norm(moved.shift_mm, axis=1)
    mean_um, largest_um = size_um[model].mean(), size_um[model].max()
    print(f"{model:5s} mean {mean_um:6.2f} um, largest {largest_um:6.2f} um")

excess = size_um["htm"].mean() / size_um["abbe"].mean() - 1.0
print(f"the conventional mean is {100 * excess:.0f} % larger")
