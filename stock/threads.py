"""Run a compiled kernel over parts of its range on all cores."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar

__all__ = ["available_cores", "cores_to_use", "on_one_core", "run_in_parts"]

#: parts for each core, so that a slow one does not keep the others waiting
_PARTS = 16
#: a part is worth a thread from this many items on, where nothing else is said
_LEAST = 256
#: whether many such runs share the machine, so that each keeps to one core
_alone: ContextVar[bool] = ContextVar("alone", default=False)


@contextmanager
def on_one_core() -> Iterator[None]:
    """Run kernels in one thread within the block, as where each core has work of its own."""
    before = _alone.set(True)
    try:
        yield
    finally:
        _alone.reset(before)


def run_in_parts(
    kernel: Callable[[int, int], None], count: int, *, block: int = 1, least: int = _LEAST
) -> None:
    """Call ``kernel(begin, end)`` for parts that cover 0 to `count`, each of whole blocks.

    The kernel has to release the interpreter's lock (``nogil``) and to write only what belongs
    to its own part; the result then does not depend on the number of cores. An interrupt ends
    the parts that have begun and leaves out the others. `least` items are worth a thread.
    """
    cores = cores_to_use()
    parts = max(1, min(cores * _PARTS, count // least))
    ends = [count * part // parts // block * block for part in range(parts)] + [count]
    if parts == 1 or cores == 1:
        kernel(0, count)
        return
    pool = ThreadPoolExecutor(cores)
    try:
        list(pool.map(kernel, ends[:-1], ends[1:]))
    finally:
        pool.shutdown(cancel_futures=True)


def cores_to_use() -> int:
    """Cores for one task: those that are available, or one within `on_one_core`."""
    return 1 if _alone.get() else available_cores()


def available_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
