"""How far off will the part be, and what causes it?

Predict the deviation of points on a test piece before it is cut, with the NC line that makes each
point and the share of every machine error.
"""

from pathlib import Path

import numpy as np

import vmach

SAMPLES = Path(__file__).resolve().parents[2] / "samples"

# three points on the flanks of the contouring test piece of ISO 10791-7, and their outward normals
places_mm = [[80.0, 5.0, -30.0], [-80.0, 5.0, -30.0], [5.0, -80.0, -30.0]]
normals = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]

found = vmach.predict(SAMPLES / "iso10791_7" / "job.toml", vmach.surface_points(places_mm, normals))
for k in range(len(found)):
    if not found.is_cut[k]:
        print(f"point {found.id[k]}: {found.status[k]}")
        continue
    shares = {name: share[k] for name, share in found.share_um.items()}
    largest = max(shares, key=lambda name: abs(shares[name]))
    print(
        f"point {found.id[k]}: {found.deviation_um[k]:+.2f} um (u = {found.u_um[k]:.2f} um), "
        f"line {found.line[k]}, most of it by {largest}: {shares[largest]:+.2f} um"
    )

assert np.isfinite(found.deviation_um[found.is_cut]).all()
