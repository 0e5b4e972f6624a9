"""Displacement of a million points through 21 tabulated errors, against a loop of matrices.

python tests/benchmarks/bench_machine.py
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.machine_cases import make_machine, random_components, random_squareness
from vmach.machine import Variant, displacement
from vmach.machine.exact import exact_displacement

POINTS = 1_000_000
LOOP_POINTS = 2_000
TOOL_MM = np.array([0.0, 0.0, -150.0])


def best_of(repeats: int, work) -> float:
    """Shortest time of several runs, s."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def matrix(shift, angle):
    """First-order homogeneous matrix of one body's error."""
    a, b, c = angle
    x, y, z = shift
    return np.array([[1, -c, b, x], [c, 1, -a, y], [-b, a, 1, z], [0, 0, 0, 1.0]])


def loop_of_matrices(machine, nose):
    """The usual program: np.interp for 18 tables and a product of 4x4 matrices a point."""
    tables = {n: (c.position_mm, c.mean) for n, c in machine.components.items()}
    shift = np.empty_like(nose)
    for p, q in enumerate(nose):
        sides = []
        for axes, sign in (("YZ", 1.0), ("X", -1.0)):
            product = np.eye(4)
            for axis in axes:
                j = "XYZ".index(axis)
                error = [np.interp(q[j], *tables[f"E{kind}{axis}"]) for kind in "XYZABC"]
                way = np.eye(3)[j] + np.cross(machine.squareness_rad[j], np.eye(3)[j])
                travel = matrix(sign * q[j] * way, (0, 0, 0))
                body = matrix(sign * np.array(error[:3]), sign * np.array(error[3:]))
                product = product @ travel @ body
            sides.append(product)
        tip = np.linalg.inv(sides[1]) @ sides[0] @ np.append(TOOL_MM, 1.0)
        shift[p] = tip[:3] - TOOL_MM - q
    return shift


def main() -> None:
    rng = np.random.default_rng(1)
    machine = make_machine(
        "t (C) Z Y b X' w", random_components(rng), squareness_rad=random_squareness(rng)
    )
    nose = rng.uniform(-500, 500, (POINTS, 3))
    start = time.perf_counter()
    both = {v: displacement(machine, nose[:10], TOOL_MM, v) for v in (Variant.HTM, Variant.ABBE)}
    print(
        f"first call (compiled code from the cache or made now) {time.perf_counter() - start:.2f} s"
    )

    def two_variants():
        for variant in both:
            displacement(machine, nose, TOOL_MM, variant)

    few = nose[:LOOP_POINTS]
    difference = (
        loop_of_matrices(machine, few) - displacement(machine, few, TOOL_MM, Variant.HTM).shift_mm
    )
    seconds = best_of(5, two_variants)
    loop = best_of(2, lambda: loop_of_matrices(machine, few)) * POINTS / LOOP_POINTS
    exact = best_of(2, lambda: exact_displacement(machine, nose[:50_000], TOOL_MM, Variant.HTM))
    print(f"{POINTS} points, 21 errors, both variants          {seconds:8.3f} s")
    print(
        f"exact product, batched numpy, one variant        {exact * POINTS / 5e4:8.1f} s (from 50000)"
    )
    print(f"loop of 4x4 matrices in numpy, one variant       {loop:8.1f} s (from {LOOP_POINTS})")
    print(f"ratio loop / here, one variant                   {loop / (seconds / 2):8.0f}")
    print(
        f"largest difference to the loop                   {np.abs(difference).max() * 1e3:8.4f} um"
    )


if __name__ == "__main__":
    main()
