"""The search for edges compiled by a second process, while the first has other work to do.

The compiler takes ten seconds for it, once on every machine. Before the first edge is looked for,
a program has to be read and displaced, which keeps the compiler of the first process as busy.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time

import numpy as np

from stock.child_process import isolated_python
from stock.compiled import read_only
from stock.exact.meeting import Cut
from stock.exact.motion import Motion
from stock.exact.outline import Outlines
from stock.exact.tree import Trees
from stock.exact.walk import Work, is_walk_compiled, walk_lines

__all__ = ["await_compiled", "compile_ahead", "compile_walk"]

_LOOK_EVERY_S = 0.05
_PATIENCE_S = 120.0
_begun: list[subprocess.Popen] = []


def compile_ahead() -> None:
    """Begin to compile, unless that has been done or there is no processor to spare."""
    if _begun or is_walk_compiled() or (os.cpu_count() or 1) < 2 or not sys.executable:
        return
    silent = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
    with contextlib.suppress(OSError):  # what it would have compiled is compiled here
        _begun.append(subprocess.Popen(isolated_python("stock.compile_ahead"), **silent))


def await_compiled() -> None:
    """Wait for what has been begun.

    Whatever becomes of the other process: what it has not compiled is compiled where it is used.
    """
    until = time.monotonic() + _PATIENCE_S
    while _begun and not is_walk_compiled() and time.monotonic() < until:
        if _begun[0].poll() is not None:
            return
        time.sleep(_LOOK_EVERY_S)


def compile_walk() -> None:
    """Look for the edges of nothing."""
    motion = Motion(np.zeros((0, 16)), np.zeros((0, 12)), np.zeros((0, 5, 3)))
    none, of_tools = np.zeros(0), np.zeros(0, np.int64)
    outlines = Outlines(np.zeros((0, 3)), np.zeros((0, 7)), of_tools, of_tools, none)
    sweep, boxes = np.zeros(0, np.int32), np.zeros((0, 6), np.float32)
    span = np.zeros((0, 2))
    trees = Trees(sweep, span, *[of_tools] * 4, boxes, sweep, boxes, none)
    nowhere = read_only(np.zeros((0, 3)))
    walk_lines(Work(Cut(motion, outlines), trees), nowhere, nowhere, np.zeros((2, 3)), 1.0)


if __name__ == "__main__":
    compile_walk()
