"""How much better is the model with the missing effect in it?

Fit the named effect to the measurements, write a new job that holds it, and compare again.
"""

import tempfile
from pathlib import Path

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
JOB = SAMPLES / "missing_effect" / "job.toml"

before = vmach.compare(JOB, models=["abbe"])
with tempfile.TemporaryDirectory() as folder:
    job, added = vmach.add(JOB, ["backlash:Y"], out=Path(folder) / "with_backlash.toml")
    after = vmach.compare(job, models=["abbe"])
for effect in added:
    print(f"added {effect.label}: {effect.parameters}")
print(f"measured minus predicted, RMS: {before.remainder_rms_um['abbe']:.2f} um before, "
      f"{after.remainder_rms_um['abbe']:.2f} um after")  # fmt: skip
assert after.remainder_rms_um["abbe"] < before.remainder_rms_um["abbe"]
