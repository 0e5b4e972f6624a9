"""Virtual part: time, growth and memory, beside two plain ways to use the same library.

    python tests/benchmarks/bench_solid.py            # up to 8,000 moves, a minute or two
    python tests/benchmarks/bench_solid.py --large    # 100,000 moves as well

The job is a wavy raster of a ball end mill: passes 0.5 mm apart, one move a millimetre, diameter
6 mm, chord tolerance 0.01 mm. The peers sweep whole tools: `one by one` subtracts hull after
hull, `one batch` hands all of them to a single set operation. Every row runs in a process of its
own, which gives its peak memory. Growth is that of processor time, which a busy machine disturbs
less than the clock.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
from manifold3d import Manifold, OpType

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from stock import Sweeps, cut_part, find_collisions, make_tool
from stock.solid.ring_stack import ring_stack
from tests.stock_solid_cases import polyline, wavy_raster

BALL = make_tool("ball", diameter_mm=6.0, length_mm=30.0)
FLAT = make_tool("flat", diameter_mm=6.0, length_mm=30.0)
SIZES = {
    "one by one": (250, 500, 1000),
    "one batch": (250, 500, 1000, 2000),
    "cut_part": (500, 1000, 2000, 4000, 8000),
    "level": (2000, 8000),
    "collisions": (2000, 8000),
}
LARGE = {"cut_part": (100_000,), "collisions": (100_000,)}


def raster(moves: int) -> tuple[np.ndarray, tuple[tuple, tuple]]:
    """A raster of about so many moves, and a block around it."""
    rows = max(round(np.sqrt(2 * moves)), 2)
    columns = max(round(moves / rows), 1)
    block = ((-5.0, -5.0, -10.0), (columns + 5.0, 0.5 * rows + 5.0, 0.0))
    return wavy_raster(columns, rows), block


def whole_hulls(path: np.ndarray) -> list[Manifold]:
    stack = ring_stack(BALL, 0.01)
    rings = []
    for (radius, height, *_), count in zip(stack.rings, stack.azimuths, strict=True):
        angle = 2 * np.pi * np.arange(count) / count
        flat = radius * np.column_stack([np.cos(angle), np.sin(angle)])
        rings.append(np.column_stack([flat, np.full(count, height)]))
    tool = np.concatenate(rings)
    return [
        Manifold.hull_points(np.concatenate([start + tool, end + tool]))
        for start, end in pairwise(path)
    ]


def run(way: str, moves: int) -> tuple[int, float, float, int]:
    """Moves made, seconds by the clock and of the processors, triangles or collisions found."""
    path, block = raster(moves)
    box = Manifold.cube(tuple(np.subtract(block[1], block[0]))).translate(block[0])
    if way == "level":
        path = path * [1, 1, 0] - [0, 0, 1]
    sweeps: Sweeps = polyline(path)
    start, start_cpu = time.perf_counter(), time.process_time()
    if way == "one by one":
        solid = box
        for hull in whole_hulls(path):
            solid = solid - hull
            solid.num_tri()
        count = solid.num_tri()
    elif way == "one batch":
        count = Manifold.batch_boolean([box, *whole_hulls(path)], OpType.Subtract).num_tri()
    elif way == "collisions":
        count = len(find_collisions(sweeps, [BALL], block, rapid_moves=[], cell_mm=0.5))
    else:
        tool = FLAT if way == "level" else BALL
        count = len(cut_part(sweeps, [tool], block).triangles)
    return len(sweeps), time.perf_counter() - start, time.process_time() - start_cpu, count


def row(way: str, moves: int) -> tuple[int, float, float, int, float]:
    """The same in a fresh process, after a small job that compiles; peak memory in MB."""
    command = [sys.executable, __file__, "--way", way, "--moves", str(moves)]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    made, seconds, cpu, count, megabytes = text.split()
    return int(made), float(seconds), float(cpu), int(count), float(megabytes)


def table(sizes: dict[str, tuple[int, ...]]) -> None:
    for way, counts in sizes.items():
        print(f"\n{way}\n   moves        s    CPU s  CPU ms/move    found     MB")
        made, spent = [], []
        for moves in counts:
            n, s, cpu, count, megabytes = row(way, moves)
            made.append(n)
            spent.append(cpu)
            print(
                f"{n:8d} {s:8.2f} {cpu:8.2f} {1000 * cpu / n:12.2f} {count:8d} {megabytes:6.0f}",
                flush=True,
            )
        if len(made) > 1:
            slope = np.polyfit(np.log(made), np.log(spent), 1)[0]
            print(f"grows like n^{slope:.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--large", action="store_true", help="100,000 moves as well")
    parser.add_argument("--way", help=argparse.SUPPRESS)
    parser.add_argument("--moves", type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.way:
        run(options.way, 20)
        print(*run(options.way, options.moves), end=" ")
        print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
        return
    table(SIZES)
    if options.large:
        table(LARGE)


if __name__ == "__main__":
    main()
