"""Arguments and options that several commands have."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from vmach.base.variant import Variant

__all__ = ["AsJson", "Control", "JobPath", "Model", "OutDir", "OwnEffects",
           "command_line", "input_files"]  # fmt: skip


def _tell_control(name: str | None) -> str | None:
    from vmach.job.control import tell_control  # late: it loads what a job needs

    return tell_control(name)


JobPath = Annotated[Path, typer.Argument(metavar="JOB", help="job.toml, or the folder it is in")]
Control = Annotated[
    str | None,
    typer.Option("--control", help="control that the program is written for, in place of the job's",
                 callback=_tell_control),
]  # fmt: skip
AsJson = Annotated[bool, typer.Option("--json", help="print the figures as JSON")]
OutDir = Annotated[Path | None, typer.Option("--out", help="folder for the results")]
Model = Annotated[Variant, typer.Option(help="arms of the machine's angular errors")]
OwnEffects = Annotated[
    list[Path] | None,
    typer.Option("--effect-file", help="Python file with an effect of your own; repeatable"),
]


def command_line() -> str:
    """What was typed, as it can be typed again."""
    return shlex.join(["vmach", *sys.argv[1:]])


def input_files(job: Path) -> list[Path]:
    """The files of a job, which no result may replace."""
    from vmach.job import read_job

    return [path for _, path in read_job(job).files()]
