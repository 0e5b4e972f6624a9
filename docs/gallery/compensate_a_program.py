"""Can the program be moved against the machine's errors?

Write the compensated program and state what it leaves.
"""

from pathlib import Path

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
JOB = SAMPLES / "mazak_ajv25" / "toolpath1.toml"

found = vmach.compensate(JOB)
before = JOB.with_name("toolpath1.nc").read_text().splitlines()
after = found.text.decode().splitlines()
first = next(k for k, pair in enumerate(zip(before, after, strict=False)) if pair[0] != pair[1])
print(f"{len(before)} lines before, {len(after)} after; line {first + 1} was and is")
print(f"   {before[first]}\n   {after[first]}")
print(
    f"tool off its path by up to {1e3 * found.before.largest_mm:.2f} um before, "
    f"{1e3 * found.after.largest_mm:.2f} um after; {found.growth:.2f} times as many blocks"
)
assert found.after.mean_mm < found.before.mean_mm
