"""How often the diagnosis is right about machines that it never saw.

    python tests/benchmarks/bench_hidden_effects.py --count 5 [--kinds backlash none double]

Every experiment is drawn by `tests/hidden_effects`, diagnosed through the command line, and
judged. The peer in the table is chance and abstention: what an answer "nothing" would score.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.hidden_effects import program_runs
from tests.hidden_effects.experiment import FOREIGN_KINDS, SINGLE_KINDS, make_experiment
from tests.hidden_effects.verdict import OUTCOMES, judge

NOISE_UM = 0.8


def effects_of(kind: str, seed: int) -> list[str]:
    """Names of the effects that an experiment of this kind hides."""
    if kind == "none":
        return []
    if kind != "double":
        return [kind]
    return list(np.random.default_rng([seed, 2]).choice(SINGLE_KINDS, 2, replace=False))


def one(kind: str, seed: int, args: argparse.Namespace) -> dict:
    """Make, diagnose, judge."""
    folder = args.folder / f"{kind}_{seed}"
    made = make_experiment(folder, effects=effects_of(kind, seed), seed=seed)
    truth = json.loads((folder / "truth.json").read_text())
    try:
        report, seconds = program_runs.diagnose(folder)
        found = judge(report, truth)
        ratio = held_out(made, report) if args.held_out else np.nan
    except (RuntimeError, AssertionError) as error:
        print(f"{kind} {seed}: {error}", flush=True)
        return {"kind": kind, "outcome": "wrong", "parameters": [], "ratio": np.nan, "s": np.nan}
    if args.verbose or found.outcome not in ("right", "class"):
        hidden = "; ".join(f"{e['name']} {e['target'] or ''} {e['parameters']}"
                           for e in truth["effects"])
        seen = [round(v, 1) for v in truth["part"]["hidden_visible_um"]]
        print(f"{kind} seed {seed} {found.outcome}\n    hidden {hidden} visible {seen} um"
              f"\n    said {found.said}\n    {found.parameters}", flush=True)
    if not args.keep:
        shutil.rmtree(folder)
    return {"kind": kind, "outcome": found.outcome, "parameters": found.parameters,
            "ratio": ratio, "s": seconds}


def held_out(made, report: dict) -> float:
    """RMS on the check part over the noise, after adding what was named."""
    job = made.folder / "job.toml"
    if report["verdict"] in ("named", "class"):
        job = program_runs.add(made.folder, report)
    residual = program_runs.predicted_um(
        job, made.folder / "check_measured.csv", program=made.folder / "check.nc"
    )
    return program_runs.aligned_rms_um(residual, made.check) / NOISE_UM


def table(rows: list[dict]) -> None:
    """Counts by kind and the totals of the groups."""
    kinds = list(dict.fromkeys(r["kind"] for r in rows))
    groups = {
        "SINGLE": [k for k in kinds if k in SINGLE_KINDS],
        "FOREIGN": [k for k in kinds if k in FOREIGN_KINDS],
    }
    print(f"\n{'kind':22}" + "".join(f"{o:>8}" for o in OUTCOMES) + "   in 95 %  held-out  s")
    for name, members in [*((k, [k]) for k in kinds), *groups.items()]:
        some = [r for r in rows if r["kind"] in members]
        if not some:
            continue
        count = Counter(r["outcome"] for r in some)
        inside = [abs(v - t) <= 1.96 * u for r in some for _, v, u, t in r["parameters"]]
        print(f"{name:22}" + "".join(f"{count[o] or '.':>8}" for o in OUTCOMES)
              + f"   {sum(inside):3d}/{len(inside):<3d} "
              f"{np.nanmedian([r['ratio'] for r in some]):8.2f} "
              f"{np.nanmedian([r['s'] for r in some]):5.1f}")
    print("\ntargets: single right or class 95 %, double 90 %, none wrong at most 1 %,")
    print("foreign named at most 2 %; parameters inside 93 to 97 %")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    every = ["none", *SINGLE_KINDS, "double", *FOREIGN_KINDS]
    parser.add_argument("--kinds", nargs="+", default=every, choices=every)
    parser.add_argument("--count", type=int, default=2)
    parser.add_argument("--seed", type=int, default=100)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--folder", type=Path, default=Path("hidden_experiments"))
    parser.add_argument("--held-out", action="store_true")
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--verbose", action="store_true")
    args = parser.parse_args()
    tasks = [(k, args.seed + n) for n in range(args.count) for k in args.kinds]
    with ProcessPoolExecutor(args.workers) as pool:
        rows = list(pool.map(one, *zip(*tasks, strict=True), [args] * len(tasks)))
    table(rows)


if __name__ == "__main__":
    main()
