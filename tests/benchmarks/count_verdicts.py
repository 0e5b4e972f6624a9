"""How often verdicts are right on machines that nothing was set on: the table of the docs.

    python tests/benchmarks/count_verdicts.py --rows counts.csv [--count 4] [--table]

Every kind of noise and every number of hidden effects gets so many cases, and twice as many
foreign causes. Rows are written as they come; cases in the file are not run again.
"""

from __future__ import annotations

import argparse
import sys
from argparse import Namespace
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.benchmarks.bench_hidden_effects import (
    append,
    binomial,
    determined,
    one,
    read_rows,
)
from tests.hidden_effects.experiment import FOREIGN_KINDS, SINGLE_KINDS
from tests.hidden_effects.measuring import NOISES

#: groups of the table, with the kinds of each and how many times as many cases it gets
GROUPS: dict[str, tuple[tuple[str, ...], int]] = {
    "nothing": (("none",), 1),
    "one effect": (SINGLE_KINDS, 1),
    "two effects": (("double",), 1),
    "three effects": (("triple",), 1),
    "four or five": (("four", "five"), 1),
    "something unknown": (FOREIGN_KINDS, 2),
}


def cases(first_seed: int, count: int) -> list[tuple[str, str, int]]:
    """Kind, noise and seed; kinds of a group in an order of chance, all before any twice."""
    found = []
    for number, (kinds, times) in enumerate(GROUPS.values()):
        order = np.random.default_rng([first_seed, number]).permutation(len(kinds))
        for k in range(times * count * len(NOISES)):
            noise = list(NOISES)[k % len(NOISES)]
            found.append((kinds[order[k % len(kinds)]], noise, first_seed + 1000 * number + k))
    return [found[k] for k in np.random.default_rng(first_seed).permutation(len(found))]


def print_table(rows: list[dict]) -> None:
    """Counts as Markdown, by group and by noise."""
    rows = [row for row in rows if row["outcome"] != "undrawn"]
    print("| hidden | cases | right or in the class | 95 % limits | a false name | 95 % limits |")
    print("|---|---|---|---|---|---|")
    for name, (kinds, _) in GROUPS.items():
        _print_line(name, [row for row in rows if row["kind"] in kinds])
    print("\n| noise | cases | right or in the class | 95 % limits | a false name | 95 % limits |")
    print("|---|---|---|---|---|---|")
    for noise in NOISES:
        _print_line(noise.replace("_", " "), [row for row in rows if row["noise"] == noise])
    print("\n| of | count | share | 95 % limits |\n|---|---|---|---|")
    known = [row for row in rows if row["kind"] not in GROUPS["something unknown"][0]]
    _print_share("effects said to be shown that are there", rows, "true", "named")
    _print_share("effects that are there that are said to be shown", known, "true", "hidden_count")
    _print_forms(rows)
    hits = [low <= true <= high for row in rows for _, _, low, high, true in determined(row)]
    _print_counts("95 % intervals of parameters that hold the truth", sum(hits), len(hits))


def _print_forms(rows: list[dict]) -> None:
    clean = [row for row in rows if row["kind"] == "none"]
    _print_counts("clean machines with a form", _count(clean, _has_forms), len(clean))
    foreign = [row for row in rows if row["states"]]
    named = _count(foreign, lambda row: row["states"] == "1")
    _print_counts("true states in the first three forms", named, len(foreign))
    halved = _count(foreign, lambda row: float(row["misfit_left"]) <= 0.5)
    _print_counts("misfit of the check part halved by the first form", halved, len(foreign))


def _has_forms(row: dict) -> bool:
    return int(row["forms"] or 0) > 0


def _print_line(name: str, rows: list[dict]) -> None:
    right = _count(rows, lambda row: row["outcome"] in ("right", "class"))
    false = _count(rows, lambda row: int(row["named"] or 0) > int(row["true"] or 0))
    limits = [_limits(hits, len(rows)) for hits in (right, false)]
    print(f"| {name} | {len(rows)} | {right} | {limits[0]} | {false} | {limits[1]} |")


def _print_share(name: str, rows: list[dict], hits: str, of: str) -> None:
    _print_counts(name, *(sum(int(row[column] or 0) for row in rows) for column in (hits, of)))


def _print_counts(name: str, hits: int, count: int) -> None:
    if count:
        print(f"| {name} | {hits} of {count} | {hits / count:.1%} | {_limits(hits, count)} |")


def _count(rows: list[dict], holds: Callable[[dict], bool]) -> int:
    return sum(holds(row) for row in rows)


def _limits(hits: int, count: int) -> str:
    if not count:
        return ""
    low, high = binomial(hits, count)
    return f"{100 * low:.0f} to {100 * high:.0f} %"


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=Path, required=True)
    parser.add_argument("--count", type=int, default=4, help="cases of a group and a noise")
    parser.add_argument("--seed", type=int, default=960_000)
    parser.add_argument("--table", action="store_true", help="only print the table of the file")
    args = parser.parse_args()
    rows = read_rows(args.rows)
    done = {(row["kind"], row["noise"], int(row["seed"])) for row in rows}
    for kind, noise, seed in [] if args.table else cases(args.seed, args.count):
        if (kind, noise, seed) not in done:
            folder = args.rows.with_suffix("")
            settings = Namespace(
                folder=folder, noise=noise, instruments=[], held_out=False, keep=False
            )
            row = one(kind, seed, settings)
            append(args.rows, row)
            print(kind, noise, seed, row["outcome"], row["said"], flush=True)
    print_table(read_rows(args.rows))


if __name__ == "__main__":
    main()
