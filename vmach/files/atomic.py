"""Results appear whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from vmach.errors import InputError

__all__ = ["atomic_file", "atomic_folder", "check_folder", "check_outputs"]


def check_outputs(outputs: Iterable[Path | None], *, inputs: Iterable[Path] = ()) -> None:
    """Refuse files that could not be written, or would replace each other or an input.

    Asked before the work begins, so that nobody waits for a result that has no place to go.

    Parameters
    ----------
    outputs : iterable of Path or None
        Files to write; None for one that was not asked for.
    inputs : iterable of Path
        Files that the work reads.

    Raises
    ------
    InputError
    """
    taken = {path.resolve() for path in inputs}
    written: set[Path] = set()
    for path in filter(None, outputs):
        target = path.resolve()
        if target in taken:
            what, accepted = "is read by this command", "another name for the result"
            raise InputError(what, file=path, accepted=accepted)
        if target in written:
            raise InputError("two results have this name", file=path, accepted="a name for each")
        _check_file(target)
        written.add(target)


def check_folder(out_dir: Path, names: Iterable[str], *, inputs: Iterable[Path] = ()) -> None:
    """Refuse a folder that `atomic_folder` could not fill with files of these names.

    Asked before the work begins.

    Raises
    ------
    InputError
    """
    out_dir = out_dir.resolve()
    _folder_beside(out_dir).rmdir()
    if out_dir.exists():
        check_outputs((out_dir / name for name in names), inputs=inputs)


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
    out_dir = Path(out_dir).resolve()
    temporary = _folder_beside(out_dir)
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
        The folder of `path` is missing or cannot be written to; `path` is a folder or a device.
    """
    path = Path(path).resolve()  # a link stays, the file that it points to is replaced
    _check_file(path)
    temporary = path.with_name(f".{path.stem}-{os.getpid()}{path.suffix}")
    try:
        yield temporary
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def _check_file(path: Path) -> None:
    _check_writable_folder(path.parent)
    if path.exists() and not path.is_file():
        what = "is a folder" if path.is_dir() else "is a device, not a file"
        raise InputError(what, file=path, accepted="the name of a file for the result")


def _folder_beside(out_dir: Path) -> Path:
    """A new, empty folder on the file system that `out_dir` is on or will be on."""
    home = _nearest_existing(out_dir.parent)
    _check_writable_folder(out_dir if out_dir.exists() else home)
    try:
        return Path(tempfile.mkdtemp(prefix=f".{out_dir.name}-", dir=home))
    except OSError as error:
        raise InputError(f"cannot be written to: {error.strerror}", file=home) from None


def _nearest_existing(folder: Path) -> Path:
    while not folder.exists():
        folder = folder.parent
    return folder


def _check_writable_folder(folder: Path) -> None:
    if not folder.is_dir():
        what = "is a file" if folder.exists() else "does not exist"
        raise InputError(what, file=folder, accepted="a folder for the results")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError("cannot be written to", file=folder, hint="choose another folder")


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
