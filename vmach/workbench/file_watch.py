"""Files that change outside the workbench."""

from __future__ import annotations

import time
from collections.abc import Iterable
from pathlib import Path

__all__ = ["FileWatch"]

#: of a file: when it was changed, and its size; None where it is not there
Stamp = tuple[int, int] | None


class FileWatch:
    """Notices files whose time or size has changed, as soon as they rest from one look to the next.

    So a file that is just being written is not taken for what it will be.
    """

    def __init__(self) -> None:
        self._seen: dict[Path, Stamp] = {}
        self._moving: dict[Path, Stamp] = {}

    def watch(self, files: Iterable[Path], *, since_ns: int) -> None:
        """Watch these from now on, and no others.

        Parameters
        ----------
        files : iterable of Path
        since_ns : int
            When they were about to be read (`time.time_ns`): one that was changed since counts as
            changed, for what was read may be older.
        """
        now_ns, watched = time.time_ns(), {}
        for path in files:
            stamp = _stamp(path)
            is_newer = stamp is not None and since_ns < stamp[0] <= now_ns
            watched[path] = None if is_newer else stamp
        self._seen, self._moving = watched, {}

    @property
    def watched(self) -> list[Path]:
        """All that are watched, there or not."""
        return list(self._seen)

    @property
    def files(self) -> list[Path]:
        """Those that are watched and there."""
        return [path for path, stamp in self._seen.items() if stamp is not None]

    def changed(self) -> list[Path]:
        """Those that have changed and rest since the last look; they count as seen."""
        now = {path: _stamp(path) for path in self._seen}
        moving = {path: stamp for path, stamp in now.items() if stamp != self._seen[path]}
        found = [path for path, stamp in moving.items() if self._moving.get(path, 0) == stamp]
        self._seen.update((path, moving.pop(path)) for path in found)
        self._moving = moving
        return found


def _stamp(path: Path) -> Stamp:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size
