"""How often the diagnosis is right about parts, machines and laws of a second maker.

    python tests/benchmarks/count_other_parts.py --seed SEED [--count 10] [--rows counts.csv]

Each case is written by `tests/oracle/other_parts.py` and diagnosed through the command line:
`count` cases of each part with none to five effects, and one of each foreign cause and each kind of
noise. Causes that the readings hardly show, beyond alignment and other causes, are not asked for.
Printed is a table with limits of 95 % (Clopper and Pearson).
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.benchmarks.bench_hidden_effects import binomial, write_rows
from tests.hidden_effects import program_runs
from tests.oracle.other_parts import FOREIGN, KNOWN, NOISES, PARTS, Hidden, write_job
from vmach.effects import label_of

#: what the readings show of a cause at least, where it is asked for
LEAST_UM = 0.9


@dataclass(frozen=True)
class Case:
    """One job to make."""

    hidden: str  #: how many, or "foreign"
    part: str
    noise: str
    causes: tuple[Callable, ...]
    seed: int


def cases(first: int, count: int) -> Iterator[Case]:
    """All of them, each with a seed of its own."""
    seed = first
    for part in PARTS:
        for number in range(6):
            for _ in range(count):
                drawn = np.random.default_rng(seed).choice(len(KNOWN), number, replace=False)
                yield Case(str(number), part, "white", tuple(KNOWN[k] for k in drawn), seed)
                seed += 1
        for noise in NOISES[1:]:
            for number in (0, 1, 2, 3):
                drawn = np.random.default_rng(seed).choice(len(KNOWN), number, replace=False)
                yield Case(str(number), part, noise, tuple(KNOWN[k] for k in drawn), seed)
                seed += 1
        for cause in FOREIGN:
            for noise in NOISES[:4]:
                yield Case("foreign", part, noise, (cause,), seed)
                seed += 1


def judged(case: Case, folder: Path) -> dict[str, object]:
    """A row: what of the truth was said, what was said besides."""
    hidden = write_job(folder, case.seed, case.part, case.causes, case.noise)
    report, seconds = program_runs.diagnose(folder)
    said = [entry for entry in report["effects"] if entry["effect"] != "unknown"]
    classes = [{_label(entry), *entry["rivals"], *entry["class"]} for entry in said]
    known = [h for h in hidden if case.hidden != "foreign"]
    there = [h for h in known if h.seen_um >= LEAST_UM]
    found = [any(_is_in(h, one) for one in classes) for h in there]
    false = [
        _label(entry)
        for entry, one in zip(said, classes, strict=True)
        if not any(_is_in(h, one) for h in known)
    ]
    inside, counted = _intervals(known, said)
    return {
        "hidden": case.hidden, "part": case.part, "noise": case.noise, "seed": case.seed,
        "causes": " ".join(c.__name__ for c in case.causes), "verdict": report["verdict"],
        "said": len(said), "false": " ".join(false), "there": len(there), "found": sum(found),
        "missed": " ".join(h.label for h, f in zip(there, found, strict=True) if not f),
        "weak": " ".join(_label(w) for w in report["weak_effects"]),
        "form": report["proposals"][0]["formula"] if report["proposals"] else "",
        "inside": inside, "intervals": counted, "seconds": round(seconds, 2),
    }  # fmt: skip


def _is_in(hidden: Hidden, labels: set[str]) -> bool:
    """Whether a class holds a cause: at its target, or by its name where that alone is told."""
    return bool({hidden.label, hidden.label.split()[0]} & labels)


def _intervals(hidden: list[Hidden], said: list[dict]) -> tuple[int, int]:
    """Of parameters of effects that are named alone: intervals that hold the truth, and all."""
    inside = counted = 0
    for one in hidden:
        for entry in said:
            if _label(entry) == one.label and entry["status"] == "shown":
                for name, true in one.numbers.items():
                    if name in entry["interval_95"]:
                        low, high = entry["interval_95"][name]
                        counted += 1
                        inside += int(low <= true <= high)
    return inside, counted


def _label(entry: dict) -> str:
    return label_of(entry["effect"], entry["target"] or "")


def print_table(rows: list[dict]) -> None:
    print("| hidden | part | noise | cases | all right or in the class | a false name |")
    print("|---|---|---|---|---|---|")
    keys = dict.fromkeys((r["hidden"], r["part"], r["noise"] == "white") for r in rows)
    for hidden, part, is_white in keys:
        own = [
            r for r in rows
            if (r["hidden"], r["part"], r["noise"] == "white") == (hidden, part, is_white)
        ]  # fmt: skip
        right = sum(r["found"] == r["there"] and not r["false"] for r in own)
        false = sum(bool(r["false"]) for r in own)
        noise = "white" if is_white else "other"
        print(f"| {hidden} | {part} | {noise} | {len(own)} | {right} | {false} |")
    known = [r for r in rows if r["hidden"] != "foreign"]
    for words, of, all_of in (
        ("effects said that are there", sum(r["found"] for r in known),
         sum(r["found"] + len(r["false"].split()) for r in known)),
        ("effects there that are said", sum(r["found"] for r in known),
         sum(r["there"] for r in known)),
        ("95 % intervals that hold the truth", sum(r["inside"] for r in known),
         sum(r["intervals"] for r in known)),
    ):  # fmt: skip
        low, high = binomial(of, all_of)
        print(f"{words}: {of} of {all_of}, {100 * low:.0f} to {100 * high:.0f} %")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--rows", type=Path)
    parser.add_argument("--part", default="1/1", help="of the cases, as 2/3")
    options = parser.parse_args()
    own, of = map(int, options.part.split("/"))
    rows: list[dict] = []
    for case in list(cases(options.seed, options.count))[own - 1 :: of]:
        with tempfile.TemporaryDirectory() as folder:
            rows.append(judged(case, Path(folder)))
        print(rows[-1], file=sys.stderr, flush=True)
        if options.rows:
            write_rows(options.rows, rows)
    print_table(rows)


if __name__ == "__main__":
    main()
