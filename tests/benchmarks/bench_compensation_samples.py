"""Compensated samples and other jobs: residual at the tool and on the part, growth, time.

    python tests/benchmarks/bench_compensation_samples.py [JOB ...] [--resolution-mm 0.001]

Without JOB all samples; a JOB is a job file, or a folder that holds jobs in its folders. Every
job is done with both arms of the angular errors, with the tool on its nominal path and (--aim part)
aimed at the part: "aimed" is what that leaves on the part. "least" is a growth that no polyline
undercuts: the pieces that one component of the error across each line asks for alone with both
ends free, and the half circles of the arcs.
"""

import argparse
import math
import time
from pathlib import Path

import numpy as np

from gcode import MoveKind
from vmach.compensation import compensate
from vmach.compensation.model import TipModel
from vmach.compensation.sampling import sample_error
from vmach.compensation.surface import check_surface, read_surface
from vmach.compensation.tube import fewest_pieces
from vmach.effects import read_effects
from vmach.job import read_job
from vmach.machine import Variant
from vmach.preparation import prepare

SAMPLES = Path(__file__).parents[2] / "samples"
TOLERANCE_MM = 1e-4
COLUMNS = (
    f"{'job':34} {'arms':4} {'tool: before':>13} {'fine':>6} {'after':>12} {'part: before':>13} "
    f"{'after':>12} {'ratio':>6} {'tilt':>5} {'aimed':>12} {'ratio':>6} {'shift':>5} "
    f"{'growth':>6} {'aimed':>6} {'least':>6} {'arcs':>7} {'s':>5} {'aimed':>5}"
    "   (um: largest/mean)"
)


def jobs_of(paths):
    """Job files of the arguments; of all samples without any."""
    for path in paths or [SAMPLES]:
        found = [path] if path.is_file() else sorted(path.glob("**/*.toml"))
        yield from (p for p in found if "program" in p.read_text() and "machine =" in p.read_text())


def least_growth(job, model):
    """Growth that the bend of the error asks for, whatever the method."""
    preparation = prepare(job)
    moves = preparation.path.nodes.moves
    used = np.flatnonzero(moves.kind != MoveKind.DWELL)
    along = sample_error(moves, used, lambda m, s: model.error_at(preparation, m, s),
                         tolerance_mm=TOLERANCE_MM)  # fmt: skip
    blocks = 0
    for index, move in enumerate(used):
        kind, (parameter, error) = moves.kind[move], along.of(index)
        if kind == MoveKind.ARC:
            blocks += math.ceil(abs(moves.sweep_rad[move]) / math.radians(181.0))
        elif kind == MoveKind.LINE and along.length_mm[index] > 0:
            blocks += max(_pieces(parameter, error @ side) for side in _across(moves, move))
        else:
            blocks += 1
    return blocks / max(len(used), 1)


def _across(moves, move):
    way = moves.end_mm[move] - moves.start_mm[move]
    one = np.cross(way, np.eye(3)[np.argmin(np.abs(way))])
    return [v / np.linalg.norm(v) for v in (one, np.cross(way, one))]


def _pieces(parameter, curve):
    ends = np.array([[-TOLERANCE_MM], [TOLERANCE_MM]])
    width = np.array([TOLERANCE_MM])
    return len(fewest_pieces(parameter, curve[:, None], width, start=ends, end=ends)[0]) - 1


def compensated(job, effects, variant, surface, aim_points, resolution_mm):
    """The compensated program, what it leaves on the part, and the seconds that it took."""
    begun = time.perf_counter()
    found = compensate(job, effects, variant=variant, resolution_mm=resolution_mm,
                       aim_points=aim_points)  # fmt: skip
    seconds = time.perf_counter() - begun
    part = check_surface(job, found.text, surface, effects=effects, variant=variant)
    return found, part, seconds


def pair(values_mm):
    """Largest and mean size, um."""
    size = 1e3 * np.abs(values_mm)
    return f"{size.max(initial=0.0):.3f}/{size.mean():.3f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("jobs", nargs="*", type=Path)
    parser.add_argument("--resolution-mm", type=float, default=1e-3)
    arguments = parser.parse_args()
    print(COLUMNS)
    growths, leasts = [], []
    for path in jobs_of(arguments.jobs):
        job = read_job(path)
        effects = read_effects(job.effects, file=job.path, job=job)
        surface = read_surface(job, with_aim=True)
        for variant in (Variant.ABBE, Variant.HTM):
            (found, part, seconds), (aimed, on_part, longer) = (
                compensated(job, effects, variant, surface, points, arguments.resolution_mm)
                for points in (None, surface.aim)
            )
            growths.append(found.growth)
            leasts.append(least_growth(job, TipModel(variant, tuple(effects))))
            name = f"{path.parent.name}/{path.name}"
            print(f"{name[-34:]:34} {variant:4} {pair(found.before.distance_mm):>13} "
                  f"{1e3 * found.unrounded.largest_mm:6.3f} {pair(found.after.distance_mm):>12} "
                  f"{pair(part.before_mm):>13} {pair(part.after_mm):>12} {part.ratio:6.1f} "
                  f"{1e3 * np.abs(part.tilt_mm).max():5.2f} {pair(on_part.after_mm):>12} "
                  f"{on_part.ratio:6.1f} {1e3 * aimed.part_aim.largest_shift_mm:5.2f} "
                  f"{found.growth:6.2f} {aimed.growth:6.2f} {leasts[-1]:6.2f} "
                  f"{found.arcs_kept}/{found.arcs:3} {seconds:5.1f} {longer:5.1f}",
                  flush=True)  # fmt: skip
    print(f"mean growth {np.mean(growths):.2f}, least {np.mean(leasts):.2f}")


if __name__ == "__main__":
    main()
