"""Which files vmach wrote: a list of their SHA-256 beside them, as ``sha256sum --check`` reads it.

A folder of results holds ``.vmach-results.sha256``. A single result, as of ``-o FILE``, is noted in
``.vmach-files.sha256`` of its folder. A file that is in no list, or was changed since, is the
user's: nothing replaces it.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

__all__ = [
    "FILES_LIST",
    "RESULTS_LIST",
    "files_in",
    "is_written",
    "note_file",
    "write_results_list",
]

RESULTS_LIST = ".vmach-results.sha256"
FILES_LIST = ".vmach-files.sha256"

#: name of a file, relative to the list's folder, and what its SHA-256 may be
_Sums = dict[str, set[str]]


def files_in(folder: Path) -> Iterator[Path]:
    """Every file below a folder but vmach's lists; a link is a file, wherever it leads."""
    for place, folders, names in os.walk(folder):
        links = [name for name in folders if os.path.islink(os.path.join(place, name))]
        for name in (*names, *links):
            if name not in (RESULTS_LIST, FILES_LIST):
                yield Path(place, name)


def is_written(path: Path, *, results: Path | None = None) -> bool:
    """Whether a file is, to the bit, what vmach wrote.

    Parameters
    ----------
    path : Path
    results : Path, optional
        Folder of results that the file lies in, at whatever depth.
    """
    while not path.is_dir() and _noted(path, results):
        try:
            before = _identity(path)
            digest = _sum(path)
            # asked after it was read: another run notes its own before it puts it there
            if digest in _noted(path, results):
                return True
            if _identity(path) == before:
                return False
        except FileNotFoundError:  # another run is about to put its own there
            return True
    return False


def _identity(path: Path) -> tuple[int, int, int]:
    """Differs after another file took this place, and after this one was changed."""
    of = path.stat()
    return of.st_ino, of.st_ctime_ns, of.st_size


def _noted(path: Path, results: Path | None) -> set[str]:
    """What the SHA-256 of a file may be."""
    lists = [(path.parent, RESULTS_LIST), (path.parent, FILES_LIST)]
    if results is not None:
        lists.append((results, RESULTS_LIST))
    return set().union(
        *(_read(folder / name).get(_name(path, folder), set()) for folder, name in lists)
    )


def note_file(path: Path, content: Path, *, coming: Collection[Path] = ()) -> None:
    """Note, before `content` is renamed to `path` out of its workplace, that both are vmach's.

    What `path` was noted with before stays noted: a kill between the two leaves a file that is
    known either way. Notes of files that are gone are dropped, unless they are `coming`.
    """
    listed = path.parent / FILES_LIST
    sums = _read(listed)
    before = {_sum(path)} & sums.get(path.name, set()) if path.is_file() else set()
    sums[path.name] = {_sum(content), *before}
    there = {
        name: of
        for name, of in sums.items()
        if name == path.name or (path.parent / name) in coming or (path.parent / name).exists()
    }
    _write(listed, there, room=content.parent)


def write_results_list(folder: Path, written: Iterable[Path], *, earlier: Path | None) -> None:
    """Mark a folder of results and list its files.

    Parameters
    ----------
    folder : Path
        With all its files, also those of earlier runs and of the user.
    written : iterable of Path
        Files below `folder` that are new.
    earlier : Path or None
        The folder of results that this one takes the place of.
    """
    kept = _read(earlier / RESULTS_LIST) if earlier is not None else {}
    sums = {name: of for name, of in kept.items() if (folder / name).exists()}
    sums |= {_name(path, folder): {_sum(path)} for path in written}
    _write(folder / RESULTS_LIST, sums, room=folder)


def _name(path: Path, folder: Path) -> str:
    return path.relative_to(folder).as_posix()


def _sum(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _read(listed: Path) -> _Sums:
    sums: _Sums = {}
    with contextlib.suppress(OSError, UnicodeDecodeError):
        for line in listed.read_text(encoding="utf-8", errors="surrogateescape").split("\n"):
            digest, _, name = line.partition("  ")
            if name:
                sums.setdefault(name, set()).add(digest)
    return sums


def _write(listed: Path, sums: _Sums, *, room: Path) -> None:
    lines = [f"{digest}  {name}\n" for name in sorted(sums) for digest in sorted(sums[name])]
    temporary = room / f"{listed.name}-new"
    temporary.write_text("".join(lines), encoding="utf-8", errors="surrogateescape")
    os.replace(temporary, listed)
