"""The numbers by which evidence and size of an effect become a probability that it is there.

    python tests/benchmarks/calibrate_verdicts.py --rows calibration.csv [--share 0.5]
    python tests/benchmarks/calibrate_verdicts.py --rows calibration.csv --fit

Experiments of known and foreign causes, and of both, are drawn with every kind of noise, on seeds
that nothing else uses. Every effect that is judged, beside the forms that were found, gives a row:
whether it is true, its log odds, its size, what remains and its share of both. `SHOWN` of
`vmach/diagnosis/inference/rules.py` is compared with how often effects of such odds are there.
`IMITATION` is fitted to those that leave something; the sizes of the discrepancy give its prior in
`vmach/fit/sizes.py`. Cases whose rows are in the file are not run again.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
import tempfile
from collections.abc import Iterator
from itertools import cycle, pairwise
from pathlib import Path

import numpy as np
from scipy.optimize import minimize
from threadpoolctl import threadpool_limits

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.benchmarks.bench_hidden_effects import effects_of
from tests.benchmarks.count_verdicts import BESIDE
from tests.hidden_effects.experiment import FOREIGN_KINDS, SINGLE_KINDS, make_experiment
from tests.hidden_effects.measuring import NOISES
from tests.hidden_effects.part import PartDesign
from tests.hidden_effects.verdict import is_answer
from vmach.diagnosis.gates.impossible_sizes import impossible_terms
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.rules import CLEARLY, IMITATION, SHOWN
from vmach.diagnosis.inference.support import Support, supports_of
from vmach.diagnosis.inference.verdicts import beside_forms, led
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.diagnosis.rivals import rivals_of
from vmach.fit.sizes import _POWER, USUAL_SIZE

COLUMNS = (
    "kind", "noise", "seed", "effect", "is_true", "odds", "size_um", "rest_um", "share", "members",
)  # fmt: skip
#: first seed, and kinds with how often each is drawn
FIRST_SEED = 14_000_000
DRAWN = {
    "none": 24, **dict.fromkeys(FOREIGN_KINDS, 3), **dict.fromkeys(SINGLE_KINDS, 1),
    **dict.fromkeys(BESIDE[:: len(BESIDE) // 120], 1),
    "double": 30, "triple": 14, "four": 8, "five": 8,
}  # fmt: skip


def cases() -> list[tuple[str, str, int]]:
    """Kind, noise and seed of every case, in an order of chance."""
    kinds = [kind for kind, count in DRAWN.items() for _ in range(count)]
    drawn = zip(kinds, cycle(NOISES), range(FIRST_SEED, FIRST_SEED + len(kinds)), strict=False)
    every = list(drawn)
    return [every[k] for k in np.random.default_rng(0).permutation(len(every))]


@threadpool_limits.wrap(limits=1, user_api="blas")
def rows_of(kind: str, noise: str, seed: int) -> Iterator[dict]:
    """A row of every effect that is judged and nature allows; the first names none."""
    case = {"kind": kind, "noise": noise, "seed": seed}
    design = PartDesign(corners=seed % 3 == 0, two_set_ups=seed % 5 == 0)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            effects = effects_of(kind, seed)
            make_experiment(folder, effects=effects, seed=seed, design=design, noise=noise)
        except ValueError:
            return
        truth = json.loads((folder / "truth.json").read_text())
        weighing = prepare_weighing(survey_job(folder / "job.toml"))
        weighing, found, forms, grown = led(weighing)
    yield case | {"members": json.dumps(found.posterior.sizes.members)}
    weighing, found, stay, _ = beside_forms(weighing, forms, found, grown)
    fit, count = weighing.careful(found), len(found.terms) - stay
    impossible = impossible_terms(fit) if fit else []
    for k, support in enumerate(supports_of(weighing, found, count)):
        if k in impossible:
            continue
        term, names = found.terms[k], rivals_of(weighing, found, k).names
        entry = {"effect": term.effect.name, "target": term.target, "class": names}
        yield case | {
            "effect": term.label,
            "is_true": int(is_answer(entry, truth)),
            "odds": round(support.odds, 3),
            "size_um": round(support.size_um, 4),
            "rest_um": round(support.rest_um, 4),
            "share": round(support.share, 6),
        }


def print_odds(rows: list[dict]) -> None:
    """Print how many of the effects of some log odds are there, and of those that pass all else."""
    rows = [row for row in rows if row["effect"]]
    supports = [_support(row) for row in rows]
    odds = np.array([support.odds for support in supports])
    is_true = np.array([row["is_true"] == "1" for row in rows])
    passes = np.array([support.probability >= 0.5 for support in supports])
    print("log odds: effects, of which there; effects that are no imitations, of which there")
    for low, high in pairwise((-np.inf, 0.0, 2.0, 3.0, SHOWN, CLEARLY, 7.0, 12.0, np.inf)):
        own = (odds >= low) & (odds < high)
        counts = (group.sum() for some in (own, own & passes) for group in (some, some & is_true))
        print(f"{low:5.2f} to {high:5.2f}:", *(f"{count:4d}" for count in counts))


def _support(row: dict) -> Support:
    return Support(*(float(row[c]) for c in ("odds", "size_um", "rest_um", "share")))


def print_fit(rows: list[dict]) -> None:
    """Print the most likely `IMITATION`, and what others would say of the rows."""
    rows = [row for row in rows if row["effect"] and float(row["odds"]) >= SHOWN]
    supports = [_support(row) for row in rows]
    is_true = np.array([row["is_true"] == "1" for row in rows])
    leaves = np.array([s.rest_um > 0.0 for s in supports])
    ratio = np.array([s.size_um * s.share / max(s.rest_um, 1e-9) for s in supports])
    print(f"{len(rows)} effects of clear evidence, {is_true.sum()} true; {leaves.sum()} leave rest")
    sign = np.where(is_true, 1.0, -1.0)[leaves]
    trials = np.exp(np.linspace(-2.0, 2.0, 81))
    cost = [np.logaddexp(0, -2 * sign * np.log(ratio[leaves] / t)).sum() for t in trials]
    print(f"IMITATION = {trials[int(np.argmin(cost))]:.2f}, in use {IMITATION}")
    print("shown from this many rests on: so many, of which so many false; true ones lost")
    alone = np.array([s.size_um / max(s.rest_um, 1e-9) for s in supports])
    rules = [("size", alone, 5.0), *(("size x share", ratio, k) for k in (0.5, 1.0, 1.5, 2.0, 3.0))]
    for name, own, least in rules:
        shown = own >= least
        false, lost = (shown & ~is_true).sum(), (~shown & is_true).sum()
        print(f"{name} {least:.1f}: {shown.sum():4d} {false:4d} {lost:4d}")


def print_prior(rows: list[dict]) -> None:
    """Print the prior of members' sizes that makes the sizes of all cases most probable."""
    found = [size for row in rows if row["members"] for size in json.loads(row["members"])]
    sizes, grid = np.maximum(found, 0.02), np.linspace(np.log(0.02), np.log(50.0), 2000)

    def density(logarithms: np.ndarray, usual: float, power: float) -> np.ndarray:
        return -power * np.log1p((np.exp(logarithms) / usual) ** 2)

    def cost(both: np.ndarray) -> float:
        whole = np.log(np.trapezoid(np.exp(density(grid, *np.exp(both))), grid))
        return float(len(sizes) * whole - density(np.log(sizes), *np.exp(both)).sum())

    here = np.log([USUAL_SIZE, _POWER])
    best = minimize(cost, here, method="Nelder-Mead", bounds=[(np.log(0.02), 3.0), (-3.0, 3.0)])
    print("USUAL_SIZE, _POWER = {:.2g}, {:.2g}".format(*np.exp(best.x)), end="")
    print(f", more probable than those in use by exp({cost(here) - best.fun:.0f})")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=Path, required=True)
    parser.add_argument("--share", type=float, default=1.0, help="of the cases, to be run")
    parser.add_argument("--fit", action="store_true", help="only fit the rows of the file")
    args = parser.parse_args()
    known: list[dict] = []
    if args.rows.exists():
        with args.rows.open(newline="") as file:
            known = list(csv.DictReader(file))
    done = {(row["kind"], row["noise"], int(row["seed"])) for row in known}
    every = cases()
    wanted = [] if args.fit else every[: round(args.share * len(every))]
    for case in wanted:
        if case in done:
            continue
        found = [dict.fromkeys(COLUMNS, "") | row for row in rows_of(*case)]
        with args.rows.open("a", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS)
            if not file.tell():
                writer.writeheader()
            writer.writerows(found)
        known += [{name: str(value) for name, value in row.items()} for row in found]
    print_odds(known)
    print_fit(known)
    print_prior(known)


if __name__ == "__main__":
    main()
