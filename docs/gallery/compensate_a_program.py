"""Can the program be moved against the machine's errors?

Write the compensated program and state what it leaves.
"""

from pathlib import Path

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"

found = vmach.compensate(SAMPLES / "mazak_ajv25" / "toolpath1.toml")
print(found.text.decode().splitlines()[0])
print(
    f"tool off its path by up to {1e3 * found.before.largest_mm:.2f} um before, "
    f"{1e3 * found.after.largest_mm:.2f} um after; {found.growth:.2f} times as many blocks"
)
assert found.after.mean_mm < found.before.mean_mm
