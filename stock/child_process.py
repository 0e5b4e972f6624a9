"""Python processes that the program starts, kept apart from the current folder.

A user's folder may hold a file ``numpy.py`` or a folder ``stock``. With its usual start
(``python -m``) Python would run those instead of the installed packages.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

__all__ = ["children_may_die", "isolated_python"]

#: takes the folders to import from, the module, then the module's own arguments
_START = (
    "import runpy, sys; sys.path[:] = sys.argv.pop(1).split('\\n'); "
    "runpy.run_module(sys.argv.pop(1), run_name='__main__', alter_sys=True)"
)


def isolated_python(module: str, *arguments: str | Path) -> list[str]:
    """Command line that runs a module with the packages of this process and no others.

    The child imports from the folders that this process imports from. The current folder is
    left out, whichever way it got there, unless these packages themselves lie in it.

    Parameters
    ----------
    module : str
        Dotted name, run as ``__main__``.
    *arguments : str or Path
        The module's own arguments.
    """
    folders = "\n".join(_folders_without_current())
    return [sys.executable, "-I", "-c", _START, folders, module, *map(str, arguments)]


@contextlib.contextmanager
def children_may_die() -> Iterator[None]:
    """While it lasts, writing to a child that has died raises `BrokenPipeError`.

    A command line may have asked to be ended by a closed pipe, as ``cat`` is; only the main thread
    can say, and need say, that it wants to live on.
    """
    sigpipe = getattr(signal, "SIGPIPE", None)  # None on Windows
    if sigpipe is None or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(sigpipe, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(sigpipe, before)


def _folders_without_current() -> list[str]:
    own, current = Path(__file__).resolve().parents[1], Path.cwd()
    unwanted = {current} - {own}
    folders = [
        folder
        for folder in sys.path
        if os.path.isabs(folder) and Path(folder).resolve() not in unwanted
    ]
    return folders if str(own) in folders else [*folders, str(own)]
