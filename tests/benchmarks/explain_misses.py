"""Why answers of a count are not right: the search, the verdict, the forms, or the readings.

    python tests/benchmarks/explain_misses.py --rows counts.csv [--part 1/2]

Every machine with one to five known effects whose answer was not right, nor in a class, is made
again. The true effects are fitted to its readings beside the same noise, in the best order and from
what was found, and weighed against it. Where the truth is clearly more probable, the search missed
it. Where it is what was found, the verdict withheld some of it. Else the readings themselves speak
as much for something else: more or better readings would have to tell.

Of something unknown, all that it truly does is taken off the readings, and the effects beside it
are fitted to the rest: more than any form or effect could know. It counts as probable beforehand as
an effect of the catalogue. Where the truth is clearly more probable than what was found, the forms
missed it.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.benchmarks.bench_hidden_effects import effects_of, read_rows
from tests.benchmarks.count_verdicts import GROUPS, is_right
from tests.hidden_effects.experiment import FOREIGN_KINDS, Experiment, make_experiment
from tests.hidden_effects.part import PartDesign
from tests.hidden_effects.verdict import is_answer
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.inference.verdicts import led
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.residuals.job_survey import survey_job

SEARCH, VERDICT, FORMS = "the search", "the verdict", "the forms"
READINGS = "the readings"
REASONS = (SEARCH, VERDICT, FORMS, READINGS)


def why(kind: str, noise: str, seed: int, folder: Path) -> tuple[str, float, str]:
    """What the answer of one machine is not right for, log odds of the truth, and both sets."""
    design = PartDesign(corners=seed % 3 == 0, two_set_ups=seed % 5 == 0)
    effects = effects_of(kind, seed)
    made = make_experiment(folder, effects=effects, seed=seed, design=design, noise=noise)
    hidden = json.loads((folder / "truth.json").read_text())["effects"]
    weighing, found, *_ = led(prepare_weighing(survey_job(folder / "job.toml")))
    if set(effects) & set(FOREIGN_KINDS):
        odds, labels = beside_foreign(weighing, found, hidden[:-1], made)
        sets = f"{', '.join(sorted(labels))} | {', '.join(sorted(found.labels))}"
        return FORMS if odds > CLEARLY else READINGS, odds, sets
    true = true_explanation(weighing, found, hidden)
    odds = true.score - found.score
    sets = f"{', '.join(sorted(true.labels))} | {', '.join(sorted(found.labels))}"
    if odds > CLEARLY:
        return SEARCH, odds, sets
    return VERDICT if true.labels == found.labels else READINGS, odds, sets


def beside_foreign(
    weighing: Weighing, found: Explanation, known: Sequence[dict], made: Experiment
) -> tuple[float, frozenset[str]]:
    """Log odds of known effects, where a foreign one is taken off, beside what was found."""
    take_off(made.folder / "part_measured.csv", 1e-3 * made.share_um[-1])
    clean = prepare_weighing(survey_job(made.folder / "job.toml"), weighing.effects)
    clean = clean.with_noise(weighing.base.noise)
    true = true_explanation(clean, clean.nothing(), known)
    like_one = -np.log(len(weighing.candidates))
    return true.score + like_one - found.score, true.labels


def take_off(file: Path, share_mm: np.ndarray) -> None:
    """Measured points without what one cause does to them, along their normals."""
    head, *lines = file.read_text().splitlines()
    rows = [line.split(",") for line in lines]
    for row, share in zip(rows, share_mm, strict=True):
        normal, measured = np.array(row[5:8], float), np.array(row[8:11], float)
        row[8:11] = [f"{v:.6f}" for v in measured - share * normal]
    file.write_text("\n".join([head, *map(",".join, rows)]) + "\n")


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
    rows = [row for file in args.rows for row in read_rows(file) if row["kind"] != "none"]
    elsewhere = ("vague", "undrawn")  # larger classes are counted by the table
    missed = [row for row in rows if row["outcome"] not in elsewhere and not is_right(row)]
    group_of = {kind: group for group, (kinds, *_) in GROUPS.items() for kind in kinds}
    counts: Counter[tuple[str, str]] = Counter()
    for row in missed[part - 1 :: parts]:
        with tempfile.TemporaryDirectory() as folder:
            reason, odds, sets = why(row["kind"], row["noise"], int(row["seed"]), Path(folder))
        counts[group_of[row["kind"]], reason] += 1
        print(
            f"{row['kind']} {row['noise']} {row['seed']}: {reason}, {odds:+.1f}: {sets}", flush=True
        )
    print(f"\n| hidden | {' | '.join(REASONS)} |\n|---|---|---|---|---|")
    for group in dict.fromkeys(group for group, _ in counts):
        print(f"| {group} | " + " | ".join(str(counts[group, r]) for r in REASONS) + " |")


if __name__ == "__main__":
    main()
