"""Compiled kernels: forgotten when any of the sources that went into them changes.

numba notices when the file of a cached kernel changes, but not when a kernel that it calls, in
another file, does. After an update a stale kernel would go on giving the old numbers.
"""

from __future__ import annotations

import gc
import hashlib
from importlib.util import find_spec
from pathlib import Path

__all__ = ["collect_less_often", "forget_stale_kernels"]

_PACKAGES = ("gcode", "stock", "vmach")
#: new containers before any are looked at; 700 is usual
_LOT = 100_000


def forget_stale_kernels() -> None:
    """Delete the cached kernels of every package whose kernels' sources have changed.

    Call it before the first kernel runs. Where the packages cannot be written to, nothing is
    cached beside them and nothing is done.
    """
    for name in _PACKAGES:
        spec = find_spec(name)
        if spec is not None and spec.origin is not None:
            _forget_in(Path(spec.origin).parent)


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
        for cached in package.rglob("__pycache__/*.nb[ci]"):
            cached.unlink(missing_ok=True)
        stamp.parent.mkdir(exist_ok=True)
        stamp.write_text(digest.hexdigest())
    except OSError:
        return


def collect_less_often() -> None:
    """Let Python's garbage collector look at new objects in large lots only.

    The compiler makes millions of small objects that stay, and looking through them again and
    again would take a fifth of the first run.
    """
    gc.set_threshold(_LOT, 50, 100)
