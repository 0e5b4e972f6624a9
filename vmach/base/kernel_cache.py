"""Compiled kernels: where they are kept, and when they are forgotten.

They are kept beside the packages, or in the user's cache, or else in a folder of the temporary
one. They are forgotten when any of the sources that went into them changes: numba notices when
the file of a cached kernel changes, but not when a kernel that it calls, in another file, does.
After an update a stale kernel would go on giving the old numbers.
"""

from __future__ import annotations

import atexit
import contextlib
import gc
import hashlib
import os
import stat
import tempfile
from importlib.util import find_spec
from pathlib import Path

from vmach.base.damaged_cache import drop_cut_kernels

__all__ = ["collect_less_often", "find_room_for_kernels", "forget_stale_kernels", "is_cold"]

_PACKAGES = ("gcode", "stock", "vmach")
_KERNELS = "__pycache__/*.nb[ci]"
#: new containers before any are looked at; 700 is usual. The imports of a command make 200,000
_LOT = 300_000


def find_room_for_kernels() -> None:
    """Give numba a folder where it finds none of its own, as on a read-only system.

    Without one it refuses to work. Call it before numba is loaded. What lies in the folder is run:
    so it is always named here, if only by an empty name (numba's own choice). Else numba would take
    it from a file of settings in the current folder.
    """
    beside = Path(__file__).parent / "__pycache__"
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    if "NUMBA_CACHE_DIR" not in os.environ:
        has_room = _has_room(beside) or _has_room(cache)
        os.environ["NUMBA_CACHE_DIR"] = "" if has_room else str(_temporary_folder())


def _has_room(folder: Path) -> bool:
    """Whether files can be made in a folder, which may have to be made itself."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _temporary_folder() -> Path:
    """A folder that only this user can write to: what lies in it is run."""
    if not hasattr(os, "getuid"):  # where every user has a temporary folder of their own
        return Path(tempfile.gettempdir()) / "vmach-kernels"
    folder = Path(tempfile.gettempdir()) / f"vmach-kernels-{os.getuid()}"
    with contextlib.suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    found = folder.lstat()
    is_own = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
    if is_own and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        return folder
    return Path(tempfile.mkdtemp(prefix="vmach-kernels-"))


def forget_stale_kernels() -> None:
    """Delete the cached kernels of every package whose kernels' sources have changed.

    And those that are cut short, with which no command would start.
    Call it before the first kernel runs. Where the packages cannot be written to, nothing is
    cached beside them and nothing is done.
    """
    for name in _PACKAGES:
        spec = find_spec(name)
        if spec is not None and spec.origin is not None:
            _forget_in(Path(spec.origin).parent)
            drop_cut_kernels(Path(spec.origin).parent.rglob(_KERNELS))
    if elsewhere := os.environ.get("NUMBA_CACHE_DIR"):
        drop_cut_kernels(Path(elsewhere).glob("*/*.nb[ci]"))


def is_cold() -> bool:
    """Whether no kernel is kept beside the packages. Where they are kept elsewhere: False."""
    spec = find_spec("stock")
    if os.environ.get("NUMBA_CACHE_DIR") or spec is None or spec.origin is None:
        return False
    kept = Path(spec.origin).parent.rglob("__pycache__/*.nbi")
    return next(kept, None) is None


def _forget_in(package: Path) -> None:
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        source = path.read_bytes()
        if b"njit" in source:
            digest.update(str(path.relative_to(package)).encode() + b"\0" + source)
    stamp = package / "__pycache__" / "kernels.sha256"
    try:
        if stamp.exists() and stamp.read_text() == digest.hexdigest():
            return
        for cached in package.rglob(_KERNELS):
            cached.unlink(missing_ok=True)
        stamp.parent.mkdir(exist_ok=True)
        stamp.write_text(digest.hexdigest())
    except OSError:
        return


def collect_less_often() -> None:
    """Let Python's garbage collector look at new objects in large lots only.

    The compiler makes millions of small objects that stay, and looking through them again and
    again would take a fifth of the first run. When the process ends, all of them go in any case:
    looking through them once more would take a tenth of a short command.
    """
    gc.set_threshold(_LOT, 50, 100)
    atexit.register(gc.freeze)
