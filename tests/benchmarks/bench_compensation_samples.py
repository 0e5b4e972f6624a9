"""Compensated samples and other jobs: residual at the tool and on the part, growth, time.

    python tests/benchmarks/bench_compensation_samples.py [JOB ...] [--resolution-mm 0.001]

Without JOB all samples; a JOB is a job file, or a folder that holds jobs in its folders. Every
job is done with both arms of the angular errors, with the tool on its nominal path and (--aim part)
aimed at the part. Of the latter:

fine    what is left on the part before rounding: what no shift of the path mends
aimed   what is left after rounding
added   what rounding adds at each point
grid    what no choice of grid points undercuts, if every block had its own two ends for itself
        and each point stays with the move that makes it: largest / mean on the part
shift   largest shift of the path
least   growth that no polyline undercuts: the pieces that one component of the error across each
        line asks for alone with both ends free, and the half circles of the arcs
"""

import argparse
import math
import time
from pathlib import Path

import numpy as np
from numba import njit

from gcode import MoveKind
from vmach.compensation.aim.part_view import PartView
from vmach.compensation.aim.probes import ProbeSets, surface_probes
from vmach.compensation.aim.surface import check_surface, read_surface
from vmach.compensation.compensate import finish, solve
from vmach.compensation.grid.rounding import Rounding
from vmach.compensation.grid.stretch import Stretch
from vmach.compensation.model import TipModel
from vmach.compensation.pieces.sampling import sample_error
from vmach.compensation.pieces.tube import fewest_pieces
from vmach.effects import read_effects
from vmach.job import read_job
from vmach.machine import Variant
from vmach.path.preparation import prepare

SAMPLES = Path(__file__).parents[2] / "samples"
TOLERANCE_MM = 1e-4
COLUMNS = (
    f"{'job':34} {'arms':4} {'tool: before':>13} {'fine':>6} {'after':>12} {'part: before':>13} "
    f"{'after':>12} {'ratio':>6} {'tilt':>5} {'fine':>12} {'aimed':>12} {'ratio':>6} {'added':>12} "
    f"{'grid':>12} {'shift':>5} {'growth':>6} {'aimed':>6} {'least':>6} {'arcs':>7} {'s':>5} "
    f"{'aimed':>5}   (um: largest/mean)"
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
    """The compensated program, what it leaves on the part, seconds; and it before rounding."""
    begun = time.perf_counter()
    solved = solve(job, effects, variant=variant, aim_points=aim_points, round_points=surface.aim)
    found = finish(solved, resolution_mm=resolution_mm)
    seconds = time.perf_counter() - begun
    part = check_surface(job, found.text, surface, effects=effects, variant=variant)
    return found, part, seconds, solved


class BeforeRounding:
    """The part before rounding at the inspection points, and what the grid leaves at least."""

    def __init__(self, solved, points, resolution_mm):
        iteration, solution = solved.iteration, solved.solution
        view = PartView(iteration.preparation, iteration.model, points)
        self.part = view.deviation(solution.run)
        rounding = Rounding(iteration.rewriter, solution.plan, solution.target, resolution_mm)
        probes = surface_probes(self.part, points.normal[self.part.row],
                                left_mm=self.part.error_mm,
                                path_length_mm=1.0)  # fmt: skip
        every = np.arange(len(solution.plan.pieces))
        whole = Stretch(rounding.pieces, ProbeSets.of(probes), 0, len(every))
        course, exact = whole.course, whole.exact
        _, places = rounding._best(whole, every)
        ends = whole.points(places, every)
        step_mm = rounding.step_mm.max()
        largest, total = least_of_pieces(course, exact, ends)
        self.least = f"{1e3 * step_mm * largest:.3f}/{1e3 * step_mm * total / len(probes.move):.3f}"

    def added(self, after):
        """Deviations after rounding minus before, where both programs cut the point."""
        before = np.full(after.row.max() + 1, np.nan)
        known = self.part.row < len(before)
        before[self.part.row[known]] = self.part.error_mm[known]
        change = after.after_mm - before[after.row]
        return change[np.isfinite(change)]


@njit(cache=True)
def least_of_pieces(course, exact, points):
    """Largest, and sum, of the deviations at the probes, each piece with its best two ends."""
    largest, total = 0.0, 0.0
    tries = points.parameter.shape[1]
    for k in range(len(course.begin)):
        table, row, count = (points, k - 1, tries) if k else (exact, 0, 1)
        least, least_sum = np.inf, np.inf
        for i in range(count):
            first, p0 = course.begin[k], course.start[k]
            if first < 0:
                first, p0 = table.bound[row, i], table.parameter[row, i]
            for j in range(tries):
                last, p1 = points.bound[k, j], points.parameter[k, j]
                worst, added = 0.0, 0.0
                for probe in range(first, last):
                    share = (course.parameter[probe] - p0) / (p1 - p0) if p1 > p0 else 0.0
                    place = (1.0 - share) * table.at_start[row, i] + share * points.at_end[k, j]
                    x = abs(course.base[probe] + (course.normal[probe] * place).sum())
                    worst, added = max(worst, x), added + x
                least, least_sum = min(least, worst), min(least_sum, added)
        largest, total = max(largest, least), total + least_sum
    return largest, total


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
            (found, part, seconds, _), (aimed, on_part, longer, solved) = (
                compensated(job, effects, variant, surface, points, arguments.resolution_mm)
                for points in (None, surface.aim)
            )
            growths.append(found.growth)
            leasts.append(least_growth(job, TipModel(variant, tuple(effects))))
            exact = BeforeRounding(solved, surface.points, arguments.resolution_mm)
            name = f"{path.parent.name}/{path.name}"
            print(f"{name[-34:]:34} {variant:4} {pair(found.before.distance_mm):>13} "
                  f"{1e3 * found.unrounded.largest_mm:6.3f} {pair(found.after.distance_mm):>12} "
                  f"{pair(part.before_mm):>13} {pair(part.after_mm):>12} {part.ratio:6.1f} "
                  f"{1e3 * np.abs(part.tilt_mm).max():5.2f} {pair(exact.part.error_mm):>12} "
                  f"{pair(on_part.after_mm):>12} {on_part.ratio:6.1f} "
                  f"{pair(exact.added(on_part)):>12} {exact.least:>12} "
                  f"{1e3 * aimed.part_aim.largest_shift_mm:5.2f} "
                  f"{found.growth:6.2f} {aimed.growth:6.2f} {leasts[-1]:6.2f} "
                  f"{found.arcs_kept}/{found.arcs:3} {seconds:5.1f} {longer:5.1f}",
                  flush=True)  # fmt: skip
    print(f"mean growth {np.mean(growths):.2f}, least {np.mean(leasts):.2f}")


if __name__ == "__main__":
    main()
