"""Displacement of a million points against a loop of matrices; volumetric accuracy of grids.

python tests/benchmarks/bench_machine.py
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from scipy.spatial.distance import cdist

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.machine_cases import make_machine, random_components, random_squareness
from vmach.machine import Variant, displacement
from vmach.machine.exact import exact_displacement
from vmach.volumetric import assess, error_field, farthest_pair, measured_volume

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


def bench_displacement() -> None:
    rng = np.random.default_rng(1)
    machine = make_machine(
        "t (C) Z Y b X' w", random_components(rng), squareness_rad=random_squareness(rng)
    )
    nose = rng.uniform(-500, 500, (POINTS, 3))
    both = (Variant.HTM, Variant.ABBE)
    start = time.perf_counter()
    for variant in both:
        displacement(machine, nose[:10], TOOL_MM, variant)
    print(f"first call, compiled code from the cache or new  {time.perf_counter() - start:8.3f} s")

    def two_variants():
        for variant in both:
            displacement(machine, nose, TOOL_MM, variant)

    few, some = nose[:LOOP_POINTS], nose[:50_000]
    here = displacement(machine, few, TOOL_MM, Variant.HTM).shift_mm
    difference_um = np.abs(loop_of_matrices(machine, few) - here).max() * 1e3
    seconds = best_of(5, two_variants)
    loop = best_of(2, lambda: loop_of_matrices(machine, few)) * POINTS / LOOP_POINTS
    exact = best_of(2, lambda: exact_displacement(machine, some, TOOL_MM, Variant.HTM))
    print(f"{POINTS} points, 21 errors, both variants          {seconds:8.3f} s")
    print(f"exact product, batched, one variant (from 50000) {exact * POINTS / 5e4:8.3f} s")
    print(f"loop of 4x4 matrices, one variant (from {LOOP_POINTS})    {loop:8.3f} s")
    print(f"ratio loop / here, one variant                   {loop / (seconds / 2):8.0f}")
    print(f"largest difference to the loop                   {difference_um:8.4f} um")


def bench_volumetric_accuracy() -> None:
    rng = np.random.default_rng(1)
    machine = make_machine("t (C) Z Y b X' w", random_components(rng))
    assess(error_field(machine, measured_volume(machine, (41, 41, 41)), TOOL_MM, Variant.ABBE))
    for count in (9, 21, 201):
        volume = measured_volume(machine, (count,) * 3)
        repeats = 1 if count > 100 else 5
        seconds = best_of(
            repeats, lambda v=volume: assess(error_field(machine, v, TOOL_MM, Variant.ABBE))
        )
        print(f"volumetric accuracy, {count:3} cubed                 {seconds:8.3f} s")
    vectors = error_field(
        machine, measured_volume(machine, (21,) * 3), TOOL_MM, Variant.ABBE
    ).error_mm
    every = best_of(1, lambda: max(cdist(block, vectors).max() for block in np.split(vectors, 21)))
    hull = best_of(5, lambda: farthest_pair(vectors))
    print(f"all 42 878 430 comparisons of 21 cubed           {every:8.3f} s")
    print(f"hull and its farthest pair                       {hull:8.3f} s")


def main() -> None:
    bench_displacement()
    bench_volumetric_accuracy()


if __name__ == "__main__":
    main()
