"""What it costs that the correlation of noise is estimated: the same parts with the true one.

    python tests/benchmarks/count_known_noise.py --seed SEED [--part 1/2]

Parts with one to five effects, whose noise goes from point to point along a feature, are diagnosed
twice: as `vmach diagnose` does, and with the noise that the generator drew from in the place of any
estimate. Where both are right equally often, more cannot be had by a better estimate.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.benchmarks.bench_hidden_effects import effects_of
from tests.benchmarks.count_verdicts import BESIDE, cases
from tests.hidden_effects import program_runs
from tests.hidden_effects.experiment import FOREIGN_KINDS, make_experiment
from tests.hidden_effects.measuring import FROM_POINT_TO_POINT
from tests.hidden_effects.part import PartDesign
from tests.hidden_effects.verdict import judge
from vmach.diagnosis import diagnose
from vmach.diagnosis.inference import verdicts
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.weighing import Weighing
from vmach.fit.survey import Survey

NOISE = "correlated"
#: of the variance that is correlated: the most that the estimate may take; the generator has all
_SHARE = 0.98


def with_true_noise(survey: Survey) -> Weighing:
    """A weighing beside the noise that the generator drew from."""
    weighing = prepare_weighing(survey)
    true = replace(weighing.base.noise, share=_SHARE, correlation=FROM_POINT_TO_POINT)
    return weighing.with_noise(true)


def is_right(folder: Path, *, known: bool) -> bool:
    """Whether a diagnosis names what is hidden, or a class of it."""
    with ExitStack() as stack:
        if known:
            for place, name, new in (
                (diagnose, "prepare_weighing", with_true_noise),
                (verdicts, "beside_own_noise", lambda weighing, found: (weighing, found)),
                (verdicts, "noise_before", lambda weighing: weighing.base.noise),
            ):
                stack.enter_context(mock.patch.object(place, name, new))
        report, _ = program_runs.diagnose(folder)
    truth = json.loads((folder / "truth.json").read_text())
    return judge(report, truth).outcome in ("right", "class")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--part", default="1/1", help="which of how many parts of the cases")
    args = parser.parse_args()
    part, of = map(int, args.part.split("/"))
    others = ("none", *FOREIGN_KINDS, *BESIDE)
    every = [(k, seed) for k, noise, seed in cases(args.seed) if noise == NOISE and k not in others]
    count, right = 0, {False: 0, True: 0}
    for kind, seed in every[part - 1 :: of]:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name) / "job"
            design = PartDesign(corners=seed % 3 == 0, two_set_ups=seed % 5 == 0)
            effects = effects_of(kind, seed)
            try:
                make_experiment(folder, effects=effects, seed=seed, design=design, noise=NOISE)
            except ValueError:  # it cannot be drawn
                continue
            count += 1
            for known in right:
                right[known] += is_right(folder, known=known)
        print(kind, seed, f"right of {count}: {right[False]}, with known noise {right[True]}")


if __name__ == "__main__":
    main()
