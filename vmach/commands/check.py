"""``vmach check``: all that a job lacks, at once."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vmach.commands.options import HERE, AsJson, Control, JobPath

if TYPE_CHECKING:
    from vmach.checkup.program_collisions import ProgramCollision

__all__ = ["check"]

_TITLES = {"mend": "to mend", "look": "doubtful", "assumed": "assumed"}


def check(
    job: JobPath = HERE,
    as_json: AsJson = False,
    control: Control = None,
    collisions: Annotated[
        bool,
        typer.Option("--collisions", help="look for rapid moves, shanks and holders in material"),
    ] = False,
) -> None:
    """Say everything that a job lacks, has wrong, leaves doubtful or does not say."""
    from vmach.checkup import Weight, check_job
    from vmach.schemas import CheckOutput

    found = check_job(job)
    counts = Counter(finding.weight for finding in found)
    hits = _collisions(job) if collisions and not counts[Weight.MEND] else None
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
        report = {
            "ready": not counts[Weight.MEND],
            "findings": records,
            "collisions": None if hits is None else [vars(hit) for hit in hits],
        }
        print(json.dumps(CheckOutput.model_validate(report).model_dump(), indent=1))
    else:
        for weight in Weight:
            if counts[weight]:
                print(f"{_TITLES[weight]}:")
                print(*(f"  {finding}" for finding in found if finding.weight is weight), sep="\n")
        if collisions and not counts[Weight.MEND]:
            _say_collisions(hits)
        total = ", ".join(f"{counts[weight]} {_TITLES[weight]}" for weight in Weight)
        print(
            f"{total}: "
            + ("mend these first" if counts[Weight.MEND] else "the job can be simulated")
        )
    if counts[Weight.MEND]:
        raise typer.Exit(1)


def _collisions(job: Path) -> tuple[ProgramCollision, ...] | None:
    from vmach.base.progress import progress_bar
    from vmach.checkup.program_collisions import check_collisions

    with progress_bar() as progress:
        return check_collisions(job, progress=progress)


def _say_collisions(hits: tuple[ProgramCollision, ...] | None) -> None:
    if hits is None:
        print("collisions: the job has no [stock] to collide with")
        return
    print(f"collisions: {len(hits) or 'none'}", *(f"  {hit}" for hit in hits), sep="\n")
