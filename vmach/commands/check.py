"""``vmach check``: all that a job lacks, at once."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Annotated

import typer

from vmach.commands.options import AsJson, Control

__all__ = ["check"]

_TITLES = {"mend": "to mend", "look": "doubtful", "assumed": "assumed"}


def check(
    job: Annotated[Path, typer.Argument(help="job file, or the folder that holds job.toml")],
    as_json: AsJson = False,
    control: Control = None,
) -> None:
    """Say everything that a job lacks, has wrong, leaves doubtful or does not say."""
    from vmach.checkup import Weight, check_job
    from vmach.schemas import CheckOutput

    found = check_job(job)
    counts = Counter(finding.weight for finding in found)
    if as_json:
        records = [
            {
                "weight": str(f.weight),
                "what": f.what,
                "file": "" if f.file is None else str(f.file),
                "line": f.line,
                "accepted": f.accepted,
                "hint": f.hint,
            }
            for f in found
        ]
        report = {"ready": not counts[Weight.MEND], "findings": records}
        print(json.dumps(CheckOutput.model_validate(report).model_dump(), indent=1))
    else:
        for weight in Weight:
            if counts[weight]:
                print(f"{_TITLES[weight]}:")
                print(*(f"  {finding}" for finding in found if finding.weight is weight), sep="\n")
        total = ", ".join(f"{counts[weight]} {_TITLES[weight]}" for weight in Weight)
        print(f"{total}: " + ("mend these first" if counts[Weight.MEND] else "the job can be run"))
    if counts[Weight.MEND]:
        raise typer.Exit(1)
