"""Files that change outside the workbench."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

__all__ = ["FileWatch"]

#: of a file: when it was changed, and its size; None where it is not there
Stamp = tuple[int, int] | None


class FileWatch:
    """Notices files whose time or size has changed since it was last asked."""

    def __init__(self) -> None:
        self._stamps: dict[Path, Stamp] = {}

    def watch(self, files: Iterable[Path]) -> None:
        """Watch these from now on, and no others."""
        self._stamps = {path: _stamp(path) for path in files}

    def changed(self) -> list[Path]:
        """Those that have changed since; they count as seen."""
        now = {path: _stamp(path) for path in self._stamps}
        found = [path for path, stamp in now.items() if stamp != self._stamps[path]]
        self._stamps = now
        return found


def _stamp(path: Path) -> Stamp:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size
