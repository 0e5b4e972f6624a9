"""Arguments and options that several commands have."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vmach.base.uncertainty_method import UncertaintyMethod
from vmach.base.variant import Variant

if TYPE_CHECKING:
    from vmach.job import Job
    from vmach.uncertainty.monte_carlo import Plan

__all__ = [
    "HERE",
    "AsJson",
    "Control",
    "Digits",
    "Draws",
    "JobPath",
    "Model",
    "OutDir",
    "OwnEffects",
    "Seed",
    "Uncertainty",
    "command_line",
    "draw_plan",
    "input_files",
    "tell_doubts",
    "typed",
]  # fmt: skip


def _tell_control(name: str | None) -> str | None:
    if name is None and "vmach.job.control" not in sys.modules:
        return None  # nothing was told before: what a job needs is not loaded for this
    from vmach.job.control import tell_control

    return tell_control(name)


JobPath = Annotated[Path, typer.Argument(metavar="JOB", help="job.toml, or the folder it is in")]
#: the job of the folder that a command is typed in
HERE = Path()
Control = Annotated[
    str | None,
    typer.Option("--control", help="control that the program is written for, in place of the job's",
                 callback=_tell_control),
]  # fmt: skip
AsJson = Annotated[bool, typer.Option("--json", help="print the figures as JSON")]
OutDir = Annotated[Path | None, typer.Option("--out", help="folder for the results")]
Model = Annotated[Variant, typer.Option(help="arms of the machine's angular errors")]
Uncertainty = Annotated[
    UncertaintyMethod, typer.Option(help="first order, or draws of all corrections (JCGM 101)")
]
Digits = Annotated[
    int, typer.Option(min=1, max=3, help="monte-carlo: significant digits of u that are to stand")
]
Draws = Annotated[int, typer.Option(min=20_000, help="monte-carlo: draws at most")]
Seed = Annotated[int, typer.Option(min=0, help="monte-carlo: another seed, other draws")]
OwnEffects = Annotated[
    list[Path] | None,
    typer.Option(
        "--effect-file", metavar="FILE", help="Python file with an effect of your own; repeatable"
    ),
]


def draw_plan(method: UncertaintyMethod, digits: int, draws: int, seed: int) -> Plan | None:
    """How to draw; None for first order."""
    if method is UncertaintyMethod.FIRST_ORDER:
        return None
    from vmach.uncertainty.monte_carlo import Plan

    return Plan(digits=digits, most_draws=draws, seed=seed)


def command_line() -> str:
    """What was typed, as it can be typed again."""
    return shlex.join(["vmach", *sys.argv[1:]])


def typed(path: Path) -> str:
    """A path as it can be typed."""
    return shlex.quote(str(path))


def input_files(job: Job) -> list[Path]:
    """The files of a job, which no result may replace."""
    return [path for _, path in job.files()]


def tell_doubts(job: Job) -> None:
    """Say on standard error what is doubtful in machine and tools, before long work begins.

    One line: the results tell every doubt in full.
    """
    from vmach.path.preparation import job_doubts  # late: it loads the engine

    found = job_doubts(job)
    if found:
        count = "a doubt" if len(found) == 1 else f"{len(found)} doubts, the first"
        print(f"before the work begins, {count}: {found[0]}", file=sys.stderr, flush=True)
