"""The folder that was opened: no file outside it is read or written for the page."""

from __future__ import annotations

import itertools
import os
from dataclasses import dataclass
from pathlib import Path

from vmach.errors import InputError
from vmach.files.atomic import atomic_file, check_outputs, write_under_free_name

__all__ = ["MOST_UPLOADED", "OpenedFolder"]

#: bytes of a file that the page may send; a scan of a part by a CMM has about ten million
MOST_UPLOADED = 64_000_000
#: endings of what a job is made of
_ENDINGS = {".toml", ".csv", ".nc", ".ngc", ".tap", ".mpf", ".h", ".txt", ".step", ".stp", ".stl",
            ".py", ".md"}  # fmt: skip
#: jobs that are listed, and how deep they are looked for
_MOST_JOBS, _DEPTH = 200, 2
_MOST_FILES = 500
_NAME_LENGTH = 120


@dataclass(frozen=True)
class OpenedFolder:
    """A folder and what may be done in it.

    Attributes
    ----------
    root : Path
        Resolved.
    """

    root: Path

    def inside(self, name: str) -> Path:
        """The path of a name in the folder.

        Raises
        ------
        InputError
            It leads out of the folder, also by a link.
        """
        if not name or "\0" in name or len(name) > 4 * _NAME_LENGTH or "\\" in name:
            raise InputError(f"{name[:80]!r} is no name of a file in {self.root}")
        try:
            path = (self.root / name).resolve()
        except (OSError, RuntimeError):
            raise InputError(f"{name!r} cannot be followed") from None
        if not path.is_relative_to(self.root):
            raise InputError(f"{name!r} leads out of the folder {self.root}")
        return path

    def existing(self, name: str) -> Path:
        """The same of a file that is there.

        Raises
        ------
        InputError
        """
        path = self.inside(name)
        if not path.is_file():
            raise InputError("no such file", file=name)
        return path

    def name_of(self, path: Path) -> str:
        """The name of a file as the page says it; of one outside, its whole path."""
        path = path.resolve()
        return str(path.relative_to(self.root)) if path.is_relative_to(self.root) else str(path)

    def jobs(self) -> list[Path]:
        """The job files in the folder and just below it."""
        found: list[Path] = []
        for depth in range(_DEPTH + 1):
            for path in sorted(self.root.glob("*/" * depth + "*.toml")):
                if len(found) < _MOST_JOBS and _is_job(path):
                    found.append(path)
        return found

    def files(self) -> list[str]:
        """Names of the files in the folder that a job may be made of."""
        found = [p for p in self.root.iterdir() if p.suffix.lower() in _ENDINGS and p.is_file()]
        return sorted(path.name for path in found)[:_MOST_FILES]

    def free_name(self, name: str) -> str:
        """A name that no file has: ``EXX.csv``, ``EXX-2.csv`` ..."""
        stem, _, suffix = name.rpartition(".")
        candidates = itertools.chain([name], (f"{stem}-{k}.{suffix}" for k in itertools.count(2)))
        return next(one for one in candidates if not os.path.lexists(self.root / one))

    def check_new(self, name: str) -> Path:
        """Where a file that the page sends may lie: a plain name that no other file has.

        Raises
        ------
        InputError
            Another ending, a folder in the name, or a file that vmach did not write is there.
        """
        path = self.inside(name)
        if path.parent != self.root or path.name.startswith(".") or len(name) > _NAME_LENGTH:
            raise InputError(f"{name!r}", accepted="the name of a file, without a folder")
        if path.suffix.lower() not in _ENDINGS:
            raise InputError(f"{name!r}", accepted=", ".join(sorted(_ENDINGS)))
        check_outputs([path])
        return path

    def write(self, name: str, content: bytes) -> Path:
        """Write a file that the page sent, whole or not at all.

        Raises
        ------
        InputError
        """
        path = self.check_new(name)
        with atomic_file(path) as temporary:
            temporary.write_bytes(content)
        return path

    def write_new(self, name: str, content: bytes) -> Path:
        """Write a file under `free_name`, which no other command has then.

        Raises
        ------
        InputError
        """
        return write_under_free_name(lambda: self.check_new(self.free_name(name)), content)


def _is_job(path: Path) -> bool:
    """Whether a TOML file names a machine and a program."""
    try:
        text = path.read_text(encoding="utf-8", errors="replace")[:4000]
    except OSError:
        return False
    keys = {line.split("=")[0].strip() for line in text.splitlines() if "=" in line}
    return {"machine", "program"} <= keys
