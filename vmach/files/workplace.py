"""A hidden folder beside a result, where it is made before it takes its place.

Whoever works in it holds a lock. A run that was killed holds none: its folder is cleared away by
the next run that writes the same result.
"""

from __future__ import annotations

import contextlib
import ctypes
import fcntl
import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from vmach.errors import InputError

__all__ = ["exchange", "nearest_existing", "workplace"]

_LOCK, _ASIDE = "lock", "aside"
#: a folder without a lock is left to whoever is about to make one
_PATIENCE_S = 60.0
_HERE = -100  # AT_FDCWD of <fcntl.h>: paths count from the current folder
_RENAME_EXCHANGE = 2  # of <linux/fs.h>


@contextlib.contextmanager
def workplace(target: Path) -> Iterator[Path]:
    """Give a new, empty folder on the file system that `target` is on or will be on.

    Raises
    ------
    InputError
        The folder of `target` cannot be written to.
    """
    home = nearest_existing(target.parent)
    _sweep(home, target)
    folder, lock = _locked_folder(home, _prefix(target))
    try:
        yield folder
    finally:
        _clear(folder)
        os.close(lock)


def exchange(made: Path, place: Path, *, room: Path) -> None:
    """Put a folder in the place of another, which goes where the first was.

    The system does it in one step where it can. Elsewhere the old folder waits in `room`, a
    workplace of `place`, between two steps. After a kill then the next `workplace` puts it back.
    """
    if _exchange_at_once(made, place):
        return
    os.rename(place, room / _ASIDE)
    os.rename(made, place)
    os.rename(room / _ASIDE, made)


def _exchange_at_once(first: Path, second: Path) -> bool:
    try:
        rename = ctypes.CDLL(None, use_errno=True).renameat2
    except (OSError, AttributeError):  # another system, or an old one
        return False
    paths = os.fsencode(first), os.fsencode(second)
    return bool(rename(_HERE, paths[0], _HERE, paths[1], _RENAME_EXCHANGE) == 0)


def _prefix(target: Path) -> str:
    return f".{target.name}.vmach-"


def nearest_existing(folder: Path) -> Path:
    """The folder itself, or the closest above it that exists."""
    while not folder.exists():
        folder = folder.parent
    return folder


def _locked_folder(home: Path, prefix: str) -> tuple[Path, int]:
    while True:
        try:
            folder = Path(tempfile.mkdtemp(prefix=prefix, dir=home))
        except OSError as error:
            raise InputError(f"cannot be written to: {error.strerror}", file=home) from None
        lock = os.open(folder / _LOCK, os.O_CREAT | os.O_RDWR)
        fcntl.flock(lock, fcntl.LOCK_EX)
        if (folder / _LOCK).exists():  # else it was swept before it was locked
            return folder, lock
        os.close(lock)


def _sweep(home: Path, target: Path) -> None:
    """Clear away what killed runs left; a result that one of them had set aside is put back."""
    prefix = _prefix(target)
    with contextlib.suppress(OSError):
        for name in os.listdir(home):
            folder = home / name
            if name.startswith(prefix) and folder.is_dir():
                with _taken_over(folder) as is_abandoned:
                    if is_abandoned and (folder / _ASIDE).exists() and not target.exists():
                        os.rename(folder / _ASIDE, target)
                    if is_abandoned:
                        _clear(folder)


def _clear(folder: Path) -> None:
    """Delete a workplace, its lock last: killed meanwhile, it is still known as abandoned."""
    for path in folder.iterdir():
        if path.name != _LOCK:
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)
    (folder / _LOCK).unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        folder.rmdir()


@contextlib.contextmanager
def _taken_over(folder: Path) -> Iterator[bool]:
    """Whether nobody works in a folder. Nobody can begin to meanwhile: its lock is held."""
    try:
        lock = os.open(folder / _LOCK, os.O_RDWR)
    except FileNotFoundError:
        yield time.time() - folder.stat().st_mtime > _PATIENCE_S
        return
    try:
        yield _is_locked_now(lock)
    finally:
        os.close(lock)


def _is_locked_now(lock: int) -> bool:
    """Lock a file, unless somebody else has."""
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
