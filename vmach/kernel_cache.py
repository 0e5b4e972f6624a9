"""Compiled kernels: forgotten when any of the sources that went into them changes.

numba notices when the file of a cached kernel changes, but not when a kernel that it calls, in
another file, does. After an update a stale kernel would go on giving the old numbers.
"""

from __future__ import annotations

import atexit
import gc
import hashlib
from importlib.util import find_spec
from pathlib import Path

from numba.core import event

__all__ = ["compile_without_collection", "forget_stale_kernels"]

_PACKAGES = ("gcode", "stock", "vmach")


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


def compile_without_collection() -> None:
    """Keep Python's garbage collector off whenever kernels compile, and away from what is left.

    The compiler makes millions of small objects, and looking through them again and again
    would take a fifth of the first run. They are never freed, about 100 MB in that one run.
    """
    event.register("numba:compile", _CollectionOff())
    atexit.register(gc.unfreeze)  # libraries look for what was not freed at the end


class _CollectionOff(event.Listener):
    """Off from the start of the outermost compilation to its end."""

    depth = 0

    def on_start(self, _compilation: event.Event) -> None:
        self.depth += 1
        gc.disable()

    def on_end(self, _compilation: event.Event) -> None:
        self.depth -= 1
        if self.depth == 0:
            gc.freeze()
            gc.enable()
