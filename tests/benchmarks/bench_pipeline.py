"""Stage times and peak memory of the main job for growing programs.

    python tests/benchmarks/bench_pipeline.py [largest number of moves]

A wavy ball-end raster over a block of 100 x 100 mm on a machine with all 18 errors and
squareness. Each size runs in a process of its own; times include no compilation (a warm-up run
comes first). The last line gives the growth exponents between the two largest programs.
"""

from __future__ import annotations

import json
import math
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

STAGES = ("read", "displace", "compare", "cut")
SIZES = (300, 1_000, 3_000, 10_000, 30_000)


def write_raster(folder: Path, moves: int) -> Path:
    """A job with about `moves` cutting moves."""
    from tests.small_job import write_job

    rng = np.random.default_rng(1)
    errors = {}
    for axis in "XYZ":
        for kind in "XYZABC":
            size, phase = rng.uniform(2, 6), rng.uniform(0, 6)
            at = (0, 0, -250) if kind in "XYZ" else None
            errors[f"E{kind}{axis}"] = (lambda x, s=size, p=phase: s * math.sin(x / 60 + p), at)
    job = write_job(folder, errors, squareness="[squareness]\nEC0Y = 20\nEB0X = -10\nEA0Y = 8\n")
    rows = max(round(math.sqrt(moves / 10)), 2)
    columns = max(moves // rows, 2)
    lines = ["G21 G17 G90 G94", "T1 M6", "S8000 M3", "G54 G43 H1", "G0 X-50 Y-50 Z20", "F3000"]
    for row, y in enumerate(np.linspace(-50, 50, rows)):
        xs = np.linspace(-50, 50, columns + 1)
        for x in xs if row % 2 == 0 else xs[::-1]:
            z = -3 + 1.5 * math.sin(x / 12) * math.cos(y / 15)
            lines.append(f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f}")
    (folder / "part.nc").write_text("\n".join([*lines, "G0 Z20", "M30"]) + "\n")
    text = job.read_text().replace(
        'shape = "flat"\ndiameter_mm = 10', 'shape = "ball"\ndiameter_mm = 8'
    )
    text = text.replace("[-30, -25, -20]", "[-50, -50, -20]").replace("[60, 25, 0]", "[50, 50, 0]")
    job.write_text(text)
    write_grid(folder / "points.csv")
    return job


def write_grid(path: Path, points: int = 10_000) -> None:
    """Points on the mean wavy surface with its normals."""
    side = round(math.sqrt(points))
    x, y = (a.ravel() for a in np.meshgrid(*2 * [np.linspace(-48, 48, side)]))
    z = -3 + 1.5 * np.sin(x / 12) * np.cos(y / 15)
    slope_x = 1.5 / 12 * np.cos(x / 12) * np.cos(y / 15)
    slope_y = -1.5 / 15 * np.sin(x / 12) * np.sin(y / 15)
    normal = np.column_stack([-slope_x, -slope_y, np.ones_like(x)])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    rows = np.column_stack([x, y, z, normal])
    lines = [f"{k},top," + ",".join(f"{v:.9f}" for v in row) for k, row in enumerate(rows)]
    path.write_text("\n".join(["id,feature,x,y,z,i,j,k", *lines]) + "\n")


def measure(job: str) -> None:
    """Run the main job and print its stage times and this process' peak memory as JSON."""
    from vmach.run.pipeline import machine_part

    made = machine_part(job)
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    moves = len(made.preparation.program.moves)
    print(json.dumps({"moves": moves, "mb": peak_mb, **made.stages_s}))


def run(moves: int) -> dict:
    """Measure one size in a fresh process."""
    with tempfile.TemporaryDirectory() as folder:
        job = write_raster(Path(folder), moves)
        command = [sys.executable, __file__, "--measure", str(job)]
        return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)


def main() -> None:
    """Print the table."""
    largest = int(sys.argv[1]) if len(sys.argv) > 1 else SIZES[-1]
    run(100)
    print(f"{'moves':>8}" + "".join(f"{s + ' s':>12}" for s in STAGES) + f"{'peak MB':>10}")
    results = []
    for size in (s for s in SIZES if s <= largest):
        results.append(run(size))
        cells = "".join(f"{results[-1][s]:12.3f}" for s in STAGES)
        print(f"{results[-1]['moves']:8d}{cells}{results[-1]['mb']:10.0f}", flush=True)
    if len(results) > 1:
        a, b = results[-2:]
        ratio = math.log(b["moves"] / a["moves"])
        growth = "".join(f"{math.log(b[s] / a[s]) / ratio:12.2f}" for s in STAGES)
        print(f"{'exponent':>8}{growth}")


if __name__ == "__main__":
    measure(sys.argv[2]) if sys.argv[1:2] == ["--measure"] else main()
