"""What happens when the other end of a pipe or socket is closed.

A command whose output is piped (``vmach predict ... | head``) ends as other tools do when the
reader has seen enough. A server or a team of processes must live on: its writes fail instead.
"""

from __future__ import annotations

import os
import signal

__all__ = ["end_by_broken_pipe", "end_when_the_reader_leaves", "live_on_when_the_reader_leaves"]

_SIGNAL = getattr(signal, "SIGPIPE", None)  # None on Windows


def end_when_the_reader_leaves() -> None:
    """From now on a write into a closed pipe ends this process, as it ends ``cat``."""
    if _SIGNAL is not None:
        signal.signal(_SIGNAL, signal.SIG_DFL)


def live_on_when_the_reader_leaves() -> None:
    """From now on a write into a closed pipe or socket raises `BrokenPipeError`.

    For what talks to browsers or to other processes: one of them may leave at any time.
    """
    if _SIGNAL is not None:
        signal.signal(_SIGNAL, signal.SIG_IGN)


def end_by_broken_pipe() -> None:
    """End this process with the status of one that wrote into a closed pipe."""
    end_when_the_reader_leaves()
    if _SIGNAL is not None:
        os.kill(os.getpid(), _SIGNAL)
