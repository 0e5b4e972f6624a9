"""Ctrl-C counts wherever it comes, also where Python has to pass over an exception.

A compiler's library calls back into Python, and so does the collector. An exception there has
nobody to go to: Python reports it and goes on, and the work that somebody wanted to end with it.
"""

from __future__ import annotations

import _thread
import sys
import threading
from typing import Any

__all__ = ["repeat_lost_interrupts"]

#: an interrupt that was passed over is repeated so much later, when the call has returned
_AGAIN_S = 0.02


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
