"""Ctrl-C counts wherever it comes, also where Python has to pass over an exception.

A compiler's library calls back into Python, and so does the collector. An exception there has
nobody to go to: Python reports it and goes on, and the work that somebody wanted to end with it.

SIGTERM, as of ``kill``, ``timeout`` and systems that shut down, counts as Ctrl-C does: the default
would end the process at once, with what it was writing left behind.
"""

from __future__ import annotations

import _thread
import contextlib
import signal
import sys
import threading
from collections.abc import Iterator
from typing import Any

__all__ = [
    "interrupt_on_termination",
    "interrupts_are_not_for_children",
    "repeat_lost_interrupts",
    "was_terminated",
]

#: an interrupt that was passed over is repeated so much later, when the call has returned
_AGAIN_S = 0.02
#: set when SIGTERM has come
_terminated = threading.Event()


def interrupt_on_termination() -> None:
    """From now on SIGTERM raises `KeyboardInterrupt` in the main thread, where it is not ignored.

    Once: ``timeout`` sends it twice, and the second would interrupt the clearing away.
    """
    if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:
        signal.signal(signal.SIGTERM, _interrupt_once)


def _interrupt_once(number: int, frame: object) -> None:
    if not _terminated.is_set():
        _terminated.set()
        raise KeyboardInterrupt


def was_terminated() -> bool:
    """Whether SIGTERM is what interrupted this process."""
    return _terminated.is_set()


def repeat_lost_interrupts() -> None:
    """From now on interrupt the main thread again where Python passed over `KeyboardInterrupt`."""
    report = sys.unraisablehook

    def again(lost: Any) -> None:
        if not issubclass(lost.exc_type, KeyboardInterrupt):
            report(lost)
            return
        timer = threading.Timer(_AGAIN_S, _thread.interrupt_main)
        timer.daemon = True
        timer.start()

    sys.unraisablehook = again


@contextlib.contextmanager
def interrupts_are_not_for_children() -> Iterator[None]:
    """A process that is started meanwhile never hears Ctrl-C: who started it ends it.

    A terminal sends Ctrl-C to all processes of a command, also to one that has not begun to catch
    it. Here it waits until the block is left.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    from multiprocessing import resource_tracker  # late: only who starts processes needs it

    resource_tracker.ensure_running()  # multiprocessing's own process: its start ends the blocking
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
