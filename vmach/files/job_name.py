"""What jobs are called, by their files alone."""

from __future__ import annotations

import os
import re
from pathlib import Path

__all__ = ["free_job_name", "job_name"]


def job_name(path: Path) -> str:
    """What a job is called: its file's name, or its folder's where the file is ``job.toml``."""
    path = Path(os.path.realpath(path))  # a loop of links is told when the file is read
    return path.parent.name if path.name == "job.toml" else path.stem


def free_job_name(path: Path) -> Path:
    """A name for a job that goes on from another, beside it: ``job-2.toml``, ``job-3.toml`` ...

    It is free now. Another command may take it before it is written: see `NameTakenError`.
    """
    number = 2
    stem = re.sub(r"-\d+$", "", path.stem)
    while os.path.lexists(candidate := path.with_name(f"{stem}-{number}.toml")):
        number += 1
    return candidate
