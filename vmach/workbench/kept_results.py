"""What was found about the jobs of a folder, in a file beside their results.

A workbench that is started anew shows it again, as long as no file that it depends on has changed.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

__all__ = ["KeptResults", "content_of"]

#: in the folder of the results
_FILE = "workbench.json"
#: files that a verdict names: it is nothing without them
_NAMED = ("page", "program")


class KeptResults:
    """The verdicts, compensations and machined parts of a folder's jobs.

    Parameters
    ----------
    root : Path
        The folder.
    results : Path
        Where its results lie.
    """

    def __init__(self, root: Path, results: Path) -> None:
        self._root, self._file = root, results / _FILE

    def read(self, job: str) -> dict[str, Any]:
        """What was found about a job, by its kind; of the chain of all jobs under an empty name."""
        kept = self._all().get(job)
        if not isinstance(kept, dict):
            return {}
        return {kind: one["found"] for kind, one in kept.items() if self._holds(one)}

    def keep(
        self, job: str, kind: str, found: dict[str, Any] | None, files: Iterable[Path]
    ) -> None:
        """Keep what was found from these files; None to forget it.

        Where nothing can be written, nothing is kept.
        """
        everything = self._all()
        of_job = everything.setdefault(job, {})
        of_job.pop(kind, None)
        with contextlib.suppress(OSError):
            if found is not None:
                stamps = {str(path): content_of(path) for path in files}
                of_job[kind] = {"found": found, "files": stamps}
            self._file.parent.mkdir(exist_ok=True)
            fresh = self._file.with_suffix(f".{os.getpid()}")
            fresh.write_text(json.dumps(everything), encoding="utf-8")
            os.replace(fresh, self._file)

    def _all(self) -> dict[str, Any]:
        try:
            found = json.loads(self._file.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return found if isinstance(found, dict) else {}

    def _holds(self, one: Any) -> bool:
        try:
            named = [one["found"][key] for key in _NAMED if one["found"].get(key)]
            is_there = all((self._root / name).is_file() for name in named)
            return is_there and all(content_of(Path(p)) == s for p, s in one["files"].items())
        except (OSError, KeyError, TypeError, AttributeError):
            return False


def content_of(path: Path) -> str:
    """A word for what a file holds, the same as long as that is the same."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
