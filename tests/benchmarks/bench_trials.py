"""Diagnose a folder of experiments with known hidden effects and add what was found.

Usage: python tests/benchmarks/bench_trials.py FOLDER

Each sub-folder of FOLDER holds a job (``job.toml``), a second part of the same machine
(``check.nc``, ``check_measured.csv``) and ``truth.json`` with the hidden effects. Printed are
verdict, effects, RMS before and after, RMS on the second part before and after, and the time.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from vmach.diagnosis.diagnose import Diagnosis, diagnose
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.history import history_of
from vmach.history.added_effects import add_effects
from vmach.job import read_job


def main(folder: Path) -> None:
    """Print one line an experiment."""
    right = 0
    trials = sorted(path.parent for path in folder.glob("*/truth.json"))
    for trial in trials:
        truth = json.loads((trial / "truth.json").read_text(encoding="utf-8"))
        start = time.perf_counter()
        found = diagnose(survey_job(trial))
        seconds = time.perf_counter() - start
        good = _is_right(truth["accept"], found)
        right += good
        print(f"{trial.name}: {found.verdict}, {'right' if good else 'WRONG'}, {seconds:.1f} s")
        print(f"  hidden: {[(e['name'], e['parameters']) for e in truth['effects']]}")
        for f in found.findings:
            shown = {k: v for k, v in f.parameters.items() if not isinstance(v, list)}
            print(f"  found: {f.name} {f.target} {shown} class {f.rivals.names} {f.where or ''}")
        before, after = found.rms_um["before"], found.rms_um["after"]
        print(f"  RMS {before:.2f} -> {after:.2f} um", end="")
        print(f"; other part {' -> '.join(f'{v:.2f}' for v in _on_other_part(trial, found))} um")
    print(f"{right} of {len(trials)} right")


def _is_right(accept: list[list[str]], found: Diagnosis) -> bool:
    """Whether every cause is found, and whatever is found is a cause.

    An effect that acts on two tools at once is found twice.
    """
    if accept == [["none"]]:
        return found.verdict == "nothing"
    names = [{f.name, *f.rivals.names} for f in found.findings]
    if found.verdict == "partly":
        names.append({"unknown"})
    causes = [set(one) for one in accept]
    every = all(any(cause & name for name in names) for cause in causes)
    return every and all(any(cause & name for cause in causes) for name in names)


def _on_other_part(trial: Path, found) -> list[float]:
    labels = [f"{f.name}:{f.target}".rstrip(":") for f in found.findings if f.effect]
    with tempfile.TemporaryDirectory() as folder:
        job = trial / "job.toml"
        if labels:
            job, _ = add_effects(job, labels, out=Path(folder) / "added.toml")
        other = read_job(trial / "job.toml")
        check = replace(other, program=trial / "check.nc", measured=trial / "check_measured.csv")
        steps = history_of(job, check=check)
    return [s.check_rms_um for s in steps]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
