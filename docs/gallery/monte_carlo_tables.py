"""How sure is the predicted accuracy, if every reading of the laser had an uncertainty?

Draw the corrections of all tables, and look at the interval of the result.
"""

from dataclasses import replace
from pathlib import Path

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"

machine = vmach.read_machine(SAMPLES / "spline_slot" / "machine.toml")
surveyed = replace(machine.uncertainty, reading_mm=0.5e-3, reading_rad=1e-6)
machine = replace(machine, uncertainty=surveyed)

found = vmach.accuracy_interval(machine, grid=(7, 7, 7))
stated, low, high = (1e3 * x[0] for x in (found.stated_mm, found.drawn.low, found.drawn.high))
print(f"as read {stated:.1f} um; with all corrections 95 % lie between {low:.1f} and {high:.1f} um")
for label, share in list(found.share.items())[:3]:
    print(f"{label}: {100 * share:.0f} % of the variance")
