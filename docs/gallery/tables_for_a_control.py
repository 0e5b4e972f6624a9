"""What do I load into the control, and what is left then?

Compensation tables for LinuxCNC, read back and applied as the control would.
"""

import tempfile
from pathlib import Path

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"

machine = vmach.read_machine(SAMPLES / "spline_slot" / "machine.toml")
with tempfile.TemporaryDirectory() as folder:
    made = vmach.control_tables(machine, Path(folder) / "tables", formats=["linuxcnc"])
    for one in made:
        print(f"{one.name}: {len(one.files)} files, {one.entries} entries along X, Y, Z")
        print(
            f"mean error {1e3 * one.before.mean_mm:.2f} um before, "
            f"{1e3 * one.after.mean_mm:.2f} um with the tables"
        )
        print(one.files[0].read_text().splitlines()[0])
