"""Jobs that were opened before, in the user's own state folder."""

from __future__ import annotations

import contextlib
import json
import os
from pathlib import Path

__all__ = ["recent_jobs", "remember_job"]

_MOST = 12


def recent_jobs() -> list[Path]:
    """The last first; those that are gone are left out."""
    try:
        names = json.loads(_file().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return []
    paths = [Path(name) for name in names if isinstance(name, str)]
    return [path for path in paths if path.is_file()][:_MOST]


def remember_job(job: Path) -> None:
    """Put a job first; where nothing can be written, nothing is remembered."""
    job = job.resolve()
    names = [str(job), *(str(path) for path in recent_jobs() if path != job)][:_MOST]
    with contextlib.suppress(OSError):
        _file().parent.mkdir(parents=True, exist_ok=True)
        _file().write_text(json.dumps(names, indent=1), encoding="utf-8")


def _file() -> Path:
    home = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(home) / "vmach" / "recent-jobs.json"
