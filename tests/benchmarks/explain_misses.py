"""Why answers of a count are not right: the search, the verdict, or the readings.

    python tests/benchmarks/explain_misses.py --rows counts.csv [--part 1/2]

Every machine with one to five known effects whose answer was not right, nor in a class, is made
again. The true effects are fitted to its readings beside the same noise, in the best order and from
what was found, and weighed against it. Where the truth is clearly more probable, the search missed
it. Where it is what was found, the verdict withheld some of it. Else the readings themselves speak
as much for something else: more or better readings would have to tell.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.benchmarks.bench_hidden_effects import effects_of, read_rows
from tests.benchmarks.count_verdicts import BESIDE, GROUPS
from tests.hidden_effects.experiment import FOREIGN_KINDS, make_experiment
from tests.hidden_effects.part import PartDesign
from tests.hidden_effects.verdict import is_answer
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.inference.verdicts import led
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.residuals.job_survey import survey_job

SEARCH, VERDICT, READINGS = "the search", "the verdict", "the readings"


def why(kind: str, noise: str, seed: int, folder: Path) -> tuple[str, float, str]:
    """What the answer of one machine is not right for, log odds of the truth, and both sets."""
    design = PartDesign(corners=seed % 3 == 0, two_set_ups=seed % 5 == 0)
    make_experiment(folder, effects=effects_of(kind, seed), seed=seed, design=design, noise=noise)
    hidden = json.loads((folder / "truth.json").read_text())["effects"]
    weighing, found, *_ = led(prepare_weighing(survey_job(folder / "job.toml")))
    true = true_explanation(weighing, found, hidden)
    odds = true.score - found.score
    sets = f"{', '.join(sorted(true.labels))} | {', '.join(sorted(found.labels))}"
    if odds > CLEARLY:
        return SEARCH, odds, sets
    return VERDICT if true.labels == found.labels else READINGS, odds, sets


def true_explanation(weighing: Weighing, found: Explanation, hidden: Sequence[dict]) -> Explanation:
    """The most probable explanation by what is hidden, of a few ways to it."""
    ways = [_added(weighing, start, hidden) for start in (weighing.nothing(), weighing.small())]
    best = max(ways, key=lambda e: e.score)
    # from what was found: what is missing, and without what is not there
    here = found
    for label in sorted(best.labels - found.labels):
        here = weighing.extend(here, weighing.index_of(label))
    kept = [term for term in here.terms if term.label in best.labels]
    return max(best, weighing.explain(kept, here.posterior.sizes), key=lambda e: e.score)


def _added(weighing: Weighing, here: Explanation, hidden: Sequence[dict]) -> Explanation:
    """Hidden effects added to an explanation, the most probable next."""
    left = [_labels(weighing, effect) for effect in hidden]
    while any(labels - here.labels for labels in left):
        steps = [
            (weighing.extend(here, weighing.index_of(label)), k)
            for k, labels in enumerate(left)
            for label in sorted(labels - here.labels)
        ]
        here, k = max(steps, key=lambda step: step[0].score)
        left[k] = set()
    return here


def _labels(weighing: Weighing, effect: dict) -> set[str]:
    """Candidates that are a hidden effect, those of its own name where there are any."""
    labels = {
        c.label for c in weighing.candidates if is_answer(_entry(c.label), {"effects": [effect]})
    }
    own = {label for label in labels if label.split()[0] == effect["name"]}
    return own or labels


def _entry(label: str) -> dict:
    name, _, target = label.partition(" ")
    return {"effect": name, "target": target or None, "class": [name]}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=Path, action="append", required=True)
    parser.add_argument("--part", default="1/1", help="of so many processes, which")
    args = parser.parse_args()
    part, parts = map(int, args.part.split("/"))
    unknown = (*FOREIGN_KINDS, *BESIDE, "none")
    rows = [row for file in args.rows for row in read_rows(file) if row["kind"] not in unknown]
    told = ("right", "class", "vague", "undrawn")  # larger classes are counted elsewhere
    missed = [row for row in rows if row["outcome"] not in told]
    group_of = {kind: group for group, (kinds, *_) in GROUPS.items() for kind in kinds}
    counts: Counter[tuple[str, str]] = Counter()
    for row in missed[part - 1 :: parts]:
        with tempfile.TemporaryDirectory() as folder:
            reason, odds, sets = why(row["kind"], row["noise"], int(row["seed"]), Path(folder))
        counts[group_of[row["kind"]], reason] += 1
        print(
            f"{row['kind']} {row['noise']} {row['seed']}: {reason}, {odds:+.1f}: {sets}", flush=True
        )
    print(f"\n| hidden | {SEARCH} | {VERDICT} | {READINGS} |\n|---|---|---|---|")
    for group in dict.fromkeys(group for group, _ in counts):
        print(
            f"| {group} | "
            + " | ".join(str(counts[group, r]) for r in (SEARCH, VERDICT, READINGS))
            + " |"
        )


if __name__ == "__main__":
    main()
