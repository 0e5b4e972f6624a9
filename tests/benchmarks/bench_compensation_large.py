"""Long programs compensated: time and memory beside reading and running the program once.

    python tests/benchmarks/bench_compensation_large.py [--moves 10000 100000]

The program is a raster of a ball-nose cutter over a wavy floor, lines of 1 mm and half circles
between the rows, on the machine of the sample iso10791_7.
"""

import argparse
import math
import resource
import tempfile
import time
from pathlib import Path

import numpy as np

from vmach.compensation import compensate
from vmach.compensation.model import TipModel
from vmach.job import read_job
from vmach.machine import Variant
from vmach.path.preparation import prepare

SAMPLE = Path(__file__).parents[2] / "samples" / "iso10791_7"
JOB = """schema = 1
machine = "{machine}"
program = "raster.nc"
[work_offsets_mm]
G54 = [-380, -230, -500]
[tools.1]
shape = "ball"
diameter_mm = 6
length_mm = 100
"""
PER_ROW = 80


def raster(moves):
    """Text of the program."""
    rows = max(moves // (PER_ROW + 1), 1)
    step, sense = 60.0 / rows, 1
    lines = ["G21 G17 G90 G94 G54", "T1 M6", "S12000 M3", "G0 X-40. Y-30.", "G43 H1 Z20.",
             "G1 Z2. F800"]  # fmt: skip
    for row in range(rows):
        y = -30.0 + row * step
        for k in range(1, PER_ROW + 1):
            x = sense * (80.0 * k / PER_ROW - 40.0)
            z = 2.0 + 1.5 * math.sin(x / 9.0) * math.cos(y / 7.0)
            lines.append(f"{'G1 ' * (k == 1)}X{x:.3f} Z{z:.3f}")
        lines.append(f"G{3 if sense > 0 else 2} Y{y + step:.4f} I0. J{0.5 * step:.4f}")
        sense = -sense
    return "\n".join([*lines, "G0 Z50.", "M30", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--moves", nargs="*", type=int, default=[10_000, 100_000])
    arguments = parser.parse_args()
    print(f"{'moves':>8} {'read, run s':>12} {'compensate s':>13} {'ratio':>6} {'growth':>7} "
          f"{'fine um':>8} {'peak MiB':>9}")  # fmt: skip
    for moves in arguments.moves:
        with tempfile.TemporaryDirectory() as folder:
            text = JOB.format(machine=SAMPLE / "machine.toml")
            Path(folder, "job.toml").write_text(text)
            Path(folder, "raster.nc").write_text(raster(moves))
            job = read_job(Path(folder))
            begun = time.perf_counter()
            preparation = prepare(job)
            count = len(preparation.path.nodes.moves)
            model = TipModel(Variant.ABBE, ())
            model.error_at(preparation, np.arange(count), np.ones(count))
            once = time.perf_counter() - begun
            begun = time.perf_counter()
            found = compensate(job)
            seconds = time.perf_counter() - begun
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(f"{count:8} {once:12.2f} {seconds:13.1f} {seconds / once:6.1f} {found.growth:7.3f} "
              f"{1e3 * found.unrounded.largest_mm:8.3f} {peak:9.0f}", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
