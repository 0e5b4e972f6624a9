"""How sure is the predicted accuracy, if every reading of the laser had an uncertainty?

Draw error tables within their standard uncertainty, and look at the spread of the result.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
U_READING = {False: 0.5e-3, True: 1e-6}  # standard uncertainty: mm, rad
DRAWS = 40

machine = vmach.read_machine(SAMPLES / "spline_slot" / "machine.toml")
random = np.random.default_rng(seed=1)


def drawn(component):
    """The same table with other readings."""
    noise = random.normal(scale=U_READING[component.is_angle], size=component.position_mm.shape)
    return replace(
        component, forward=component.forward + noise, backward=component.backward + noise
    )


values_um = []
for _ in range(DRAWS):
    components = {name: drawn(component) for name, component in machine.components.items()}
    other = replace(machine, components=components)
    values_um.append(1e3 * vmach.accuracy(other, grid=(7, 7, 7)).largest_difference_mm)
as_read_um = 1e3 * vmach.accuracy(machine, grid=(7, 7, 7)).largest_difference_mm
low, high = np.percentile(values_um, [2.5, 97.5])
print(f"as read {as_read_um:.1f} um; of {DRAWS} draws 95 % lie between {low:.1f} and {high:.1f} um")
