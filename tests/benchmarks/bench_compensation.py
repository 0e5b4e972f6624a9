"""Compensated programs of a folder: growth, residuals, and LinuxCNC's word on the text.

    python tests/benchmarks/bench_compensation.py FOLDER [--resolution-mm 0.001] [--machine FILE]

FOLDER holds programs with FILE.canon17 beside those that LinuxCNC accepts. Every one becomes a
job of its own on a machine with scale, squareness, straightness and cyclic errors of 10 mm pitch,
or on the machine of FILE, in the middle of its travel.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.oracle.compensation_corpus import corpus_programs, judged


def _path(outcome):
    """Largest distance from the intended path, and the largest over what rounding may leave."""
    if outcome.path is None:
        return f"{'-':>7} {'-':>8}"
    return f"{1e3 * outcome.path.worst_mm:7.3f} {outcome.path.worst_ratio:8.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", default="", help="part of the names")
    parser.add_argument("--machine", type=Path, help="machine file with measured errors")
    parser.add_argument("--resolution-mm", type=float, default=1e-3)
    arguments = parser.parse_args()
    head = f"{'program':24} {'s':>6} {'growth':>6} {'arcs':>9} {'before':>7} {'fine':>7}"
    print(f"{head} {'after':>7} {'path':>7} {'of bound':>8}  LinuxCNC   (um)")
    same = "same path" if arguments.machine is None else "accepted"
    growth, blocks, accepted, refused = [], [], 0, 0
    programs = [p for p in corpus_programs(arguments.folder) if arguments.only in p.name]
    for path in programs:
        begun = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            outcome = judged(
                folder, path, machine=arguments.machine, resolution_mm=arguments.resolution_mm
            )
        seconds = time.perf_counter() - begun
        found = outcome.found
        if found is None:
            refused += 1
            print(
                f"{path.name:24} {seconds:6.1f} refused: {outcome.refusal.rsplit('/', 1)[-1][:150]}"
            )
            continue
        growth.append(found.growth)
        blocks.append(outcome.blocks)
        accepted += outcome.linuxcnc is None and not outcome.wrong
        sizes = [1e3 * r.largest_mm for r in (found.before, found.unrounded, found.after)]
        word = outcome.linuxcnc or (outcome.wrong[0] if outcome.wrong else same)
        print(f"{path.name:24} {seconds:6.1f} {found.growth:6.2f} "
              f"{found.arcs_kept:4}/{found.arcs:4} {sizes[0]:7.2f} {sizes[1]:7.3f} "
              f"{sizes[2]:7.3f} {_path(outcome)}  {word[:160]}")  # fmt: skip
    print(f"{len(programs)} programs: {accepted} LinuxCNC: {same}, {refused} refused")
    together = np.average(growth, weights=np.maximum(blocks, 1))
    print(f"growth: mean {np.mean(growth):.2f}, without the largest "
          f"{np.mean(sorted(growth)[:-1] or growth):.2f}, half below {np.median(growth):.2f}, "
          f"all blocks together {together:.3f}")  # fmt: skip


if __name__ == "__main__":
    main()
