"""What a run needs last, compiled by a second process while the first has other work to do.

The compiler takes ten seconds for the search for edges, once on every machine. Before the first
edge is looked for, a program and CAD have to be read, which keeps the compiler of the first
process as busy. Collisions are looked for later still.
"""

from __future__ import annotations

import contextlib
import gc
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from stock.child_process import isolated_python
from stock.compiled import read_only
from stock.exact.meeting import Cut
from stock.exact.motion import Motion
from stock.exact.outline import Outlines
from stock.exact.tree import Trees
from stock.exact.walk import Work, walk_lines, walk_part
from stock.sweeps import Sweeps
from stock.tools import Tool, make_tool

__all__ = ["await_compiled", "compile_ahead", "compile_collisions", "compile_walk", "one_stroke"]

_LOOK_EVERY_S = 0.05
_PATIENCE_S = 120.0
_begun: list[subprocess.Popen] = []


def compile_ahead() -> None:
    """Begin to compile, unless that has been done or there is no processor to spare."""
    if _begun or _is_kept(walk_part) or (os.cpu_count() or 1) < 2 or not sys.executable:
        return
    silent = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
    with contextlib.suppress(OSError):  # what it would have compiled is compiled here
        _begun.append(subprocess.Popen(isolated_python("stock.compile_ahead"), **silent))


def await_compiled(kernel: Callable) -> None:
    """Wait until the other process, if there is one, has compiled a kernel.

    Whatever becomes of that process: what it has not compiled is compiled where it is used.
    """
    until = time.monotonic() + _PATIENCE_S
    while _begun and not _is_kept(kernel) and time.monotonic() < until:
        if _begun[0].poll() is not None:
            return
        time.sleep(_LOOK_EVERY_S)


def _is_kept(kernel: Callable) -> bool:
    """Whether a kernel's machine code has been kept from an earlier run, or by another process."""
    kept = f"{kernel.__module__.rpartition('.')[2]}.{kernel.__name__}-*.nbc"
    return any(Path(kernel.stats.cache_path).glob(kept))


def compile_walk() -> None:
    """Look for the edges of nothing."""
    motion = Motion(np.zeros((0, 16)), np.zeros((0, 12)), np.zeros((0, 5, 3)))
    none, of_tools = np.zeros(0), np.zeros(0, np.int64)
    outlines = Outlines(np.zeros((0, 3)), np.zeros((0, 7)), of_tools, of_tools, none)
    sweep, boxes = np.zeros(0, np.int32), np.zeros((0, 6), np.float32)
    span = np.zeros((0, 2))
    trees = Trees(sweep, span, *[of_tools] * 4, boxes, sweep, boxes, none, none, boxes, 0.0)
    nowhere = read_only(np.zeros((0, 3)))
    walk_lines(Work(Cut(motion, outlines), trees), nowhere, nowhere, np.zeros((2, 3)), 1.0)


def compile_collisions() -> None:
    """Follow one stroke through a blank."""
    from stock.collision import find_collisions  # it waits for this module's kernels

    find_collisions(*one_stroke())


def one_stroke() -> tuple[Sweeps, list[Tool], tuple[tuple[float, ...], tuple[float, ...]]]:
    """A stroke through a blank of 1 mm, its tool, and the corners of the blank."""
    place, motion, one = np.zeros((1, 3)), np.zeros((1, 2, 3)), np.zeros(1)
    stroke = Sweeps(
        start_mm=place, end_mm=place + 1.0, centre_mm=place, axis=place,
        shift_mm=motion, shift_slope_mm=motion, tilt_rad=motion, tilt_slope_rad=motion,
        sweep_rad=one, tool=one, move=one,
    )  # fmt: skip
    tool = make_tool("flat", diameter_mm=1.0, length_mm=1.0)
    return stroke, [tool], ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


if __name__ == "__main__":
    gc.disable()  # the compiler's objects stay; looking through them takes its time
    compile_walk()
    compile_collisions()
