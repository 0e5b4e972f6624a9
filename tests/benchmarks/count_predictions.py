"""How often 95 % intervals of foretold deviations hold the truth, counted over machines.

    python tests/benchmarks/count_predictions.py --seed SEED [--count 4] --rows rows.csv [--table]

Each case is a machine with one to five hidden effects, of which one part was measured. What the
diagnosis shows is added, and the deviations of another part are foretold. They are compared with
the true ones, which hold no noise, beyond the part's alignment; so is their uncertainty, with all
that points share (GUM, eq. 13). Machines whose effects were not told, or which another part cannot
have, are left out. Rows are written as they come; cases in the file are not run again.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.benchmarks.bench_hidden_effects import append_row, effects_of, read_rows
from tests.hidden_effects import program_runs
from tests.hidden_effects.experiment import SINGLE_KINDS, make_experiment
from tests.hidden_effects.measuring import NOISES
from tests.hidden_effects.part import PartDesign
from tests.hidden_effects.program_runs import alignment_columns
from tests.hidden_effects.verdict import judge
from vmach.base.units import um_from_mm
from vmach.run.pipeline import predict_points
from vmach.uncertainty.first_order import combined_u_mm

KINDS = ("one", "double", "triple", "four", "five")
#: half of the interval of 95 %, in standard uncertainties
COVERAGE = 1.96


def cases(first: int, count: int) -> Iterator[tuple[str, str, int]]:
    """Kind, noise and seed, in an order of chance."""
    every = [(kind, noise) for noise in NOISES for kind in KINDS for _ in range(count)]
    for k in np.random.default_rng(first).permutation(len(every)):
        kind, noise = every[k]
        seed = first + int(k)
        yield SINGLE_KINDS[seed % len(SINGLE_KINDS)] if kind == "one" else kind, noise, seed


def one(kind: str, noise: str, seed: int, folder: Path) -> dict[str, object]:
    """Make, diagnose, add and foretell."""
    hidden = effects_of(kind, seed)
    row = {"kind": kind, "noise": noise, "seed": seed, "effects": len(hidden)}
    row |= dict.fromkeys(("outcome", "points", "inside", "ratio", "rms_um", "u_um"), "")
    design = PartDesign(corners=seed % 3 == 0, two_set_ups=seed % 5 == 0)
    try:
        made = make_experiment(folder, effects=hidden, seed=seed, design=design, noise=noise)
    except ValueError:
        return row | {"outcome": "undrawn"}
    if any(h.once for h in made.hidden):
        return row | {"outcome": "once"}
    report, _ = program_runs.diagnose(folder)
    row["outcome"] = judge(report, json.loads((folder / "truth.json").read_text())).outcome
    if row["outcome"] not in ("right", "class"):
        return row
    job = program_runs.add(folder, report)
    points, program = folder / "check_measured.csv", folder / "check.nc"
    _, prediction = predict_points(job, points, program_path=program)
    columns = alignment_columns(made.check)
    beyond = np.eye(len(columns)) - columns @ np.linalg.pinv(columns)
    off_um = beyond @ (um_from_mm(prediction.deviation_mm) - made.check_deviation_um)
    u_um = um_from_mm(combined_u_mm(prediction, beyond))
    return row | {
        "points": len(off_um),
        "inside": round(float(np.mean(np.abs(off_um) < COVERAGE * u_um)), 4),
        "ratio": round(float(np.sqrt(np.mean(np.square(off_um / u_um)))), 3),
        "rms_um": round(float(np.sqrt(np.mean(off_um**2))), 3),
        "u_um": round(float(np.sqrt(np.mean(u_um**2))), 3),
    }


def print_table(rows: list[dict]) -> None:
    """By noise and by number of effects."""
    told = [row for row in rows if row["inside"]]
    print("| machines | count | points within | of a machine: median | error in u, median |")
    print("|---|---|---|---|---|")
    groups = {noise: [r for r in told if r["noise"] == noise] for noise in NOISES}
    groups |= {f"{n} effects": [r for r in told if int(r["effects"]) == n] for n in range(1, 6)}
    for name, some in (groups | {"all": told}).items():
        if some:
            inside = np.array([float(r["inside"]) for r in some])
            ratio = np.median([float(r["ratio"]) for r in some])
            spread = 2.0 * inside.std() / np.sqrt(len(some))
            print(
                f"| {name.replace('_', ' ')} | {len(some)} | {inside.mean():.1%} +- {spread:.1%} "
                f"| {np.median(inside):.1%} | {ratio:.2f} |"
            )


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=31_000_000)
    parser.add_argument("--count", type=int, default=4)
    parser.add_argument("--table", action="store_true", help="only print the table of the file")
    args = parser.parse_args()
    done = {int(row["seed"]) for row in read_rows(args.rows)}
    for kind, noise, seed in [] if args.table else cases(args.seed, args.count):
        if seed not in done:
            folder = args.rows.with_suffix("") / f"{kind}_{noise}_{seed}"
            row = one(kind, noise, seed, folder)
            append_row(args.rows, row)
            print(*row.values(), flush=True)
            shutil.rmtree(folder, ignore_errors=True)
    print_table(read_rows(args.rows))


if __name__ == "__main__":
    main()
