"""Which physical effect does my model lack?

Compare a measured part with the prediction and read the verdict.
"""

from pathlib import Path

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"

found = vmach.diagnose(SAMPLES / "missing_effect" / "job.toml")
print(f"verdict: {found.verdict}")
print(f"RMS of measured minus predicted: {found.rms_um['before']:.2f} um before, "
      f"{found.rms_um['after']:.2f} um after")  # fmt: skip
for finding in found.findings:
    for name, value in finding.parameters.items():
        low, high = finding.interval_95[name]
        print(f"{finding.label}: {name} = {value:.3g}, 95 % between {low:.3g} and {high:.3g}")
