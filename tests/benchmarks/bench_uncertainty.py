"""How often a coverage interval holds the truth, and how long a thousand points take.

    python tests/benchmarks/bench_uncertainty.py                  # 10,000 machines: some minutes
    python tests/benchmarks/bench_uncertainty.py --machines 1000

Every simulated machine is measured once and its part predicted once; one point of it, chosen at
random, is held against the truth, so that the trials are independent. Of 10,000 such trials of an
interval of 95 %, between 94.4 and 95.6 % hold the truth in 99.4 % of all runs of this script.
`between positions` has true curves that bend between the positions of the tables.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from tests.simulated_machines import trials, workshop
from vmach.uncertainty.corrections import Corrections, Part
from vmach.uncertainty.coverage import coverage_factor
from vmach.uncertainty.monte_carlo import STAGE_DRAWS, Plan, propagate
from vmach.uncertainty.points import point_corrections

PLAN = Plan(most_draws=2 * STAGE_DRAWS)


def coverage(machines: int, *, smooth: bool) -> None:
    """Print the share of intervals that hold the truth."""
    with tempfile.TemporaryDirectory() as folder:
        place = workshop(Path(folder), at_positions=not smooth)
    drawn_holds, first_holds, widths = 0, 0, []
    choice = np.random.default_rng(7)
    for trial in trials(place, machines, seed=3, smooth=smooth, by_engine=False):
        row = int(choice.integers(len(trial.true_mm)))
        corrections = point_corrections(trial.predicted, np.array([row]))
        estimate = trial.predicted.deviation_mm[trial.predicted.is_cut][row]
        few = corrections.for_drawing()
        found = propagate(lambda r, m, c=few, y=estimate: y + c.values_mm(c.draw(r, m)), PLAN)
        true = trial.true_mm[row]
        drawn_holds += bool(found.low[0] <= true <= found.high[0])
        first_holds += abs(true - estimate) <= coverage_factor(0.95) * corrections.u_mm[0]
        widths.append(1e3 * (found.high[0] - found.low[0]))
    where = "between positions" if smooth else "at the tables' positions"
    print(f"{where}: {machines} machines, drawn {100 * drawn_holds / machines:.2f} %, "
          f"first order {100 * first_holds / machines:.2f} %, "
          f"interval {np.mean(widths):.2f} um wide", flush=True)  # fmt: skip


def speed(points: int = 1000, causes: int = 200, draws: int = 100_000) -> None:
    """Print the time of so many points and draws."""
    signature = np.random.default_rng(1).normal(0.0, 1e-4, (points, causes))
    corrections = Corrections.of([Part("one", signature)], points)
    plan = Plan(least_draws=draws, most_draws=draws)
    start, cpu = time.perf_counter(), time.process_time()
    for begin in range(0, points, plan.points_at_once()):
        some = corrections.rows(slice(begin, begin + plan.points_at_once()))
        propagate(lambda random, m, c=some: c.values_mm(c.draw(random, m)), plan)
    clock, cpu = time.perf_counter() - start, time.process_time() - cpu
    print(f"{points} points, {causes} causes, {draws} draws: clock {clock:.1f} s, "
          f"processor {cpu:.1f} s", flush=True)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--machines", type=int, default=10_000)
    options = parser.parse_args()
    speed()
    for smooth in (False, True):
        coverage(options.machines, smooth=smooth)


if __name__ == "__main__":
    main()
