"""Results appear whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from vmach.errors import InputError

__all__ = ["atomic_file", "atomic_folder"]


@contextmanager
def atomic_folder(out_dir: str | Path) -> Iterator[Path]:
    """Give a temporary folder whose files move into `out_dir` when the block ends well.

    The temporary folder is on the same file system, beside `out_dir`. Whatever ends the block
    early (an error, Ctrl-C) leaves `out_dir` as it was and nothing beside it. Other files that
    `out_dir` already holds stay; files of the same name are replaced one by one.

    Parameters
    ----------
    out_dir : path
        Folder for the results; made, with its parents, if it does not exist.

    Yields
    ------
    pathlib.Path
        Empty folder to write into.

    Raises
    ------
    InputError
        `out_dir` is a file, or cannot be written to.
    """
    out_dir = Path(out_dir).absolute()
    home = _nearest_existing(out_dir.parent)
    _check_writable_folder(home if not out_dir.exists() else out_dir)
    temporary = Path(tempfile.mkdtemp(prefix=f".{out_dir.name}-", dir=home))
    try:
        content = temporary / "content"
        content.mkdir()
        yield content
        _move_in(content, out_dir)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


@contextmanager
def atomic_file(path: str | Path) -> Iterator[Path]:
    """Give a temporary path of the same suffix; rename it to `path` when the block ends well.

    Raises
    ------
    InputError
        The folder of `path` is missing or cannot be written to.
    """
    path = Path(path).absolute()
    _check_writable_folder(path.parent)
    temporary = path.with_name(f".{path.stem}-{os.getpid()}{path.suffix}")
    try:
        yield temporary
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def _nearest_existing(folder: Path) -> Path:
    while not folder.exists():
        folder = folder.parent
    return folder


def _check_writable_folder(folder: Path) -> None:
    if not folder.is_dir():
        what = "is a file" if folder.exists() else "does not exist"
        raise InputError(what, file=folder, accepted="a folder for the results")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError("cannot be written to", file=folder, hint="choose another --out folder")


def _move_in(content: Path, out_dir: Path) -> None:
    if not out_dir.exists():
        out_dir.parent.mkdir(parents=True, exist_ok=True)
        os.replace(content, out_dir)
        return
    for source in sorted(content.rglob("*")):
        target = out_dir / source.relative_to(content)
        if source.is_dir():
            target.mkdir(exist_ok=True)
        else:
            os.replace(source, target)
