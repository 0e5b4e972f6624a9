"""Is the part in tolerance, what of it is doubtful, and which error is to blame?

The sample's job says what its drawing asks for. Every requirement gets a value with its standard
uncertainty, a verdict after ISO 14253-1, the share of each error and the NC lines that made it.
"""

from pathlib import Path

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"

found = vmach.machine_part(SAMPLES / "nas979", solid=False)

for result in found.features:
    value = result.predicted
    room = "" if result.lower_mm is None else f"{result.lower_mm:.3f} .. "
    print(
        f"{result.feature + ', ' + result.title:44s} {value.value_mm:9.4f} mm, "
        f"u {1e3 * value.u_mm:.2f} um, {value.verdict} ({room}{result.upper_mm:.3f})"
    )

roundness = next(r for r in found.features if r.characteristic == "roundness")
print(f"\n{roundness.feature}, {roundness.title}: {roundness.cause}")
for one in roundness.lines:
    print(f"  line {one.line}: {100 * one.share:.0f} % of the points that decide")

# the same part, had the drawing asked for less than a third of the tolerance
tight = 0.3 * roundness.upper_mm
value = roundness.predicted
if value.value_mm - 1.645 * value.u_mm > tight:
    print(f"a roundness of {tight:.4f} mm would not be met")
elif value.value_mm + 1.645 * value.u_mm < tight:
    print(f"a roundness of {tight:.4f} mm would be met as well")
else:
    print(f"a roundness of {tight:.4f} mm: cannot be told")
