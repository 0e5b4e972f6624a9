"""How often verdicts are right on machines that nothing was set on: the table of the docs.

    python tests/benchmarks/count_verdicts.py --rows counts.csv --seed SEED [--part 1/2] [--table]

Every kind of noise and every number of hidden effects gets its cases, most of them with white
noise, with which the other kinds are compared. Rows are written as they come; cases in the file
are not run again. Several processes share the cases by `--part`, each with a file of its own;
`--rows` may be given again, to print one table of all. `--group "one effect" --cases 252` runs so
many of one group with white noise, its kinds in turn.
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
    append_row,
    binomial,
    determined,
    one,
    read_rows,
)
from tests.benchmarks.told_by_effect import print_told_by_effect
from tests.hidden_effects.experiment import FOREIGN_KINDS, SINGLE_KINDS
from tests.hidden_effects.measuring import NOISES, PEERS

#: an effect and a cause that no catalogue holds, together
BESIDE = tuple(f"{known}+{foreign}" for foreign in FOREIGN_KINDS for known in SINGLE_KINDS)
#: groups of the table: kinds of each, cases with white noise, and with each other kind
GROUPS: dict[str, tuple[tuple[str, ...], int, int]] = {
    "nothing": (("none",), 24, 24),
    "one effect": (SINGLE_KINDS, 24, 10),
    "two effects": (("double",), 24, 10),
    "three effects": (("triple",), 24, 10),
    "four effects": (("four",), 12, 5),
    "five effects": (("five",), 12, 5),
    "something unknown": (FOREIGN_KINDS, 8, 8),
    "one effect and something unknown": (BESIDE, 8, 4),
}
#: seeds from one kind of noise to the next, and from one group to the next
_PER_NOISE, _PER_GROUP = 10_000, 1_000


def cases(first_seed: int) -> list[tuple[str, str, int]]:
    """Kind, noise and seed; kinds of a group in an order of chance, all before any twice.

    Known effects whose `u_um` is half the truth come once more, where it is the truth.
    """
    random, found = np.random.default_rng(first_seed), []
    for i, noise in enumerate(NOISES):
        for j, (kinds, white, other) in enumerate(GROUPS.values()):
            order, seed = random.permutation(len(kinds)), first_seed + _PER_NOISE * i
            for k in range(white if noise == "white" else other):
                kind = kinds[order[k % len(kinds)]]
                found.append((kind, noise, seed + _PER_GROUP * j + k))
    mixed = [found[k] for k in random.permutation(len(found))]
    unknown = (*FOREIGN_KINDS, *BESIDE, "none")
    halves = [(k, seed) for k, noise, seed in mixed if noise == "u_half" and k not in unknown]
    return mixed + [(kind, "loud", seed) for kind, seed in halves]


def cases_of(group: str, count: int, first_seed: int) -> list[tuple[str, str, int]]:
    """The same of one group with white noise, its kinds in turn."""
    kinds, *_ = GROUPS[group]
    return [(kinds[k % len(kinds)], "white", first_seed + k) for k in range(count)]


def print_table(rows: list[dict]) -> None:
    """Counts as Markdown, by group and by noise."""
    every = [row for row in rows if row["outcome"] != "undrawn"]
    rows = [row for row in every if row["noise"] not in PEERS]
    white = [row for row in rows if row["noise"] == "white"]
    others = [row for row in rows if row["noise"] != "white"]
    for name, some in (("white noise", white), ("other noise", others)):
        print(
            f"| hidden, {name} | cases | right or in the class | limits | in a larger class "
            "| a false name | limits |"
        )
        print("|---|---|---|---|---|---|---|")
        for group, (kinds, *_) in GROUPS.items():
            _print_line(group, [row for row in some if row["kind"] in kinds])
        print()
    print(
        "| noise | clean: named | one to five: right | limits | said: there | there: said | 95 % |"
    )
    print("|---|---|---|---|---|---|---|")
    for noise in NOISES | PEERS:
        _print_noise(noise, [row for row in every if row["noise"] == noise])
    print("\n| of | count | share | 95 % limits |\n|---|---|---|---|")
    for name, some in (("white noise", white), ("all noise", rows)):
        known = [row for row in some if row["kind"] not in (*FOREIGN_KINDS, *BESIDE)]
        _print_share(f"effects said that are there, {name}", some, "true", "named")
        _print_share(f"effects there that are said, {name}", known, "true", "hidden_count")
    _print_forms(rows)
    told = [row for row in rows if row["outcome"] in ("right", "class", "vague")]
    for name, some in (("", rows), (" where all effects are told", told)):
        hits = _held(some)
        _print_counts(f"95 % intervals that hold the truth{name}", sum(hits), len(hits))
    print()
    print_told_by_effect([row for row in rows if row["kind"] not in (*FOREIGN_KINDS, *BESIDE)])


def _held(rows: list[dict]) -> list[bool]:
    """Whether each interval of a parameter holds the true value."""
    return [low <= true <= high for row in rows for _, _, low, high, true in determined(row)]


def _print_noise(noise: str, rows: list[dict]) -> None:
    clean = [row for row in rows if row["kind"] == "none"]
    known = [row for row in rows if row["kind"] not in (*FOREIGN_KINDS, *BESIDE)]
    hidden = [row for row in known if row["kind"] != "none"]
    right, held = _count(hidden, is_right), _held(rows)
    sums = [sum(int(row[c] or 0) for row in hidden) for c in ("true", "named", "hidden_count")]
    print(
        f"| {noise.replace('_', ' ')} | {_count(clean, _is_false)} of {len(clean)} "
        f"| {right} of {len(hidden)} | {_limits(right, len(hidden))} "
        f"| {sums[0]} of {sums[1]} | {sums[0]} of {sums[2]} | {sum(held)} of {len(held)} |"
    )


def is_right(row: dict) -> bool:
    """Whether what is there is told, or a class of at most five that holds it, and no more."""
    if row["kind"] in BESIDE:  # what is told is there: the effect, and a cause that acts like one
        return row["named"] == row["true"] != "0"
    return row["outcome"] in ("right", "class")


def _is_false(row: dict) -> bool:
    return int(row["named"] or 0) > int(row["true"] or 0)


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
    counts = _count(rows, is_right), _count(rows, _is_false)
    limits = [_limits(hits, len(rows)) for hits in counts]
    larger = _count(rows, lambda row: row["outcome"] == "vague" and not is_right(row))
    print(
        f"| {name} | {len(rows)} | {counts[0]} | {limits[0]} | {larger} "
        f"| {counts[1]} | {limits[1]} |"
    )


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
    parser.add_argument("--rows", type=Path, required=True, action="append")
    parser.add_argument("--seed", type=int, default=960_000)
    parser.add_argument("--part", default="1/1", help="which of how many parts of the cases")
    parser.add_argument("--group", choices=GROUPS, help="only cases of this group, white noise")
    parser.add_argument("--cases", type=int, default=100, help="how many, with --group")
    parser.add_argument("--table", action="store_true", help="only print the table of the files")
    args = parser.parse_args()
    path, part, of = args.rows[0], *map(int, args.part.split("/"))
    done = {(row["kind"], row["noise"], int(row["seed"])) for row in read_rows(path)}
    group = args.group
    every = cases_of(group, args.cases, args.seed) if group else cases(args.seed)
    for kind, noise, seed in [] if args.table else every[part - 1 :: of]:
        if (kind, noise, seed) not in done:
            folder = path.with_suffix("")
            settings = Namespace(
                folder=folder, noise=noise, instruments=[], held_out=False, keep=False
            )
            row = one(kind, seed, settings)
            append_row(path, row)
            print(kind, noise, seed, row["outcome"], row["said"], flush=True)
    print_table([row for rows in args.rows for row in read_rows(rows)])


if __name__ == "__main__":
    main()
